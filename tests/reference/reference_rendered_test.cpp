// The renderer's picture against the same in double precision.
#include "desktop/reference/rendered.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "reference/reference_helpers.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

struct Comparison {
  int pixel_count = 0, unequal = 0;
  int unequal_max() const { return std::max(1, pixel_count / 200); }  // a small picture may have an edge, too
  double worst_equal = 0;                                             // relative difference of the others
};

// Renders without cut-off and compares; pixels count as different beyond a fraction `bound` of their radiance.
Comparison compare(const Scene& scene, Settings settings, double bound) {
  settings.cut_off_levels = 0;
  TestReference t(scene, settings);
  std::vector<Vec3d> picture(settings.width * settings.height);
  trace_as_rendered(t.reference, 0, settings.height, picture.data());
  Comparison c;
  for (const Vec3d& exact : picture) {
    Vec3d rendered = to_double(t.renderer->renderer.image[static_cast<std::uint32_t>(c.pixel_count++)]);
    Vec3d d = rendered - exact;
    double off = std::fmax(std::fmax(std::fabs(d.x), std::fabs(d.y)), std::fabs(d.z)) / max_component(exact);
    if (off > bound)
      ++c.unequal;
    else
      c.worst_equal = std::fmax(c.worst_equal, off);
  }
  return c;
}

}  // namespace

// Goal: the renderer's picture differs from the same in double precision only by rounding. Method: generated scenes
// with every single feature and with all, two samples per pixel with supersampling, both projections; differences
// beyond 10⁻⁴ of a pixel's radiance, as rays next to an edge may have, in at most one pixel of two hundred; with all
// features 3·10⁻³, as textures of curved glass amplify rounding.
TEST_CASE("reference_as_rendered_is_the_renderer_but_for_rounding") {
  std::uint32_t side = effort_side(24);
  const std::uint32_t all = kAllFeatures & ~bit(Feature::mip_map);  // its holes are repeated: too many edges
  for (int i = 0; i <= kFeatureCount; ++i) {
    std::uint32_t set = i == kFeatureCount ? all : 1u << i | bit(Feature::point_light);
    auto s = generate_scene(set, 23);
    if (i % 2 || set == all) s->cameras[0].projection = Projection::orthographic, s->cameras[0].vertical_extent = 3;
    s->bind();
    Settings settings = settings_for(set, side, side);
    settings.texture_filter = TextureFilter::bilinear;  // as the reference, which takes samples instead of levels
    settings.ray_depth = 5;
    Comparison c = compare(s->scene, settings, set == all ? 3e-3 : 1e-4);
    CAPTURE(set);
    CAPTURE(c.unequal);
    CAPTURE(c.worst_equal);
    CHECK(c.unequal <= c.unequal_max());
  }
}

// Goal, method: the same for `cornell`, whose sphere is a mirror and whose light is an area light.
TEST_CASE("reference_as_rendered_is_the_renderer_in_cornell") {
  auto cornell = build_builtin("cornell");
  Settings settings;
  settings.width = effort_side(60), settings.height = effort_side(45);
  Comparison c = compare(cornell->scene, settings, 1e-4);
  CAPTURE(c.unequal);
  CAPTURE(c.worst_equal);
  CHECK(c.unequal <= c.unequal_max());
}
