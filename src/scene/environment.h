// A stored environment: light from all directions, as octahedral maps [Cigolle et al. 2014, "A survey of efficient
// representations for independent unit vectors", sec. 3.2] with +Y in the middle and −Y at the corners. The first map
// is what rays see; the others hold it as GGX lobes of rising roughness reflect it [Karis 2013, "Real shading in Unreal
// Engine 4", prefiltered environment map]. Nine coefficients hold what diffuse surfaces reflect of it [Ramamoorthi &
// Hanrahan 2001, "An efficient representation for irradiance environment maps", eqs. 9 and 10].
#pragma once
#include <cstdint>
#include <cstring>

#include "base/vec3.h"

namespace pocketray {

struct EnvironmentInfo {
  float scale = 1;               // of all texels; a power of two
  std::uint32_t side = 0;        // texels of the map that rays see; a power of two
  std::uint32_t gloss_side = 0;  // of the first map for glossy lobes; a power of two, at least 4
  Vec3 radiance_max;             // no texel exceeds it
  // Irradiance / π on a surface of normal n is the sum of these times 1, x, y, z, xy, yz, xz, x² − z², 3y² − 1.
  Vec3 irradiance[9];
};

// A sun: a directional light of the scene that shines from a disc. The map may show it, too; what exceeds its
// surroundings there lights surfaces as this light alone, and the maps for glossy lobes and the coefficients lack it.
struct EnvironmentSun {
  std::uint32_t light = 0;  // index of the light; it travels away from the disc's middle
  float radius = 0;         // of the disc, radians
  float cos_shown = 2;      // cosine of the angle around the disc within which the map shows it; 2: it does not
  float surroundings = 0;   // luminance to which texels there are dimmed for all other purposes
};

// The maps follow each other from the first, rows of their second coordinate (z), texels of the first (x).
constexpr int kGlossLevelCount = 6;
constexpr float kGlossRoughness[kGlossLevelCount] = {0.1f, 0.25f, 0.4f, 0.6f, 0.8f, 1.0f};  // √α
constexpr std::uint32_t gloss_level_side(std::uint32_t gloss_side, int level) {
  return gloss_side >> static_cast<unsigned>(level / 2);
}
constexpr std::uint32_t gloss_level_begin(std::uint32_t side, std::uint32_t gloss_side, int level) {
  std::uint32_t begin = side * side;
  for (int i = 0; i < level; ++i) begin += gloss_level_side(gloss_side, i) * gloss_level_side(gloss_side, i);
  return begin;
}
constexpr std::uint32_t environment_texel_count(std::uint32_t side, std::uint32_t gloss_side) {
  return gloss_level_begin(side, gloss_side, kGlossLevelCount);
}

// Decodes a texel: red, green and blue in 9 bits each, from the lowest, × 2^(e − 24), where e is in the top 5. Every
// pattern is finite and at least 0, and decoding is exact.
inline Vec3 environment_texel(std::uint32_t texel) {
  const std::uint32_t bits = ((texel >> 27) + 127 - 24) << 23;
  float unit;
  std::memcpy(&unit, &bits, sizeof unit);
  return Vec3{static_cast<float>(texel & 511), static_cast<float>(texel >> 9 & 511),
              static_cast<float>(texel >> 18 & 511)} *
         unit;
}
constexpr float kEnvironmentTexelMax = 511.0f * 128;
// Nearest texel to a colour within 0 … kEnvironmentTexelMax.
std::uint32_t to_environment_texel(const Vec3d& color);

// Maps a direction of any length but 0 to the square [−1, 1]².
template <class T>
inline void to_octahedral(const Vec3T<T>& direction, T* u, T* v) {
  auto magnitude = [](T x) { return x < 0 ? -x : x; };
  const T sum = magnitude(direction.x) + magnitude(direction.y) + magnitude(direction.z);
  *u = direction.x / sum, *v = direction.z / sum;
  if (direction.y < 0) {
    const T folded_u = (1 - magnitude(*v)) * (*u < 0 ? T(-1) : T(1));
    *v = (1 - magnitude(*u)) * (*v < 0 ? T(-1) : T(1));
    *u = folded_u;
  }
}
// Maps a place on the square to the octahedron |x| + |y| + |z| = 1: the direction is not a unit vector. A piece of the
// square spans a solid angle of its area / |point|³.
inline Vec3d from_octahedral(double u, double v) {
  auto magnitude = [](double x) { return x < 0 ? -x : x; };
  const double y = 1 - magnitude(u) - magnitude(v);
  if (y >= 0) return {u, y, v};
  return {(1 - magnitude(v)) * (u < 0 ? -1 : 1), y, (1 - magnitude(u)) * (v < 0 ? -1 : 1)};
}

// Index of the texel at a column and row, each in [−1, side]: beyond the edge of the square lies its mirrored edge.
inline std::uint32_t octahedral_index(int column, int row, int side) {
  if (column < 0 || column >= side) column = column < 0 ? 0 : side - 1, row = side - 1 - row;
  if (row < 0 || row >= side) row = row < 0 ? 0 : side - 1, column = side - 1 - column;
  return static_cast<std::uint32_t>(row * side + column);
}

}  // namespace pocketray
