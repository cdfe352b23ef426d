// The stored environment: its texels, its map of directions, and what is refused.
#include "scene/environment.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <string>

#include "base/fmath.h"
#include "base/limits.h"
#include "scene/baked.h"
#include "scene/baked_file.h"
#include "scene/full_scene.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

Vec3d random_direction(Rng* rng) {
  for (;;) {
    const Vec3d d = {2 * next_double(rng) - 1, 2 * next_double(rng) - 1, 2 * next_double(rng) - 1};
    if (dot(d, d) > 1e-3) return normalize(d);
  }
}

}  // namespace

// Goal: texels keep colours to half a step of 511 of their largest part, and decoded colours exactly. Method: random
// colours over the whole range; the smallest and largest.
TEST_CASE("environment_texels_keep_colors") {
  Rng rng = make_rng(7);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::ldexp(1.0, static_cast<int>(next_u32(&rng) % 28) - 12);
    const Vec3d color = {size * next_double(&rng), size * next_double(&rng), size * next_double(&rng)};
    if (max_component(color) > double(kEnvironmentTexelMax)) continue;
    const std::uint32_t texel = to_environment_texel(color);
    const Vec3d found = to_double(environment_texel(texel));
    const double step = std::fmax(max_component(color) / 255, 0x1p-24);
    for (int c = 0; c < 3; ++c) CHECK(std::fabs(found[c] - color[c]) <= 0.501 * step);
    CHECK(environment_texel(to_environment_texel(found)) == environment_texel(texel));
  }
  CHECK(environment_texel(to_environment_texel({1, 0.5, 0.25})) == Vec3{1, 0.5f, 0.25f});
  CHECK(is_zero(environment_texel(to_environment_texel({0, 0, 0}))));
  CHECK(environment_texel(~0u) == Vec3{kEnvironmentTexelMax, kEnvironmentTexelMax, kEnvironmentTexelMax});
}

// Goal: the map of directions is one to one, covers the sphere, and continues across the edges of its square. Method:
// there and back; texels' solid angles sum to 4π; texels beyond the edge lie next to those at it.
TEST_CASE("environment_octahedral_map_covers_the_sphere_without_seams") {
  Rng rng = make_rng(8);
  for (int i = 0; i < 10000; ++i) {
    const Vec3d d = random_direction(&rng);
    double u, v;
    to_octahedral(d, &u, &v);
    CHECK(std::fmax(std::fabs(u), std::fabs(v)) <= 1);
    const Vec3d back = normalize(from_octahedral(u, v)) - d;
    CHECK(dot(back, back) < 1e-28);
  }
  constexpr int side = 64;
  auto direction = [](int column, int row) {
    return normalize(from_octahedral(2 * (column + 0.5) / side - 1, 2 * (row + 0.5) / side - 1));
  };
  double solid_angle = 0;
  for (int i = 0; i < side * side; ++i) {
    const Vec3d p = from_octahedral(2 * (i % side + 0.5) / side - 1, 2 * (i / side + 0.5) / side - 1);
    solid_angle += 4.0 / (side * side) / std::pow(dot(p, p), 1.5);
  }
  CHECK(solid_angle == doctest::Approx(4 * kPi).epsilon(1e-3));
  for (int i = 0; i < side; ++i)
    for (int edge = 0; edge < 4; ++edge) {
      const bool across = edge < 2;
      const int at = edge % 2 ? side - 1 : 0, beyond = edge % 2 ? side : -1;
      const Vec3d here = across ? direction(at, i) : direction(i, at);
      const std::uint32_t index = across ? octahedral_index(beyond, i, side) : octahedral_index(i, beyond, side);
      const Vec3d there = direction(static_cast<int>(index) % side, static_cast<int>(index) / side);
      const double turn = det_acos(dot(here, there));
      CHECK(turn < 5.0 / side);
      CHECK(turn > 0.2 / side);
    }
  CHECK(octahedral_index(-1, -1, side) == side * side - 1);
}

// Goal: files of earlier versions are read: 7 has no environments, grains and tangents, 8 no grains and tangents, 9 no
// second texture coordinates, 10 no clear coats and divided triangles, 11 no default views, 12 no labels of
// animations and no origin, 13 no grids that are cut apart, 14 no reductions, 16 no sheens, 17 no framings, 18 no
// maps of glass, thin films, near planes and suns, 19 no diffuse transmission. Method: such files, made from today's: a
// table without the last sections, so that data may begin earlier.
TEST_CASE("baked_open_reads_files_of_earlier_versions") {
  const struct {
    std::uint32_t version;
    std::size_t sections;
  } cases[] = {{7, 33},  {8, 35},  {9, 37},  {10, 38}, {11, 40}, {12, 41},
               {13, 44}, {14, 45}, {16, 46}, {17, 47}, {18, 48}, {19, 52}};
  for (const auto& c : cases) {
    CAPTURE(c.version);
    FullScene full;
    make_full_scene(5, 12, 4, &full);
    if (c.version < 8) full.environment_info.clear(), full.environment_texels.clear();
    if (c.version < 9) full.grains.clear(), full.tangents.clear();
    if (c.version < 10) full.second_uvs.clear(), full.textures[1].uv_set = 0;
    if (c.version < 11) full.clear_coats.clear(), full.radiosity_splits.clear(), full.radiosity_triangles[2] = 0;
    if (c.version < 12) full.default_view.clear();
    if (c.version < 13) full.animation_labels.clear(), full.node_visible.clear(), full.origin.clear();
    if (c.version < 14) full.radiosity_cuts.clear(), full.radiosity_triangles[3] = kRadiosityGridBit;
    if (c.version < 15) full.reductions.clear();
    if (c.version < 17) full.sheens.clear();
    if (c.version < 18) full.framings.clear();
    if (c.version < 19) full.glass_maps.clear(), full.iridescences.clear();
    if (c.version < 19) full.camera_near.clear(), full.environment_suns.clear();
    full.diffuse_transmissions.clear(), full.bind();
    const BakedFile now = bake(full.scene);
    auto data_begin = [](std::size_t sections) { return (kTableAt + sections * kSectionBytes + 63) / 64 * 64; };
    const std::size_t begin = data_begin(c.sections), shift = data_begin(53) - begin;
    BakedFile before(now.size() - shift);
    std::memset(before.data(), 0, begin);
    std::memcpy(before.data(), now.data(), kTableAt + c.sections * kSectionBytes);
    std::memcpy(before.data() + begin, now.data() + begin + shift, now.size() - begin - shift);
    put_u32(before, kVersionAt, c.version), put_u64(before, kByteCountAt, before.size());
    put_u32(before, kSectionCountAt, static_cast<std::uint32_t>(c.sections));
    for (std::size_t kind = 0; kind < c.sections; ++kind) {
      std::uint64_t offset;
      std::memcpy(&offset, before.data() + kTableAt + kind * kSectionBytes + 8, sizeof offset);
      put_u64(before, kTableAt + kind * kSectionBytes + 8, offset - shift);
    }
    fix_checksum(before);
    Scene opened;
    const Status status = baked_open(before.data(), before.size(), &opened);
    REQUIRE_MESSAGE(status.ok, status.message);
    CHECK(scene_hash(opened) == scene_hash(full.scene));
    CHECK(opened.environment_info.empty() == (c.version < 8));
    CHECK((opened.grains.empty() == (c.version < 9) && opened.tangents.empty() == (c.version < 9)));
    CHECK((opened.second_uvs.empty() == (c.version < 10) && opened.clear_coats.empty() == (c.version < 11)));
    CHECK((opened.radiosity_splits.empty() == (c.version < 11) && opened.default_view.empty() == (c.version < 12)));
    CHECK((opened.origin.empty() == (c.version < 13) && opened.radiosity_cuts.empty() == (c.version < 14)));
    put_u32(before, kSectionCountAt, c.sections == 47 ? 48 : 47);
    fix_checksum(before);
    CHECK_FALSE(baked_open(before.data(), before.size(), &opened).ok);
  }
}

// Goal: an environment with a bad size, number or texel is refused, and the line names it; a sound one survives a file.
TEST_CASE("environment_that_is_unsound_is_refused_by_name") {
  FullScene sound;
  make_full_scene(6, 12, 4, &sound);
  REQUIRE(validate_scene(sound.scene).ok);
  const BakedFile file = bake(sound.scene);
  Scene opened;
  REQUIRE(baked_open(file.data(), file.size(), &opened).ok);
  CHECK(scene_hash(opened) == scene_hash(sound.scene));
  CHECK(opened.environment_texels.count == environment_texel_count(4, 4));
  auto refuses = [](const char* what, const std::function<void(FullScene*)>& change) {
    FullScene full;
    make_full_scene(6, 12, 4, &full);
    change(&full);
    full.bind();
    const Status status = validate_scene(full.scene);
    CAPTURE(what);
    CHECK_FALSE(status.ok);
    CHECK(std::string(status.message).find(what) != std::string::npos);
  };
  using F = FullScene;
  for (std::uint32_t bad : {0u, 3u, 2 * kEnvironmentSideMax, 0x80000000u, ~0u}) {
    refuses("].side", [=](F* f) { f->environment_info[0].side = bad; });
    refuses("].gloss_side", [=](F* f) { f->environment_info[0].gloss_side = bad; });
  }
  refuses("].gloss_side", [](F* f) { f->environment_info[0].gloss_side = 2; });
  refuses("environment_texels", [](F* f) { f->environment_info[0].side = 8; });
  refuses("environment_texels", [](F* f) { f->environment_texels.pop_back(); });
  refuses("environment_texels", [](F* f) { f->environment_texels.clear(); });
  refuses("environment_info", [](F* f) { f->environment_info.clear(); });
  refuses("environment_info", [](F* f) { f->environment_info.push_back(f->environment_info[0]); });
  for (float bad : {std::nanf(""), HUGE_VALF, -1.0f, 0.0f, 3.0f, 0x1p41f, 0x1p-41f})
    refuses("].scale", [=](F* f) { f->environment_info[0].scale = bad; });
  for (float bad : {std::nanf(""), HUGE_VALF, -1.0f, 2e18f})
    refuses("].radiance_max", [=](F* f) { f->environment_info[0].radiance_max.y = bad; });
  for (float bad : {std::nanf(""), -HUGE_VALF, 2e18f, -2e18f})
    refuses("].irradiance", [=](F* f) { f->environment_info[0].irradiance[8].z = bad; });
  refuses("environment_texels[57]", [](F* f) { f->environment_texels[57] = ~0u; });
}
