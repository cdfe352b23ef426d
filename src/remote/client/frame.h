// One split frame: scene → plan → accelerate → split → trace + shade spans → merge. The device renders rows from the
// top, continuing into missing ones; the servers send theirs in the requested order; when they meet, the frame is
// complete.
#pragma once
#include "remote/client/client.h"

namespace pocketray {

// Requests the servers' rows and prepares the scene for the time, unless servers are likely to render all rows of a
// moving scene: then it is prepared once the device has rows to render or pixels to check.
Status begin_frame(Renderer* renderer, Client* client, double seconds);
// Renders and merges until about `deadline_ns` by client_now_ns(), at least a few rows, or until `stop` is set; without
// `stop`, also until a coarse picture comes. Returns true if the frame is complete: it is then in client->pixels,
// summarised in client->share.
bool advance_frame(Renderer* renderer, Client* client, std::uint64_t deadline_ns,
                   const std::atomic<bool>* stop = nullptr);
// Does both for the whole frame, unless stopped. `complete` may be null.
Status render_frame(Renderer* renderer, Client* client, double seconds, const std::atomic<bool>* stop = nullptr,
                    bool* complete = nullptr);

}  // namespace pocketray
