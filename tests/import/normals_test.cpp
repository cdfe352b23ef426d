// Smoothing and texture halving.
#include "desktop/import/normals.h"

#include <cmath>
#include <cstring>

#include "base/fmath.h"
#include "desktop/import/image.h"
#include "import/import_testing.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

// Two unit squares that share an edge along z, folded by `degrees`; as a soup, so that welding is tested too.
MeshData folded(double degrees) {
  float c = static_cast<float>(det_cos(radians(degrees))), s = static_cast<float>(det_sin(radians(degrees)));
  MeshData mesh;
  mesh.positions = {{-1, 0, 0}, {-1, 0, 1}, {0, 0, 1}, {-1, 0, 0}, {0, 0, 1}, {0, 0, 0},
                    {0, 0, 0},  {0, 0, 1},  {c, s, 1}, {0, 0, 0},  {c, s, 1}, {c, s, 0}};
  for (std::uint32_t i = 0; i < 12; ++i) mesh.indices.push_back(i);
  return mesh;
}

}  // namespace

// Goal: folds below the crease angle are smoothed, above it they stay sharp. Method: normals along the shared edge.
TEST_CASE("smooth_normals_smooths_below_the_crease_angle_only") {
  MeshData soft = folded(30);
  smooth_normals(&soft, 40);
  REQUIRE(soft.normals.size() == soft.positions.size());
  int on_edge = 0;
  for (std::size_t c = 0; c < soft.indices.size(); ++c) {
    std::uint32_t v = soft.indices[c];
    if (soft.positions[v].x != 0) continue;
    ++on_edge;
    CHECK(soft.normals[v].x == doctest::Approx(-std::sin(radians(15.0))).epsilon(1e-5));
    CHECK(soft.normals[v].y == doctest::Approx(std::cos(radians(15.0))).epsilon(1e-5));
  }
  CHECK(on_edge == 6);
  MeshData sharp = folded(50);
  smooth_normals(&sharp, 40);
  CHECK(sharp.normals.empty());  // flat everywhere: the geometric normals do
}

// Goal: the mean does not depend on how a face is cut into triangles: each is weighted by its angle. Method: a cube
// corner whose three faces have one, two and two triangles there, all smoothed.
TEST_CASE("smooth_normals_weights_by_angle") {
  MeshData mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 1}};
  mesh.indices = {0, 3, 1, 0, 5, 4, 0, 4, 3, 0, 1, 6, 0, 6, 5};
  smooth_normals(&mesh, 180);
  REQUIRE(!mesh.normals.empty());
  float expected = -1 / std::sqrt(3.0f);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (is_zero(mesh.positions[v]))
      for (int c = 0; c < 3; ++c) CHECK(mesh.normals[v][c] == doctest::Approx(expected).epsilon(1e-5));
}

// Goal: hard-case normals are finite. Method: degenerate triangles among sound ones, coordinates 1e-30 and 1e15.
TEST_CASE("hard_30_smoothed_normals_are_unit_or_zero") {
  count_assertions("unit or zero");
  for (float scale : {1e-30f, 1.0f, 1e15f}) {
    MeshData mesh = folded(20);
    for (Vec3& p : mesh.positions) p = p * scale;
    mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 2, 2, 2});
    smooth_normals(&mesh, 40);
    REQUIRE(!mesh.normals.empty());
    for (const Vec3& n : mesh.normals) CHECK((is_zero(n) || std::fabs(length(n) - 1) < 1e-6f));
  }
}

// Goal: halving averages light, not levels, and transparent texels lend no colour. Method: black and white make 188; a
// red and a transparent green texel make red of half the alpha; odd sides round up.
TEST_CASE("shrink_image_halves_in_linear_light_weighted_by_alpha") {
  auto texel = [](std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t a) {
    std::uint8_t bytes[4] = {r, g, b, a};
    std::uint32_t packed;
    std::memcpy(&packed, bytes, 4);
    return packed;
  };
  Image image;
  image.width = 5, image.height = 2;
  image.texels.assign(10, texel(0, 0, 0, 255));
  image.texels[1] = image.texels[5] = texel(255, 255, 255, 255);
  for (std::size_t i : {2u, 7u}) image.texels[i] = texel(255, 0, 0, 255);
  for (std::size_t i : {3u, 8u}) image.texels[i] = texel(0, 255, 0, 0);
  shrink_image(&image, 4);
  REQUIRE(image.width == 3);
  REQUIRE(image.height == 1);
  CHECK(image.texels[0] == texel(188, 188, 188, 255));
  CHECK(image.texels[1] == texel(255, 0, 0, 128));
  CHECK(image.texels[2] == texel(0, 0, 0, 255));
  shrink_image(&image, 1);
  CHECK((image.width == 1 && image.height == 1));
}
