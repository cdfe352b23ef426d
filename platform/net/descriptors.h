// File descriptors: what the system still has of them, and what is done where it has none.
#pragma once
#include <cstdint>

namespace platform {

// How many more files and sockets this program may open, of `wanted`. Raises the limit (`ulimit -n`) as far as the
// system lets it where that is too low.
int descriptors_left(int wanted);

// Whether accept() failed for want of something that every later call would miss, too, and left the peer waiting.
bool is_shortage(int error_number);

// Gives `spare` away to accept the peer that waits at the listener, which is closed at once and so knows where it
// stands, and takes a new spare. -1 where there is none.
int turn_away(int listener, int spare);
int take_spare();

}  // namespace platform
