#include "import/obj_exact.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "import/exact.h"

namespace pocketray {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_line_end(char c) { return c == '\n' || c == '\r' || c == 0; }

// The line's three numbers if it begins with "v", and where they end.
bool read_vertex(const char* at, Vec3d* vertex, const char** end) {
  while (is_blank(*at)) ++at;
  if (at[0] != 'v' || !is_blank(at[1])) return false;
  ++at;
  for (int c = 0; c < 3; ++c) {
    while (is_blank(*at)) ++at;
    char* stop = const_cast<char*>(at);
    (*vertex)[c] = is_line_end(*at) ? 0 : std::strtod(at, &stop);
    at = stop;
  }
  *end = at;
  return true;
}

// Calls visit(begin of the line, its vertex, end of the numbers) for every `pitch`-th vertex.
template <class Visit>
void for_each_vertex(const std::string& text, std::size_t pitch, Visit visit) {
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    Vec3d vertex;
    const char* end;
    std::size_t first = std::min(text.find_first_not_of(" \t", at), text.size());
    const bool may_be = first + 1 < text.size() && text[first] == 'v' && is_blank(text[first + 1]);
    if (may_be && number++ % pitch == 0 && read_vertex(&text[at], &vertex, &end))
      visit(at, vertex, static_cast<std::size_t>(end - text.data()));
    at = std::min(text.find_first_of("\n\r", at), text.size());
  }
}

}  // namespace

void recentre_obj(SceneBuilder* builder, Bytes* bytes) {
  constexpr std::size_t kPitch = 64;  // few show whether all are worth a look
  const std::string text(bytes->begin(), bytes->end());
  ExactBox some, all;
  std::uint64_t count = 0;
  for_each_vertex(text, kPitch, [&](std::size_t, const Vec3d& v, std::size_t) { extend(&some, v), count += kPitch; });
  if (!is_far(some, 2 * count)) return;  // a mesh has two triangles per vertex
  count = 0;
  for_each_vertex(text, 1, [&](std::size_t, const Vec3d& v, std::size_t) { extend(&all, v), ++count; });
  const Vec3d origin = choose_origin(all, 2 * count, builder);
  if (builder->out->origin.empty()) return;
  std::string moved;
  std::size_t copied = 0;
  for_each_vertex(text, 1, [&](std::size_t at, const Vec3d& vertex, std::size_t end) {
    char line[100];
    const Vec3 p = to_float(vertex - origin);
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g", static_cast<double>(p.x), static_cast<double>(p.y),
                  static_cast<double>(p.z));
    moved.append(text, copied, at - copied).append(line);
    copied = end;
  });
  moved.append(text, copied, std::string::npos);
  bytes->assign(moved.begin(), moved.end());
}

}  // namespace pocketray
