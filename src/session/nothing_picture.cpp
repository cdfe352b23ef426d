#include "session/nothing_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "accel/triangle.h"
#include "base/check.h"
#include "shade/camera.h"
#include "shade/contact.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kRaysMax = 1000;  // chosen, as for black pictures

enum class Seen { nothing, surface, transparent, culled };

// Visits the pixels of a grid, at most kRaysMax.
template <class Visit>
bool for_each_place(const Settings& settings, Visit visit) {
  std::uint32_t step = 1;
  while (((settings.width + step - 1) / step) * ((settings.height + step - 1) / step) > kRaysMax) ++step;
  for (std::uint32_t row = step / 2; row < settings.height; row += step)
    for (std::uint32_t column = step / 2; column < settings.width; column += step)
      if (!visit(column, row)) return false;
  return true;
}

bool is_transparent(const FrameData& frame, const Material& m, const Hit& hit) {
  if (m.alpha_mode == AlphaMode::opaque || !frame.kernels.alpha) return false;
  const float alpha =
      frame.kernels.alpha(*frame.scene, m, hit.triangle, hit.u, hit.v, frame.settings.texture_filter, kNoFootprints);
  return m.alpha_mode == AlphaMode::mask ? alpha < m.alpha_cutoff : !(alpha > 0);
}

// Finds the first visible surface behind a pixel's centre, otherwise the last invisible one.
Seen look(const FrameData& frame, std::uint32_t column, std::uint32_t row, std::uint32_t* material) {
  Ray ray = camera_ray(frame.view.camera, static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
  Seen seen = Seen::nothing;
  for (std::uint32_t layer = 0; layer < kTransparentLayerMax; ++layer) {
    Hit hit;
    frame.geometry.accel_info->closest(frame.geometry.accel, ray, nullptr, &hit, nullptr);
    if (hit.triangle == kNoTriangle) return seen;
    Surface s;
    frame.kernels.surface(frame, ray, hit, &s);
    *material = static_cast<std::uint32_t>(s.material - frame.scene->materials.begin());
    const bool is_culled = culls(*s.material, s.front, frame.mask);
    if (!is_culled && !is_transparent(frame, *s.material, hit)) return Seen::surface;
    seen = is_culled ? Seen::culled : Seen::transparent;
    ray.origin = safe_origin(s, -1);
  }
  return seen;
}

// Bounds of the scene's corners in the picture, in pixels, and how many of them are in front of the camera.
struct Extent {
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  std::uint32_t before = 0, all = 0;
  bool has_area = false;
};

Extent extent_of(const FrameData& frame) {
  const CameraRays& c = frame.view.camera;
  const Vec3d eye = to_double(c.eye), forward = to_double(c.forward), right = to_double(c.right), up = to_double(c.up);
  const double size[2] = {static_cast<double>(c.width), static_cast<double>(c.height)};
  Extent extent;
  for (const Triangle& t : frame.scene->triangles) {
    extent.has_area |= is_hittable(frame.scene->positions, t);
    for (int k = 0; k < 3; ++k) {
      const Vec3d d = to_double(frame.scene->positions[t.vertex(k)]) - eye;
      const double depth = dot(d, forward) / dot(forward, forward);
      ++extent.all;
      if (!(depth > 0)) continue;
      ++extent.before;
      const double scale = c.orthographic ? 1 : depth;
      const double at[2] = {(dot(d, right) / dot(right, right) / scale + 1) / 2 * size[0],
                            (1 - dot(d, up) / dot(up, up) / scale) / 2 * size[1]};
      for (int i = 0; i < 2; ++i)
        extent.low[i] = std::min(extent.low[i], at[i]), extent.high[i] = std::max(extent.high[i], at[i]);
    }
  }
  return extent;
}

const char* describe_place(const FrameData& frame) {
  const Extent extent = extent_of(frame);
  if (!extent.has_area) return "its triangles have no area at this time: their nodes are hidden or scaled to 0";
  if (extent.before == 0)
    return "all of it is behind the camera; turn it with --camera, or leave --camera out to frame the model";
  const bool is_beside = extent.before == extent.all && (extent.high[0] < 0 || extent.high[1] < 0 ||
                                                         extent.low[0] > static_cast<double>(frame.view.camera.width) ||
                                                         extent.low[1] > static_cast<double>(frame.view.camera.height));
  if (is_beside) return "all of it is beside the picture; aim with --camera, or leave --camera out to frame the model";
  if (extent.high[0] - extent.low[0] < 1 || extent.high[1] - extent.low[1] < 1)
    return "it is smaller than a pixel; bring the camera closer, or use a larger --size";
  return "no ray through a pixel's centre meets it; move the camera, or use a larger --size";
}

void describe_material(const Renderer& renderer, const std::vector<std::string>& names, std::uint32_t index, Seen seen,
                       char* text, std::size_t text_bytes) {
  char name[100];
  if (index < names.size() && !names[index].empty())
    std::snprintf(name, sizeof name, "'%.60s'", names[index].c_str());
  else
    std::snprintf(name, sizeof name, "%u of %u", index + 1, renderer.scene.materials.count);
  std::snprintf(text, text_bytes,
                seen == Seen::transparent
                    ? "material %s is fully transparent there; give it a higher opacity, or another alpha texture"
                    : "material %s shows its front only, and the camera sees the back; move the camera, or make the "
                      "material double-sided",
                name);
}

}  // namespace

bool explain_nothing(const Renderer& renderer, const std::vector<std::string>& material_names,
                     char (&text)[kBlackTextBytes]) {
  CHECK(renderer.frame.scene != nullptr);  // a frame has been rendered
  text[0] = 0;
  std::uint32_t counts[4] = {}, materials[4] = {};
  const bool is_nothing = for_each_place(renderer.settings, [&](std::uint32_t column, std::uint32_t row) {
    std::uint32_t material = 0;
    const Seen seen = look(renderer.frame, column, row, &material);
    ++counts[static_cast<int>(seen)], materials[static_cast<int>(seen)] = material;
    return seen != Seen::surface;
  });
  if (!is_nothing) return false;
  const int transparent = static_cast<int>(Seen::transparent), culled = static_cast<int>(Seen::culled);
  const Seen most = counts[culled] > counts[transparent] ? Seen::culled : Seen::transparent;
  char why[300];
  if (counts[static_cast<int>(most)] == 0)
    std::snprintf(why, sizeof why, "%s", describe_place(renderer.frame));
  else
    describe_material(renderer, material_names, materials[static_cast<int>(most)], most, why, sizeof why);
  std::snprintf(text, sizeof text, "the picture shows nothing of the model: %s", why);
  return true;
}

bool explain_picture(const Renderer& renderer, const std::vector<std::string>& material_names,
                     char (&text)[kBlackTextBytes]) {
  return explain_black(renderer, material_names, text) || explain_nothing(renderer, material_names, text);
}

}  // namespace pocketray
