// Bodies are told from sheets.
#include "desktop/radiosity/bodies.h"

#include <doctest/doctest.h>

#include <memory>

#include "support/generated_scene.h"

using namespace pocketray;

namespace {

void add_sheet(GeneratedScene* s, const Vec3& corner, const Vec3& along, const Vec3& up, std::uint32_t material) {
  add_quad(s, corner, corner + along, corner + along + up, corner + up, material);
}

}  // namespace

// Goal: closed surfaces are bodies, and lamps, plates and open boxes are not. Method: one of
// each in a scene.
TEST_CASE("bodies_are_closed") {
  auto s = std::make_unique<GeneratedScene>();
  Material m;
  m.double_sided = 0;
  add_material(s.get(), m);
  add_sheet(s.get(), {0, 0, 0}, {0, 0, 4}, {4, 0, 0}, 0);
  add_box(s.get(), {1, 0, 1}, {2, 1, 2}, 0);
  const std::uint32_t closed = static_cast<std::uint32_t>(s->triangles.size());
  add_sheet(s.get(), {3, 0, 1}, {1, 0, 0}, {0, 1, 0}, 0), add_sheet(s.get(), {3, 0, 2}, {1, 0, 0}, {0, 1, 0}, 0);
  add_sheet(s.get(), {3, 0, 1}, {0, 0, 1}, {0, 1, 0}, 0), add_sheet(s.get(), {4, 0, 1}, {0, 0, 1}, {0, 1, 0}, 0);
  s->bind();
  const std::vector<char> bodies = find_bodies(s->scene);
  REQUIRE(bodies.size() == s->scene.triangles.count);
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    CAPTURE(i);
    CHECK(bodies[i] == (i >= 2 && i < closed));
  }
}
