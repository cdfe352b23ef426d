// Scene files that are read without the levels of textures for which there is no room.
#include "session/baked_file.h"

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "base/rng.h"
#include "scene/baked_file.h"
#include "scene/baked_layout.h"
#include "scene/texel_blocks.h"
#include "scene/texture_side.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// A floor and a box with textures of all kinds: with levels, without, in blocks, and two that share texels.
std::unique_ptr<GeneratedScene> textured_scene() {
  auto s = generate_scene(bit(Feature::texture) | bit(Feature::point_light) | bit(Feature::ambient), 5);
  Rng rng = make_rng(11);
  auto add = [&](std::uint32_t width, std::uint32_t height, std::uint32_t level_count, TexelFormat format) {
    Texture t = {};
    t.texel_begin = static_cast<std::uint32_t>(s->texels.size());
    t.width = static_cast<std::uint16_t>(width), t.height = static_cast<std::uint16_t>(height);
    t.level_count = static_cast<std::uint8_t>(level_count), t.format = format;
    for (std::uint32_t i = level_words(format, width, height, level_count); i > 0; --i)
      s->texels.push_back(next_u32(&rng) | 0xFF000000u);
    s->textures.push_back(t);
  };
  add(64, 64, 7, TexelFormat::exact);
  add(50, 17, 6, TexelFormat::color4);
  add(40, 40, 1, TexelFormat::exact);
  add(128, 32, 8, TexelFormat::exact);
  s->textures.push_back(s->textures.back());
  s->textures.back().wrap_u = Wrap::mirror;
  for (std::size_t i = 0; i < s->materials.size(); ++i)
    s->materials[i].diffuse_texture.texture = static_cast<std::uint32_t>(i % s->textures.size());
  s->bind();
  return s;
}

// The scene's file without levels beyond a side, made by copying each texture's remaining texels; textures with equal
// beginnings share them.
BakedFile baked_without(const Scene& scene, std::uint32_t side_max) {
  std::vector<Texture> textures(scene.textures.begin(), scene.textures.end());
  std::vector<std::uint32_t> texels;
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const Texture rest = without_levels_beyond(textures[i], side_max);
    std::size_t same = 0;
    while (same < i && scene.textures[static_cast<std::uint32_t>(same)].texel_begin != textures[i].texel_begin) ++same;
    textures[i] = rest;
    textures[i].texel_begin = same < i ? textures[same].texel_begin : static_cast<std::uint32_t>(texels.size());
    if (same < i) continue;
    const std::uint32_t* from = scene.texels.data + rest.texel_begin;
    texels.insert(texels.end(), from, from + level_words(rest.format, rest.width, rest.height, rest.level_count));
  }
  Scene limited = scene;
  limited.textures = {textures.data(), static_cast<std::uint32_t>(textures.size())};
  limited.texels = {texels.data(), static_cast<std::uint32_t>(texels.size())};
  return bake(limited);
}

// Memory of a given size, and what was read into it.
struct Room {
  std::vector<std::uint8_t> block;
  Arena arena;
  FittedFile file;
  Status status;
  Room(const BakedFile& from, std::uint32_t side_max, std::size_t byte_count)
      : block(byte_count + kArenaAlignment, 0xA5), arena(make_arena("scene", block.data(), block.size())) {
    arena.capacity = byte_count;
    status = read_fitted(bytes_in_memory(from.data(), from.size()), side_max, &arena, &file);
  }
};

bool holds(const FittedFile& file, const BakedFile& expected) {
  return file.byte_count == expected.size() && std::memcmp(file.bytes, expected.data(), expected.size()) == 0;
}

}  // namespace

// Goal: a file read without its largest levels is the file that would have been baked without them, and the source's
// hash stays known.
TEST_CASE("fitted_file_equals_one_baked_without_the_levels") {
  const auto scene = textured_scene();
  const BakedFile whole = bake(scene->scene);
  for (std::uint32_t side_max : {1u, 2u, 3u, 8u, 16u, 31u, 32u, 64u, 100u, 127u}) {
    CAPTURE(side_max);
    const Room room(whole, side_max, whole.size());
    REQUIRE(room.status.ok);
    REQUIRE(holds(room.file, baked_without(scene->scene, side_max)));
    CHECK(!room.file.is_whole);
    CHECK(room.file.texture_side_max == side_max);
    CHECK(room.file.whole == content_hash(whole.data(), whole.size()));
    CHECK(room.arena.used == room.file.byte_count);
    Scene opened;
    CHECK(baked_open(room.file.bytes, room.file.byte_count, &opened).ok);
    CHECK(kept_texel_bytes(scene->scene.textures, side_max) == opened.texels.bytes());
  }
  for (std::uint32_t side_max : {128u, 512u, kTextureSideMax}) {
    const Room room(whole, side_max, whole.size());
    REQUIRE(holds(room.file, whole));
    CHECK(room.file.is_whole);
  }
}

// Goal: as many levels as fit are read, and none if not even the smallest do. Method: every amount of memory, in steps
// of the arena's alignment.
TEST_CASE("fitted_file_has_the_largest_levels_that_fit") {
  const auto scene = textured_scene();
  const BakedFile whole = bake(scene->scene);
  const std::size_t least = baked_without(scene->scene, 1).size();
  std::uint32_t before = 0;
  for (std::size_t bytes = 0; bytes <= whole.size(); bytes += kArenaAlignment) {
    CAPTURE(bytes);
    const Room room(whole, kTextureSideMax, bytes);
    REQUIRE(room.status.ok);
    REQUIRE((room.file.bytes != nullptr) == (bytes >= least));
    if (!room.file.bytes) continue;
    CHECK(room.file.byte_count <= bytes);
    CHECK(room.file.texture_side_max >= before);
    before = room.file.texture_side_max;
    if (!room.file.is_whole) CHECK(baked_without(scene->scene, 2 * before).size() > bytes);
  }
  CHECK(before == kTextureSideMax);
}

// Goal: damage anywhere is found, also in levels that are left out.
TEST_CASE("fitted_file_that_is_damaged_stays_damaged") {
  const auto scene = textured_scene();
  const BakedFile whole = bake(scene->scene);
  Rng rng = make_rng(3);
  for (int i = 0; i < 400; ++i) {
    BakedFile damaged = bake(scene->scene);
    const std::size_t at = sizeof(FileHeader) + next_u32(&rng) % (whole.size() - sizeof(FileHeader));
    damaged.data()[at] ^= static_cast<std::uint8_t>(1 + next_u32(&rng) % 255);
    CAPTURE(at);
    const Room room(damaged, 8, whole.size());
    Scene opened;
    REQUIRE(room.status.ok);
    REQUIRE(room.file.bytes != nullptr);
    CHECK(!baked_open(room.file.bytes, room.file.byte_count, &opened).ok);
  }
}

// Goal: a file of a version before the joined sums is read without levels, too, and damage to it is found.
TEST_CASE("fitted_file_of_an_older_version_keeps_its_checksum") {
  const auto scene = textured_scene();
  const BakedFile whole = bake(scene->scene), expected = baked_without(scene->scene, 8);
  for (const BakedFile* file : {&whole, &expected}) {
    put_u32(*file, kVersionAt, kJoinedSumVersion - 1);
    fix_checksum(*file);
  }
  Scene opened;
  const Room room(whole, 8, whole.size());
  REQUIRE(room.status.ok);
  CHECK(holds(room.file, expected));
  CHECK(baked_open(room.file.bytes, room.file.byte_count, &opened).ok);
  whole.data()[whole.size() / 2] ^= 1;
  const Room damaged(whole, 8, whole.size());
  CHECK(!baked_open(damaged.file.bytes, damaged.file.byte_count, &opened).ok);
}

// Goal: a hostile table of textures or sections under a right checksum ends in one line. Method: every byte of a
// texture and of the sections of textures and texels, several values each.
TEST_CASE("fitted_file_refuses_wrong_levels") {
  const auto scene = textured_scene();
  const BakedFile whole = bake(scene->scene);
  std::uint64_t textures_at;
  std::memcpy(&textures_at, whole.data() + kTableAt + kTexturesSection * kSectionBytes + 8, 8);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < scene->textures.size() * sizeof(Texture); ++i)
    places.push_back(static_cast<std::size_t>(textures_at) + i);
  for (std::size_t i = 0; i < 2 * kSectionBytes; ++i) places.push_back(kTableAt + kTexturesSection * kSectionBytes + i);
  int opened_count = 0, refused_count = 0;
  for (std::size_t at : places)
    for (std::uint8_t value : {0x00, 0x01, 0x0F, 0x40, 0x7F, 0xFF}) {
      CAPTURE(at);
      BakedFile hostile = bake(scene->scene);
      hostile.data()[at] = value;
      fix_checksum(hostile);
      const Room room(hostile, 8, 2 * whole.size());
      REQUIRE(room.status.ok);
      if (!room.file.bytes) continue;
      Scene opened;
      const Status status = baked_open(room.file.bytes, room.file.byte_count, &opened);
      status.ok ? ++opened_count : ++refused_count;
      CHECK(std::strchr(status.message, '\n') == nullptr);
    }
  CHECK(opened_count > 0);
  CHECK(refused_count > 100);
}

// Goal: a file of an old version, or cut short at any byte, is read as it is, for baked_open() to judge.
TEST_CASE("fitted_file_of_another_form_is_read_whole") {
  const auto scene = textured_scene();
  const BakedFile whole = bake(scene->scene);
  for (std::size_t count : {std::size_t(1), std::size_t(63), std::size_t(64), std::size_t(65), whole.size() - 1}) {
    CAPTURE(count);
    BakedFile part(count);
    std::memcpy(part.data(), whole.data(), count);
    const Room room(part, 8, whole.size());
    REQUIRE(room.status.ok);
    CHECK(holds(room.file, part));
  }
  put_u32(whole, kVersionAt, 6);
  CHECK(holds(Room(whole, 8, whole.size()).file, whole));
}
