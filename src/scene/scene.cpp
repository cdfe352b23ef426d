#include "scene/scene.h"

#include "base/check.h"

namespace pocketray {

Triangle::Triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
  set_vertex(0, a), set_vertex(1, b), set_vertex(2, c), set_material(material);
}

void Triangle::set_vertex(std::uint32_t corner, std::uint32_t value) {
  CHECK_LE(value, kVertexMask);
  word_[corner] = (word_[corner] & ~kVertexMask) | value;
}

void Triangle::set_material(std::uint32_t value) {
  CHECK_EQ(value >> 3 * kShareBits, 0u);
  for (std::uint32_t& word : word_) {
    word = (word & kVertexMask) | value << kVertexIndexBits;
    value >>= kShareBits;
  }
}

}  // namespace pocketray
