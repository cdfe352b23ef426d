#include "desktop/import/upright.h"

namespace pocketray {

Transform upright(SceneBuilder* builder, UpAxis format_up, const char* format) {
  const UpAxis asked = builder->options.up, up = asked == UpAxis::of_format ? format_up : asked;
  Transform turn;
  if (up != UpAxis::z) return turn;
  if (asked == UpAxis::of_format)
    note_remark(builder, std::string("its Z axis points up, as in most ") + format + " files; --up y keeps Y up");
  turn.m[1][1] = 0, turn.m[1][2] = 1;
  turn.m[2][1] = -1, turn.m[2][2] = 0;
  return turn;
}

}  // namespace pocketray
