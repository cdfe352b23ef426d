// File descriptors: how many are left, and what to do when none are.
#pragma once
#include <cstdint>

namespace platform {

// Returns how many more files and sockets this program may open, up to `wanted`. If too few, raises the limit (`ulimit
// -n`) as far as the system allows.
int descriptors_left(int wanted);

// Returns whether accept() failed for lack of a resource that later calls would also lack, and left the peer waiting.
bool is_shortage(int error_number);

// Closes `spare` to accept the peer waiting at the listener, closes that peer at once so that it learns of it, and
// opens a new spare. Returns -1 if it cannot.
int turn_away(int listener, int spare);
int take_spare();

}  // namespace platform
