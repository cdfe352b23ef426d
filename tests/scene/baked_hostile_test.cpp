// Hostile files: every truncation, every flipped bit, and crafted tables. The result is an error or a valid scene.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "base/limits.h"
#include "scene/animate.h"
#include "scene/baked.h"
#include "scene/baked_file.h"
#include "scene/full_scene.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

BakedFile small_file() {
  FullScene full;
  make_full_scene(11, 12, 4, &full);
  return bake(full.scene);
}

// The message of opening the file, or "" if it opens.
std::string open_error(const BakedFile& file) {
  Scene scene;
  return baked_open(file.data(), file.size(), &scene).message;
}
bool mentions(const std::string& message, const char* what) {
  CAPTURE(message);
  return message.find(what) != std::string::npos;
}

std::size_t section_at(std::uint32_t kind) { return kTableAt + kind * kSectionBytes; }

// Poses the scene at a few times: under a sanitizer this shows that an accepted file holds no index out of range.
void use(const Scene& scene) {
  static std::uint8_t block[1 << 16];
  if (pose_need(scene) > sizeof block - 63) return;
  Arena arena = make_arena("pose", block, sizeof block);
  Pose pose = make_pose(scene, &arena);
  for (std::uint32_t a = 0; is_animated(scene) && a < scene.animations.count; ++a)
    for (double seconds : {0.3, 1.7}) pose_at(scene, a, seconds, &pose);
}

// Number of floats in the scene, and of those that are not finite.
struct FloatCount {
  int all = 0, bad = 0;
  void add(const float* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) ++all, bad += !std::isfinite(values[i]);
  }
  void add(float value) { add(&value, 1); }
  void add(const Vec2& v) { add(&v.x, 2); }
  void add(const Vec3& v) { add(&v.x, 3); }
  void add(const Transform& t) { add(&t.m[0][0], 12); }
  void add(const SkinWeight& w) { add(w.weight, 4); }
  void add(const Joint& j) { add(j.inverse_bind); }
  void add(const MovingMesh& m) { add(m.instance); }
  void add(const Animation& a) { add(a.duration); }
  void add(const Node& n) { add(n.translation), add(&n.rotation.x, 4), add(n.scale); }
  void add(const Camera& c) { add(c.eye), add(c.target), add(c.up), add(c.vertical_fov), add(c.vertical_extent); }
  void add(const Light& l) {
    add(l.position), add(l.direction), add(l.intensity), add(l.range), add(l.cos_inner), add(l.cos_outer);
  }
  void add(const EnvironmentInfo& e) {
    add(e.scale), add(e.radiance_max);
    for (const Vec3& coefficient : e.irradiance) add(coefficient);
  }
  void add(const Material& m) {
    for (const Vec3& v : {m.diffuse, m.specular, m.mirror, m.specular_tinted, m.mirror_tinted, m.transmission,
                          m.absorption, m.emission})
      add(v);
    for (float value : {m.exponent, m.roughness, m.grazing, m.ior, m.opacity, m.alpha_cutoff}) add(value);
    add(&m.diffuse_texture.m[0][0], 6), add(&m.emission_texture.m[0][0], 6);
  }
  template <class T>
  void add(Array<const T> array) {
    for (const T& element : array) add(element);
  }
};

FloatCount count_floats(const Scene& s) {
  FloatCount n;
  n.add(s.info.background), n.add(s.info.ambient), n.add(s.info.exposure), n.add(s.info.frames_per_second);
  n.add(s.info.auto_exposure), n.add(s.positions), n.add(s.normals), n.add(s.uvs), n.add(s.second_uvs),
      n.add(s.materials), n.add(s.lights);
  n.add(s.cameras), n.add(s.nodes), n.add(s.animations), n.add(s.key_times), n.add(s.key_values), n.add(s.weights);
  n.add(s.joints), n.add(s.moving_meshes), n.add(s.rest_positions), n.add(s.rest_normals), n.add(s.skin_weights);
  n.add(s.morph_positions), n.add(s.morph_normals), n.add(s.environment_info);
  return n;
}

}  // namespace

// Goal: HARDCASES row 8 in a .pray file: no float may be NaN, infinite or, as a coordinate, too large; the refusal
// names the element. Method: each word of a sound file in turn; files that still open hold only finite floats.
TEST_CASE("hard_08_baked_numbers_that_are_not_finite_are_refused_by_element") {
  BakedFile file = small_file();
  Scene scene;
  REQUIRE(baked_open(file.data(), file.size(), &scene).ok);
  int float_count = count_floats(scene).all;
  CHECK(float_count > 400);
  const std::size_t step =
      kEffortDivisor > 1 ? 13 : 1;  // words; a prime, so as not to hit the same field of a struct each time
  for (float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    std::uint32_t word, sound;
    std::memcpy(&word, &bad, sizeof word);
    int refused = 0, named = 0;
    for (std::size_t at = kTableAt; at < file.size(); at += 4 * step) {
      std::memcpy(&sound, file.data() + at, sizeof sound);
      put_u32(file, at, word);
      fix_checksum(file);
      Status status = baked_open(file.data(), file.size(), &scene);
      if (status.ok && count_floats(scene).bad) FAIL_CHECK("opened with ", static_cast<double>(bad), " at byte ", at);
      refused += !status.ok;
      named += !status.ok && (std::strchr(status.message, '[') || std::strstr(status.message, "info"));
      put_u32(file, at, sound);
    }
    int least = step == 1 ? float_count : float_count / static_cast<int>(2 * step);
    CHECK(refused >= least);
    CHECK(named >= least);
  }
}

// Goal: a truncated file is refused. Method: every length, in a block of exactly that length, so that a sanitizer sees
// any read beyond it; then again with a header that states the shorter length and a correct checksum.
TEST_CASE("baked_open_rejects_every_truncation") {
  BakedFile whole = small_file();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    BakedFile cut(length);
    std::memcpy(cut.data(), whole.data(), length);
    Scene scene;
    if (baked_open(cut.data(), length, &scene).ok) FAIL_CHECK("opened at length ", length);
    if (length < kTableAt) continue;
    put_u64(cut, kByteCountAt, length);
    fix_checksum(cut);
    if (baked_open(cut.data(), length, &scene).ok) FAIL_CHECK("opened with a fixed header at length ", length);
  }
}

// Goal: damage is detected. Method: every single bit of a file flipped.
TEST_CASE("baked_open_rejects_every_flipped_bit") {
  BakedFile file = small_file();
  for (std::size_t i = 0; i < file.size() * 8; ++i) {
    file.data()[i / 8] ^= static_cast<std::uint8_t>(1 << i % 8);
    Scene scene;
    if (baked_open(file.data(), file.size(), &scene).ok) FAIL_CHECK("opened with flipped bit ", i);
    file.data()[i / 8] ^= static_cast<std::uint8_t>(1 << i % 8);
  }
}

// Goal: a malicious file is refused or fully valid. Method: every bit flipped and every byte set to 0xFF, with a
// correct checksum; files that open pass validate_scene() and can be posed. The share refused shows that the checks
// work.
TEST_CASE("baked_open_rejects_or_validates_every_change_with_a_right_checksum") {
  BakedFile file = small_file();
  std::size_t rejected = 0, tried = 0;
  auto try_byte = [&](std::size_t at, std::uint8_t value) {
    std::uint8_t kept = file.data()[at];
    file.data()[at] = value;
    fix_checksum(file);
    Scene scene;
    bool opened = baked_open(file.data(), file.size(), &scene).ok;
    if (opened) {
      if (!validate_scene(scene).ok) FAIL_CHECK("opened an invalid scene, byte ", at);
      use(scene);
    }
    rejected += !opened, ++tried;
    file.data()[at] = kept;
  };
  for (std::size_t at = 0; at < file.size(); ++at) {
    if (at >= kChecksumAt && at < kByteCountAt) continue;  // fix_checksum() would undo it
    for (int b = 0; b < 8; ++b) try_byte(at, static_cast<std::uint8_t>(file.data()[at] ^ 1 << b));
    try_byte(at, 0xFF);
  }
  MESSAGE(rejected, " of ", tried, " changes with a right checksum refused, ", file.size(), " bytes");
  CHECK(rejected > tried / 5);
}

// Goal: the table of sections is checked word by word. Method: each field of each section set to harmful values.
TEST_CASE("baked_open_rejects_crafted_section_tables") {
  BakedFile file = small_file();
  BakedFile original = small_file();
  for (std::uint32_t kind = 0; kind < 32; ++kind) {
    auto refused = [&](const char* what) {
      fix_checksum(file);
      if (open_error(file).empty()) FAIL_CHECK("opened: ", what, " in section ", kind);
      std::memcpy(file.data(), original.data(), file.size());
    };
    std::uint64_t offset;
    std::uint32_t count;
    std::memcpy(&offset, file.data() + section_at(kind) + 8, 8);
    std::memcpy(&count, file.data() + section_at(kind) + 16, 4);
    for (std::uint64_t bad :
         {std::uint64_t(0), offset - 64, offset + 4, offset + 64, ~std::uint64_t(0), ~std::uint64_t(63),
          std::uint64_t(file.size()), std::uint64_t(1) << 32 | offset, std::uint64_t(1) << 63})
      put_u64(file, section_at(kind) + 8, bad), refused("offset");
    for (std::uint32_t bad : {count + 64, 0x10000000u, 0x20000000u, 0x40000000u, 0x80000000u, 0xFFFFFFFFu})
      put_u32(file, section_at(kind) + 16, bad), refused("count");
    for (std::uint32_t bad : {0u, 3u, 1024u, 0xFFFFFFFFu})
      put_u32(file, section_at(kind) + 4, bad), refused("element size");
    for (std::uint32_t bad : {kind + 1, kind - 1, 32u, 0xFFFFFFFFu})
      put_u32(file, section_at(kind), bad), refused("kind");
    put_u32(file, section_at(kind) + 20, 1), refused("reserved word");
  }
}

TEST_CASE("baked_open_rejects_reserved_words_in_use") {
  BakedFile file = small_file();
  for (std::size_t at = kSectionCountAt + 4; at < kTableAt; at += 4) {
    put_u32(file, at, 1);
    fix_checksum(file);
    CHECK(mentions(open_error(file), "reserved"));
    put_u32(file, at, 0);
  }
}

// Goal: overlapping and duplicate sections are refused. Method: a copy of a neighbour's row of the table.
TEST_CASE("baked_open_rejects_overlapping_and_duplicate_sections") {
  BakedFile file = small_file();
  BakedFile original = small_file();
  for (std::uint32_t kind = 1; kind < 32; ++kind) {
    std::memcpy(file.data() + section_at(kind), file.data() + section_at(kind - 1), kSectionBytes);
    fix_checksum(file);
    CHECK(!open_error(file).empty());
    put_u32(file, section_at(kind), kind);  // the right kind, but over its neighbour
    fix_checksum(file);
    CHECK(!open_error(file).empty());
    std::memcpy(file.data(), original.data(), file.size());
  }
}

// Goal: messages say what is wrong and how to mend it.
TEST_CASE("baked_open_says_what_is_wrong") {
  BakedFile file = small_file();
  Scene scene;
  CHECK(mentions(baked_open(file.data(), 0, &scene).message, "not a .pray file"));
  CHECK(mentions(baked_open(file.data(), 40, &scene).message, "cut short after 40 bytes"));
  CHECK(mentions(baked_open(file.data(), file.size() - 64, &scene).message, "it should be"));
  CHECK(mentions(baked_open(file.data() + 1, file.size() - 1, &scene).message, "aligned to 64"));
  put_u32(file, kVersionAt, 1);
  CHECK(open_error(file) == "made by version 1, but this program reads versions 7 to 21: bake it again");
  put_u32(file, kVersionAt, kBakedVersion);
  file.data()[file.size() - 1] ^= 1;
  CHECK(mentions(open_error(file), "checksum"));
  fix_checksum(file);
  CHECK(open_error(file) == "");
  put_u32(file, kSectionCountAt, 54);
  fix_checksum(file);
  CHECK(mentions(open_error(file), "54 sections"));
  put_u32(file, kSectionCountAt, 53);
  put_u32(file, section_at(0) + 16, 2);
  fix_checksum(file);
  CHECK(mentions(open_error(file), "2 info sections"));
  put_u32(file, section_at(0) + 16, 1);
  put_u32(file, section_at(1) + 16, kNone);
  fix_checksum(file);
  CHECK(mentions(open_error(file), "positions reaches beyond the end"));
  file.data()[1] = 'p';
  CHECK(mentions(open_error(file), "not a .pray file"));
}

// Goal: a refused file leaves the caller's scene alone.
TEST_CASE("baked_open_leaves_the_scene_alone_on_error") {
  BakedFile file = small_file();
  std::memset(file.data() + kTableAt + 32 * kSectionBytes, 0xFF, 512);
  fix_checksum(file);
  Scene scene;
  scene.info.frame_count = 77;
  CHECK(!baked_open(file.data(), file.size(), &scene).ok);
  CHECK(scene.info.frame_count == 77);
  CHECK(scene.positions.empty());
}
