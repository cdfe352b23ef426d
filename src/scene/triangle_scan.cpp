#include "scene/triangle_scan.h"

#include "base/check.h"
#include "base/scan.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kVertexMask = (1u << kVertexIndexBits) - 1;
constexpr int kShareBits = 32 - kVertexIndexBits;
static_assert(sizeof(Triangle) == 12, "three words, each with a vertex below a share of the material");

std::size_t word_count(Array<const Triangle> triangles) { return 3 * std::size_t(triangles.count); }

}  // namespace

std::uint32_t largest_vertex(Array<const Triangle> triangles) {
  return static_cast<std::uint32_t>(
      largest_word(triangles.data, word_count(triangles), static_cast<std::int32_t>(kVertexMask)));
}

bool any_uses_vertex(Array<const Triangle> triangles, std::uint32_t vertex) {
  CHECK_LE(vertex, kVertexMask);
  return has_word(triangles.data, word_count(triangles), static_cast<std::int32_t>(kVertexMask),
                  static_cast<std::int32_t>(vertex));
}

std::uint32_t material_bound(Array<const Triangle> triangles) {
  const LargestOfThree share = largest_of_three(triangles.data, triangles.count, kVertexIndexBits);
  return static_cast<std::uint32_t>(share.of[0] | share.of[1] << kShareBits | share.of[2] << 2 * kShareBits);
}

std::uint32_t next_material(Array<const Triangle> triangles, std::uint32_t index) {
  CHECK_LT(index, triangles.count);
  return find_change(triangles.data, index + 1, triangles.count, ~kVertexMask);
}

}  // namespace pocketray
