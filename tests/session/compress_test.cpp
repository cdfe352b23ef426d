// Which textures bake puts into which blocks.
#include "session/compress.h"

#include <doctest/doctest.h>

#include "scene/baked.h"
#include "scene/texel_blocks.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

using Rows = std::vector<std::array<int, 4>>;

// 32 × 32 texels of one kind with all levels, for a material of its own.
std::uint32_t add(GeneratedScene* s, const std::array<int, 4>& texel) {
  const std::uint32_t texture = add_texture(s, 32, 32, Rows(32 * 32, texel));
  add_levels(s, texture);
  return texture;
}

// The format that the texture gets for the uses that `use` sets, and as a grain's, a coat's or a sheen's.
template <class Use>
TexelFormat format_for(const std::array<int, 4>& texel, Use use, bool turns_a_grain = false,
                       TextureUse ClearCoat::*coat = nullptr, TextureUse Sheen::*sheen = nullptr) {
  GeneratedScene s;
  const std::uint32_t texture = add(&s, texel), material = add_material(&s, Material());
  s.material_maps.resize(s.materials.size());
  use(&s.materials[material], &s.material_maps[material], texture);
  if (turns_a_grain) s.grains.resize(s.materials.size()), s.grains[material].texture.texture = texture;
  if (coat) s.clear_coats.resize(s.materials.size()), (s.clear_coats[material].*coat).texture = texture;
  if (sheen) s.sheens.resize(s.materials.size()), (s.sheens[material].*sheen).texture = texture;
  add_quad(&s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, material);
  s.with_uvs = true;
  s.bind();
  CompressedTextures compressed;
  compress_textures(&s.scene, &compressed);
  const Status status = validate_scene(s.scene);
  CHECK_MESSAGE(status.ok, status.message);
  const TexelFormat format = s.scene.textures[texture].format;
  CHECK(compressed.report.size() == (format == TexelFormat::exact ? 0u : 1u));
  // Earlier texels of the test belong to no texture.
  CHECK(s.scene.texels.count == level_words(format, 32, 32, 6));
  return format;
}

}  // namespace

// Goal: a texture gets the smallest blocks that hold what its materials read; what blocks cannot hold stays exact.
// Method: each use alone and together.
TEST_CASE("compress_chooses_blocks_by_use") {
  using M = Material;
  using P = MaterialMaps;
  const std::array<int, 4> plain = {{10, 200, 180, 255}}, clear = {{10, 200, 180, 99}}, inward = {{128, 128, 30, 255}};
  auto diffuse = [](M* m, P*, std::uint32_t t) { m->diffuse_texture.texture = t; };
  auto emission = [](M* m, P*, std::uint32_t t) { m->emission_texture.texture = t; };
  auto normal = [](M*, P* maps, std::uint32_t t) { maps->normal.texture = t; };
  auto lobes = [](M* m, P* maps, std::uint32_t t) {
    m->specular = {0.1f, 0.1f, 0.1f}, maps->metallic_roughness.texture = t;
  };
  auto occlusion = [](M*, P* maps, std::uint32_t t) { maps->occlusion.texture = t; };
  CHECK(format_for(plain, diffuse) == TexelFormat::color4);
  CHECK(format_for(clear, diffuse) == TexelFormat::color_alpha8);
  CHECK(format_for(clear, emission) == TexelFormat::color4);  // its alpha is not read
  CHECK(format_for(plain, normal) == TexelFormat::normal8);
  CHECK(format_for(inward, normal) == TexelFormat::numbers12);
  CHECK(format_for(plain, lobes) == TexelFormat::green_blue8);
  CHECK(format_for(plain, occlusion) == TexelFormat::red4);
  CHECK(format_for(plain, [&](M* m, P* p, std::uint32_t t) { lobes(m, p, t), occlusion(m, p, t); }) ==
        TexelFormat::numbers12);
  CHECK(format_for(plain, [&](M* m, P* p, std::uint32_t t) { diffuse(m, p, t), normal(m, p, t); }) ==
        TexelFormat::exact);
  auto nothing = [](M*, P*, std::uint32_t) {};
  CHECK(format_for(plain, nothing) == TexelFormat::exact);
  CHECK(format_for(plain, nothing, true) == TexelFormat::numbers12);
  CHECK(format_for(plain, occlusion, true) == TexelFormat::numbers12);
  CHECK(format_for(plain, normal, true) == TexelFormat::numbers12);
  CHECK(format_for(plain, diffuse, true) == TexelFormat::exact);
  CHECK(format_for(plain, nothing, false, &ClearCoat::strength_texture) == TexelFormat::red4);
  CHECK(format_for(plain, nothing, false, &ClearCoat::roughness_texture) == TexelFormat::green_blue8);
  CHECK(format_for(plain, nothing, false, &ClearCoat::normal) == TexelFormat::normal8);
  CHECK(format_for(plain, lobes, false, &ClearCoat::strength_texture) == TexelFormat::numbers12);
  CHECK(format_for({{9, 9, 9, 77}}, nothing, false, nullptr, &Sheen::color_texture) == TexelFormat::color4);
  CHECK(format_for({{9, 9, 9, 77}}, nothing, false, nullptr, &Sheen::roughness_texture) == TexelFormat::color_alpha8);
}

// Goal: textures that share texels still do, and the error is reported once; a texture too small for blocks stays
// exact. Method: two textures of one run, and one of 1 × 1.
TEST_CASE("compress_keeps_shared_texels_shared") {
  GeneratedScene s;
  const std::uint32_t first = add(&s, {{1, 2, 3, 255}});
  s.textures.push_back(s.textures[first]);
  s.textures.back().wrap_u = Wrap::clamp;
  const std::uint32_t tiny = add_texture(&s, 1, 1, Rows(1, {{5, 6, 7, 8}}));
  for (std::uint32_t texture : {first, first + 1, tiny}) {
    Material m;
    m.diffuse_texture.texture = texture;
    add_material(&s, m);
  }
  s.with_uvs = true;
  s.bind();
  CompressedTextures compressed;
  compress_textures(&s.scene, &compressed);
  CHECK(s.scene.textures[first].texel_begin == s.scene.textures[first + 1].texel_begin);
  CHECK(s.scene.textures[first + 1].format == TexelFormat::color4);
  CHECK(s.scene.textures[first + 1].wrap_u == Wrap::clamp);
  CHECK(s.scene.textures[tiny].format == TexelFormat::exact);
  CHECK(s.scene.texels[s.scene.textures[tiny].texel_begin] == 0x08070605u);
  REQUIRE(compressed.report.size() == 1);
  CHECK(compressed.report[0].psnr > 40);
  CHECK(compressed.report[0].format == TexelFormat::color4);
}
