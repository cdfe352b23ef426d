#include "import/obj_exact.h"

#include <cstdlib>
#include <string>

#include "import/exact.h"

namespace pocketray {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_line_end(char c) { return c == '\n' || c == '\r' || c == 0; }

// The line's three numbers if it begins with "v".
bool read_vertex(const char* at, Vec3d* vertex) {
  while (is_blank(*at)) ++at;
  if (at[0] != 'v' || !is_blank(at[1])) return false;
  ++at;
  for (int c = 0; c < 3; ++c) {
    while (is_blank(*at)) ++at;
    char* end = const_cast<char*>(at);
    (*vertex)[c] = is_line_end(*at) ? 0 : std::strtod(at, &end);
    at = end;
  }
  return true;
}

}  // namespace

void recentre_obj(const Bytes& text, SceneBuilder* builder, std::vector<float>* vertices) {
  const std::size_t count = vertices->size() / 3;
  ExactBox bounds;
  for (std::size_t i = 0; i < count; ++i)
    extend(&bounds, {(*vertices)[3 * i], (*vertices)[3 * i + 1], (*vertices)[3 * i + 2]});
  const std::uint64_t triangles = 2 * count;  // of a mesh
  if (!is_far(bounds, triangles)) return;
  require_bytes(*builder, count, sizeof(Vec3d) + sizeof(Vec3), "the vertices");
  std::vector<Vec3d> exactly;
  const std::string lines(text.begin(), text.end());
  for (std::size_t at = 0; at < lines.size(); ++at) {
    Vec3d vertex;
    if (read_vertex(&lines[at], &vertex)) exactly.push_back(vertex);
    at = std::min(lines.find_first_of("\n\r", at), lines.size());
  }
  if (exactly.size() != count) return;  // not as the library reads them
  std::vector<Vec3> rounded(count);
  recentre(exactly, triangles, builder, &rounded);
  for (std::size_t i = 0; i < 3 * count && !builder->out->origin.empty(); ++i)
    (*vertices)[i] = rounded[i / 3][static_cast<int>(i % 3)];
}

}  // namespace pocketray
