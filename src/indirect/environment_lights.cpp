#include "indirect/environment_lights.h"

#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "indirect/environment.h"

namespace pocketray {
namespace {

// Column and row of the n-th square of a Hilbert curve through side × side squares, side a power of two.
void hilbert_place(std::uint32_t side, std::uint32_t n, std::uint32_t* column, std::uint32_t* row) {
  std::uint32_t x = 0, y = 0;
  for (std::uint32_t s = 1; s < side; s *= 2, n /= 4) {
    const std::uint32_t right = n / 2 & 1, up = (n ^ right) & 1;
    if (!up) {
      if (right) x = s - 1 - x, y = s - 1 - y;
      const std::uint32_t swapped = x;
      x = y, y = swapped;
    }
    x += s * right, y += s * up;
  }
  *column = x, *row = y;
}

constexpr std::uint32_t kVariantMax = 4;  // patterns from which a pixel takes light

// Lights are made of cells of the first map for glossy lobes, which lacks the sun. A cell is a texel, several, or a
// part of one: few enough for CPUs without an FPU, and small enough that hardly any has several lights in its middle.
constexpr std::uint32_t kCellsAlong = 64;

// Light of a cell, up to a common factor.
struct CellLight {
  Vec3d direction, irradiance;
  double luminance;
};

// Sums over texels are integers: mantissa × 2^exponent, at most 40 bits, of at most 2^8 texels; in luminance, by
// weights of 10 bits and places of 5.
static_assert(kEnvironmentSideMax / kCellsAlong <= 16, "64 bits hold the sums");
CellLight cell_light(const Scene& scene, std::uint32_t n) {
  const EnvironmentInfo& info = scene.environment_info[0];
  const std::uint32_t* texels = scene.environment_texels.data + gloss_level_begin(info.side, info.gloss_side, 0);
  const std::uint32_t side = info.gloss_side;
  const std::uint32_t along = side > kCellsAlong ? side / kCellsAlong : 1;  // texels of the cell
  std::uint32_t column, row;
  hilbert_place(kCellsAlong, n, &column, &row);
  std::uint64_t color[3] = {}, sum = 0, across = 0, down = 0;
  for (std::uint32_t y = 0; y < along; ++y)
    for (std::uint32_t x = 0; x < along; ++x) {
      const std::uint32_t texel = side > kCellsAlong
                                      ? texels[(row * along + y) * side + column * along + x]
                                      : texels[row * side / kCellsAlong * side + column * side / kCellsAlong];
      const std::uint32_t part[3] = {texel & 511, texel >> 9 & 511, texel >> 18 & 511}, exponent = texel >> 27;
      const std::uint64_t luminance = std::uint64_t(218 * part[0] + 732 * part[1] + 74 * part[2]) << exponent;
      for (int c = 0; c < 3; ++c) color[c] += std::uint64_t(part[c]) << exponent;
      sum += luminance, across += luminance * (2 * x + 1), down += luminance * (2 * y + 1);
    }
  CellLight cell = {{0, 0, 0}, {0, 0, 0}, 0};
  if (sum == 0) return cell;
  // Centre of the cell's light.
  const double size = 2.0 / kCellsAlong, luminance = static_cast<double>(sum);
  const double u = static_cast<double>(across) / luminance / (2 * along);
  const double v = static_cast<double>(down) / luminance / (2 * along);
  const Vec3d point = from_octahedral((column + u) * size - 1, (row + v) * size - 1);
  const double square = dot(point, point), distance = std::sqrt(square), solid_angle = 1 / (square * distance);
  cell.direction = point / distance;
  cell.irradiance =
      Vec3d{static_cast<double>(color[0]), static_cast<double>(color[1]), static_cast<double>(color[2])} * solid_angle;
  cell.luminance = luminance / 1024 * solid_angle;
  return cell;
}

}  // namespace

void place_environment_lights(const Scene& scene, std::uint32_t count, EnvironmentLights* lights) {
  CHECK(lights != nullptr && environment_of(scene) != nullptr);
  CHECK_LE(count, kEnvironmentLightMax);
  lights->count = 0, lights->wanted = count, lights->variants = 1;
  while (lights->variants < kVariantMax && 2 * lights->variants * count <= kEnvironmentLightRoom) lights->variants *= 2;
  count *= lights->variants;
  CHECK_LE(environment_texel_count(environment_of(scene)->side, environment_of(scene)->gloss_side),
           scene.environment_texels.count);
  constexpr std::uint32_t cell_count = kCellsAlong * kCellsAlong;
  double total = 0;
  for (std::uint32_t n = 0; n < cell_count; ++n) total += cell_light(scene, n).luminance;
  if (!(total > 0) || count == 0) return;
  const double share = total / count;
  Vec3d axis = {0, 0, 0}, sum = {0, 0, 0};
  double room = share;  // room left in the light being filled
  auto add = [&](const CellLight& cell, double part) {
    axis += cell.direction * (part * cell.luminance), sum += cell.irradiance * part;
  };
  auto finish = [&] {
    const Vec3d unit = normalize(axis), scaled = sum / share;
    EnvironmentLight& light = lights->light[lights->count++];
    for (int c = 0; c < 3; ++c)
      light.direction[c] = static_cast<float>(unit[c]), light.irradiance[c] = static_cast<float>(scaled[c]);
    axis = sum = {0, 0, 0}, room = share;
  };
  for (std::uint32_t n = 0; n < cell_count; ++n) {
    const CellLight cell = cell_light(scene, n);
    double left = cell.luminance;
    while (left > room && lights->count + 1 < count) {  // the last light takes what rounding leaves
      add(cell, room / cell.luminance), left -= room;
      finish();
    }
    if (left > 0) add(cell, left / cell.luminance), room -= left;
  }
  if (!is_zero(axis)) finish();
  CHECK_LE(lights->count, count);
}

}  // namespace pocketray
