#include "app/picture.h"
#include <cstdio>
#include <cstring>
#include "platform/file.h"
namespace pocketray {
std::size_t picture_bytes(const Settings& s) { return std::size_t(s.width) * s.height * 3 + 64; }
Status check_picture_path(const std::string&) { return success(); }
Status write_picture(const char* path, const PictureOptions&, Renderer* r) {
  int w = r->settings.width, h = r->settings.height;
  std::size_t mark = arena_mark(r->frame_arena);
  auto rgb = arena_array<std::uint8_t>(&r->frame_arena, std::size_t(w) * h * 3);
  pack_rgb8(r->image.data, w, h, r->exposure, rgb.data);
  platform::FileWriter f; platform::FileError e;
  if (!platform::open_writer(path, &f, &e)) return failure("%s %s", path, e.text);
  char head[64]; int n = std::snprintf(head, 64, "P6\n%d %d\n255\n", w, h);
  platform::write_bytes(&f, head, n); platform::write_bytes(&f, rgb.data, rgb.bytes());
  arena_release(&r->frame_arena, mark);
  return platform::close_writer(&f, &e) ? success() : failure("%s %s", path, e.text);
}
}
