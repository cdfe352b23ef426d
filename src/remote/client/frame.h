// One frame, shared: scene → plan → accelerate → split → trace + shade spans → merge. The device takes rows from the
// top and goes on into those that have not come; the servers' come from the bottom; where they meet, the frame is done.
#pragma once
#include "remote/client/client.h"

namespace pocketray {

// Prepares the scene for the time and asks the servers for their rows.
Status begin_frame(Renderer* renderer, Client* client, double seconds);
// Renders and merges until about `deadline_ns` by client_now_ns(), at least a few rows, or until `stop` is set. True:
// the frame is complete, in client->pixels, and client->share tells how it went.
bool advance_frame(Renderer* renderer, Client* client, std::uint64_t deadline_ns,
                   const std::atomic<bool>* stop = nullptr);
// Both: the whole frame, but for a stop. *complete may be null.
Status render_frame(Renderer* renderer, Client* client, double seconds, const std::atomic<bool>* stop = nullptr,
                    bool* complete = nullptr);

}  // namespace pocketray
