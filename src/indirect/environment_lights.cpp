#include "indirect/environment_lights.h"

#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "indirect/environment.h"

namespace pocketray {
namespace {

// The column and row of the n-th square of a Hilbert curve through side × side of them, side a power of two.
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

double luminance_of(const Vec3d& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

// Large texels are divided, or several lights would lie in the middle of one.
constexpr std::uint32_t kFinestSide = 64;

// A texel, or a part of one, as a light: what it sends, up to a factor that all share.
struct TexelLight {
  Vec3d direction, irradiance;
};
TexelLight texel_light(const Scene& scene, std::uint32_t side, std::uint32_t n) {
  const std::uint32_t texels = scene.environment_info[0].side, parts = side / texels;
  std::uint32_t column, row;
  hilbert_place(side, n, &column, &row);
  const Vec3d point = from_octahedral(2 * (column + 0.5) / side - 1, 2 * (row + 0.5) / side - 1);
  const double square = dot(point, point), distance = std::sqrt(square);
  const std::uint32_t texel = scene.environment_texels[row / parts * texels + column / parts];
  return {point / distance, to_double(environment_texel(texel)) / (square * distance)};
}

}  // namespace

void place_environment_lights(const Scene& scene, std::uint32_t count, EnvironmentLights* lights) {
  CHECK(lights != nullptr && environment_of(scene) != nullptr);
  CHECK_LE(count, kEnvironmentLightMax);
  lights->count = 0, lights->wanted = count;
  CHECK_LE(environment_of(scene)->side * environment_of(scene)->side, scene.environment_texels.count);
  const std::uint32_t side = environment_of(scene)->side < kFinestSide ? kFinestSide : environment_of(scene)->side;
  double total = 0;
  for (std::uint32_t n = 0; n < side * side; ++n) total += luminance_of(texel_light(scene, side, n).irradiance);
  if (!(total > 0) || count == 0) return;
  const double share = total / count;
  Vec3d axis = {0, 0, 0}, sum = {0, 0, 0};
  double room = share;  // of the light that is being filled
  auto add = [&](const TexelLight& texel, double part) {
    axis += texel.direction * (part * luminance_of(texel.irradiance)), sum += texel.irradiance * part;
  };
  auto finish = [&] {
    const Vec3d unit = normalize(axis), scaled = sum / share;
    EnvironmentLight& light = lights->light[lights->count++];
    for (int c = 0; c < 3; ++c)
      light.direction[c] = static_cast<float>(unit[c]), light.irradiance[c] = static_cast<float>(scaled[c]);
    axis = sum = {0, 0, 0}, room = share;
  };
  for (std::uint32_t n = 0; n < side * side; ++n) {
    const TexelLight texel = texel_light(scene, side, n);
    const double luminance = luminance_of(texel.irradiance);
    double left = luminance;
    while (left > room && lights->count + 1 < count) {  // the last light takes what rounding leaves
      add(texel, room / luminance), left -= room;
      finish();
    }
    if (left > 0) add(texel, left / luminance), room -= left;
  }
  if (!is_zero(axis)) finish();
  CHECK_LE(lights->count, count);
}

}  // namespace pocketray
