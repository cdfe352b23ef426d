#include "desktop/reference/environment.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "desktop/reference/guide.h"
#include "desktop/reference/light.h"
#include "indirect/environment.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const EnvironmentInfo* shown_environment(const FrameData& frame) {
  return has(frame.mask, Effect::environment) ? environment_of(*frame.scene) : nullptr;
}

Vec3d texel_at(const Scene& scene, int column, int row) {
  const EnvironmentInfo& info = scene.environment_info[0];
  const std::uint32_t index = octahedral_index(column, row, static_cast<int>(info.side));
  return to_double(environment_texel(scene.environment_texels[index])) * static_cast<double>(info.scale);
}

// Maps a direction to side × side texels; their centres lie at halves.
void place_of(const Vec3d& direction, double side, double* x, double* y) {
  double u, v;
  to_octahedral(direction, &u, &v);
  *x = std::clamp((u + 1) / 2 * side, 0.0, side), *y = std::clamp((v + 1) / 2 * side, 0.0, side);
}

template <class Texel>
Vec3d map_at(const Scene& scene, const Vec3d& direction, Texel texel) {
  double x, y;
  place_of(direction, scene.environment_info[0].side, &x, &y);
  const int column = static_cast<int>(std::floor(x - 0.5)), row = static_cast<int>(std::floor(y - 0.5));
  const double s = x - 0.5 - column, t = y - 0.5 - row;
  return (texel(scene, column, row) * (1 - s) + texel(scene, column + 1, row) * s) * (1 - t) +
         (texel(scene, column, row + 1) * (1 - s) + texel(scene, column + 1, row + 1) * s) * t;
}
Vec3d map_at(const Scene& scene, const Vec3d& direction) { return map_at(scene, direction, texel_at); }

double luminance_of(const Vec3d& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

// A texel without what the directional light of the sun brings.
Vec3d dimmed_texel_at(const Scene& scene, int column, int row) {
  const EnvironmentInfo& info = scene.environment_info[0];
  const Vec3d texel = texel_at(scene, column, row);
  if (scene.environment_suns.empty()) return texel;
  const EnvironmentSun& sun = scene.environment_suns[0];
  const int side = static_cast<int>(info.side);
  const auto index = static_cast<int>(octahedral_index(column, row, side));
  const Vec3d direction =
      normalize(from_octahedral(2 * (index % side + 0.5) / side - 1, 2 * (index / side + 0.5) / side - 1));
  const double level = static_cast<double>(sun.surroundings), own = luminance_of(texel);
  if (-dot(direction, to_double(scene.lights[sun.light].direction)) < static_cast<double>(sun.cos_shown)) return texel;
  return own > level ? texel * (level / own) : texel;
}

// A piece of the square subtends its area / |point|³.
double cubed_distance(const Vec3d& point) {
  const double square = dot(point, point);
  return square * std::sqrt(square);
}

// Value of the diffuse and glossy lobes for light from all around in the renderer's model: the glossy lobe takes
// nothing from the diffuse light, and only diffuse light is shadowed, if shadows are simulated.
Vec3d value_in_model(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer,
                     const Vec3d& to_light) {
  const FrameData& frame = *reference.world.frame;
  Vec3d value = {0, 0, 0};
  const Material& m = lobes_of(s);
  if (reflects_surroundings(m))
    value = glossy_lobe(s).exact_value(m, s.specular, {0, 0, 0}, s, to_viewer, to_light) * s.passes;
  value = (value + coat_value(s, to_viewer, to_light)) * s.open;
  const Vec3d diffuse = s.even * (1 / kPi);
  if (!has(frame.mask, Effect::environment_shadow) || is_zero(diffuse)) return value + diffuse * s.open;
  return value + diffuse * transmittance(reference.world, leave(frame, s, to_light, kInfinity), {kNone, nullptr, true});
}

Vec3d light_in_model(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer,
                     ReferenceSamples* samples) {
  const FrameData& frame = *reference.world.frame;
  Vec3d sum = {0, 0, 0};
  auto add = [&](const Vec3d& direction, double density, double other) {
    const double cosine = dot(s.normal, direction);
    if (!(cosine > 0) || !(density > 0)) return;
    sum += value_in_model(reference, s, to_viewer, direction) * map_at(*frame.scene, direction, dimmed_texel_at) *
           (cosine * power_heuristic(density, other) / density);
  };
  const double u = samples->next(), v = samples->next();
  Vec3d direction = sample_environment(reference, {u, v});
  add(direction, environment_density(reference, direction), lobe_density(s, to_viewer, direction));
  const double choice = samples->next(), u2 = samples->next(), v2 = samples->next();
  if (sample_lobes(s, to_viewer, choice, {u2, v2}, &direction))
    add(direction, lobe_density(s, to_viewer, direction), environment_density(reference, direction));
  return sum;
}

// Visible fraction of the distant lights that reach the surface.
Vec3d openness_as_rendered(const Reference& reference, const ReferenceSurface& s) {
  const FrameData& frame = *reference.world.frame;
  Vec3d lit = {0, 0, 0}, open = {0, 0, 0};
  for (std::uint32_t i = 0; i < frame.environment_lights->count; ++i) {
    const EnvironmentLight& light = frame.environment_lights->light[i];
    const Vec3d direction = to_double(light.direction);
    const double cosine = dot(s.normal, direction);
    if (!(cosine > 0) || !(dot(s.geometric, direction) > 0)) continue;
    const Vec3d arriving = to_double(light.irradiance) * cosine;
    open += arriving;
    lit += arriving * transmittance(reference.world, leave(frame, s, direction, kInfinity), {kNone, nullptr, true});
  }
  for (int c = 0; c < 3; ++c) lit[c] = open[c] > 0 ? lit[c] / open[c] : 1;
  return lit;
}

}  // namespace

Vec3d radiance_behind(const FrameData& frame, const Vec3d& direction) {
  return shown_environment(frame) ? map_at(*frame.scene, direction) : to_double(frame.scene->info.background);
}

Vec3d radiance_beyond_depth(const FrameData& frame, const Vec3d& direction) {
  return shown_environment(frame) ? map_at(*frame.scene, direction) : to_double(frame.cut_off.beyond_depth);
}

std::size_t environment_shares_need(const FrameData& frame) {
  const EnvironmentInfo* info = shown_environment(frame);
  return info ? arena_need<double>(std::size_t(info->side) * info->side) : 0;
}

Array<double> make_environment_shares(const FrameData& frame, Arena* arena) {
  const EnvironmentInfo* info = shown_environment(frame);
  if (!info) return {};
  const int side = static_cast<int>(info->side);
  Array<double> shares = arena_array<double>(arena, std::size_t(info->side) * info->side);
  double total = 0;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      // Bilinear filtering spreads a texel over its neighbours.
      double around = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) around += luminance_of(texel_at(*frame.scene, column + i, row + j));
      total += around / cubed_distance(from_octahedral(2 * (column + 0.5) / side - 1, 2 * (row + 0.5) / side - 1));
      shares[static_cast<std::uint32_t>(row * side + column)] = total;
    }
  if (!(total > 0)) return {};
  for (double& share : shares) share /= total;
  CHECK_EQ(shares[shares.count - 1], 1);
  return shares;
}

double environment_density(const Reference& reference, const Vec3d& direction) {
  const Array<double>& shares = reference.environment_shares;
  if (shares.empty()) return 0;
  const int side = static_cast<int>(reference.world.frame->scene->environment_info[0].side);
  double x, y;
  place_of(direction, side, &x, &y);
  const int column = std::min(static_cast<int>(x), side - 1), row = std::min(static_cast<int>(y), side - 1);
  const auto index = static_cast<std::uint32_t>(row * side + column);
  const double share = shares[index] - (index > 0 ? shares[index - 1] : 0);
  return share * side * side / 4 * cubed_distance(from_octahedral(2 * x / side - 1, 2 * y / side - 1));
}

Vec3d sample_environment(const Reference& reference, const Pair& pair) {
  const Array<double>& shares = reference.environment_shares;
  if (shares.empty()) return {0, 1, 0};
  const int side = static_cast<int>(reference.world.frame->scene->environment_info[0].side);
  const auto index = static_cast<std::uint32_t>(
      std::min(std::upper_bound(shares.begin(), shares.end(), pair.u), shares.end() - 1) - shares.begin());
  const double before = index > 0 ? shares[index - 1] : 0;
  const double s = std::clamp((pair.u - before) / (shares[index] - before), 0.0, 1.0);  // uniform again
  const int column = static_cast<int>(index) % side, row = static_cast<int>(index) / side;
  return normalize(from_octahedral(2 * (column + s) / side - 1, 2 * (row + pair.v) / side - 1));
}

Vec3d environment_light(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
                        const Vec3d& to_viewer, bool goes_on, ReferenceSamples* samples) {
  const FrameData& frame = *reference.world.frame;
  if (reference.environment_shares.empty()) return {0, 0, 0};
  if (options.transport == Transport::model) {
    if (!environment_lights(*frame.scene, frame.mask, frame.settings.indirect)) return {0, 0, 0};
    return light_in_model(reference, s, to_viewer, samples);
  }
  const double u = samples->next(), v = samples->next();
  const Vec3d direction = sample_environment(reference, {u, v});
  const double cosine = dot(s.normal, direction), density = environment_density(reference, direction);
  if (!(cosine > 0) || !(density > 0)) return {0, 0, 0};
  const double weight = goes_on ? power_heuristic(density, guided_density(s, to_viewer, direction)) : 1;
  const Vec3d sum = lobe_value(s, to_viewer, direction) * map_at(*frame.scene, direction) * (cosine * weight / density);
  if (is_zero(sum)) return sum;
  return sum * transmittance(reference.world, leave(frame, s, direction, kInfinity), {kNone, nullptr, true});
}

Vec3d environment_light_as_rendered(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer) {
  const FrameData& frame = *reference.world.frame;
  const Scene& scene = *frame.scene;
  if (!environment_lights(scene, frame.mask, frame.settings.indirect)) return {0, 0, 0};
  const bool casts = has(frame.mask, Effect::environment_shadow) && !is_zero(s.even);
  Vec3d sum = {0, 0, 0};
  if (environment_lights_diffuse(frame.mask))
    sum = s.even * environment_irradiance(scene.environment_info[0], s.normal) *
          (casts ? openness_as_rendered(reference, s) : Vec3d{s.open, s.open, s.open});
  if (reflects_surroundings(lobes_of(s))) {
    const Vec3 normal = to_float(s.normal);
    const Vec3 way = to_float(-to_viewer), irradiance = environment_irradiance(scene.environment_info[0], normal);
    const Vec3 specular = to_float(s.specular);
    const Vec3 reflected =
        is_zero(s.grain)
            ? reflected_environment(scene, lobes_of(s), specular, normal, way, irradiance)
            : reflected_along_grain(scene, lobes_of(s), specular, {normal, to_float(s.grain)}, way, irradiance);
    sum += to_double(reflected) * (s.open * s.passes);
  }
  if (s.coat_lobe > 0) {
    const Vec3 normal = to_float(s.coat_normal), irradiance = environment_irradiance(scene.environment_info[0], normal);
    const Vec3 reflected =
        reflected_environment(scene, s.coat, s.coat.specular, normal, to_float(-to_viewer), irradiance);
    sum += to_double(reflected) * (s.open * s.coat_lobe);
  }
  return sum;
}

}  // namespace pocketray
