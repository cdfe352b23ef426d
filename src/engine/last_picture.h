// The last picture of a sequence, for Resolution::interleaved, whose pictures build on each other, and for
// MovingContrast::as_seen, which asks how fast things move.
//
// Only whole pictures follow each other. Rows shared with servers, a server's own rows and parts of a picture are a
// plain checkerboard, of contrasts as in what rests: nobody else has the last picture. The pictures depend on their
// sequence, not on threads, spans or CPUs.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Takes its memory, if that is planned; a step of build_renderer().
void make_last_picture(Renderer* renderer);

// After prepare_frame(), where the whole picture is going to be traced: lets it build on the last one.
void follow_picture(Renderer* renderer);
// Once it is traced: keeps it as the last one.
void keep_picture(Renderer* renderer);
// The next picture builds on none.
void forget_picture(Renderer* renderer);

}  // namespace pocketray
