// Methods of indirect light: properties of every one in the list, present and future.
#include <doctest/doctest.h>

#include <set>
#include <string>
#include <vector>

#include "base/rng.h"
#include "indirect/indirect_list.h"

using namespace pocketray;

namespace {

Vec3 random_color(Rng* rng) { return {next_float(rng), next_float(rng), next_float(rng)}; }

}  // namespace

// Goal: a method keeps its promises. Method: random ambient terms, albedos and normals; the radiance does not exceed
// the bound, equals the double-precision value up to rounding, and is zero without the effect; prepare() takes as much
// as need() says.
TEST_CASE("indirect_methods_keep_their_promises") {
  std::set<std::string> names;
  EffectMask effects = 0;
  for (const IndirectInfo& info : IndirectList::kInfos) {
    CAPTURE(info.name);
    CHECK(names.insert(info.name).second);
    CHECK((effects & info.effects) == 0);  // one bit each, not shared
    CHECK((info.effects & (info.effects - 1)) == 0);
    if (info.effects == 0) CHECK(info.reference == IndirectReference::nothing);
    effects |= info.effects;
    Rng rng = make_rng(31);
    for (int i = 0; i < 1000; ++i) {
      Scene scene;
      scene.info.ambient = random_color(&rng) * 3.0f;
      Material material;
      material.diffuse = random_color(&rng);
      std::vector<unsigned char> block(info.need(scene, Quality()).keep + 2 * kArenaAlignment);
      Arena arena = make_arena("indirect", block.data(), block.size());
      const std::size_t before = arena.used;
      const void* prepared = info.prepare(scene, Quality(), &arena, nullptr);
      CHECK(arena.used - before <= info.need(scene, Quality()).keep);
      Vec3 point = random_color(&rng), normal = normalize(random_color(&rng));
      Vec3 radiance = info.radiance({scene, prepared, point, normal, material.diffuse});
      Vec3d exact = info.exact(scene, to_double(material.diffuse));
      for (int axis = 0; axis < 3; ++axis) {
        CHECK(radiance[axis] >= 0);
        CHECK(radiance[axis] <= info.bound(scene, material));
        CHECK(static_cast<double>(radiance[axis]) == doctest::Approx(exact[axis]).epsilon(1e-6));
        if (!info.effects) CHECK(radiance[axis] == 0);
      }
    }
  }
  CHECK(effects == IndirectList::kEffects);
  CHECK(names.count("none") == 1);
}

// Goal: a plan has the methods of its effects and no others. Method: a white surface in ambient light, with the effect
// and without; the reference's lighting model includes it, full light transport does not.
TEST_CASE("indirect_light_follows_the_plan") {
  Scene scene;
  scene.info.ambient = {0.25f, 0.5f, 1};
  const Vec3 point = {0, 0, 0}, normal = {0, 1, 0}, white = {1, 1, 1};
  std::vector<std::uint8_t> memory(indirect_need(scene, Quality(), kAllEffects).keep + kArenaAlignment);
  Arena keep = make_arena("indirect light", memory.data(), memory.size());
  IndirectData data = prepare_indirect(scene, Quality(), kAllEffects, &keep, nullptr);
  CHECK(keep.used <= indirect_need(scene, Quality(), kAllEffects).keep);
  Vec3 with = {0, 0, 0}, without = {0, 0, 0};
  IndirectList::add_radiance<bit(Effect::ambient)>(data.prepared, {scene, nullptr, point, normal, white}, &with);
  IndirectList::add_radiance<bit(Effect::texture)>(data.prepared, {scene, nullptr, point, normal, white}, &without);
  CHECK(with == scene.info.ambient);
  CHECK(is_zero(without));
  CHECK(indirect_need(scene, Quality(), 0).keep == 0);
  CHECK(exact_indirect(scene, {1, 1, 1}, true) == to_double(scene.info.ambient));
  CHECK(is_zero(exact_indirect(scene, {1, 1, 1}, false)));
  Material material;
  material.diffuse = {0.5f, 0.5f, 0.5f};
  CHECK(indirect_bound(scene, material, bit(Effect::ambient)) == 0.5f);
  CHECK(indirect_bound(scene, material, kAllEffects & ~kIndirectEffects) == 0);
}

namespace {

// A method for this test only, with its own data and an effect that no other method has.
struct StoredIndirect {
  static constexpr const char* kName = "stored";
  static constexpr EffectMask kEffects = bit(Effect::animation);
  static constexpr IndirectReference kReference = IndirectReference::always;
  static constexpr const char *kPresent = "stored", *kAbsent = "nothing stored";
  static IndirectUse use(const Scene&) { return IndirectUse::automatic; }
  static IndirectNeed need(const Scene&, const Quality&) { return {arena_need<Vec3>(1), 0}; }
  static const void* prepare(const Scene&, const Quality&, Arena* keep, Arena*) {
    Array<Vec3> stored = arena_array<Vec3>(keep, 1);
    stored[0] = {1, 2, 3};
    return stored.data;
  }
  static Vec3 radiance(const IndirectPoint& at) { return at.diffuse * *static_cast<const Vec3*>(at.prepared); }
  static Vec3d exact(const Scene&, const Vec3d& diffuse) { return diffuse * Vec3d{1, 2, 3}; }
  static float bound(const Scene&, const Material&) { return 3; }
};

}  // namespace

// Goal: one more method is a struct and a line. Method: a list of three; each plan has the light of its own methods,
// and the third reads the data that it prepared.
TEST_CASE("indirect_method_more_is_a_line_more") {
  using Longer = IndirectMethods<NoIndirect, AmbientIndirect, StoredIndirect>;
  Scene scene;
  scene.info.ambient = {0.5f, 0.5f, 0.5f};
  alignas(kArenaAlignment) unsigned char block[4 * kArenaAlignment];
  Arena arena = make_arena("indirect", block, sizeof block);
  const void* prepared[Longer::kCount] = {};
  for (int i = 0; i < Longer::kCount; ++i) prepared[i] = Longer::kInfos[i].prepare(scene, Quality(), &arena, nullptr);
  CHECK(Longer::kEffects == (bit(Effect::ambient) | bit(Effect::animation)));
  const Vec3 point = {0, 0, 0}, normal = {0, 1, 0}, white = {1, 1, 1};
  Vec3 both = {0, 0, 0}, ambient = both, stored = both;
  Longer::add_radiance<bit(Effect::ambient) | bit(Effect::animation)>(prepared, {scene, nullptr, point, normal, white},
                                                                      &both);
  Longer::add_radiance<bit(Effect::ambient)>(prepared, {scene, nullptr, point, normal, white}, &ambient);
  Longer::add_radiance<bit(Effect::animation)>(prepared, {scene, nullptr, point, normal, white}, &stored);
  CHECK(both == Vec3{1.5f, 2.5f, 3.5f});
  CHECK(ambient == scene.info.ambient);
  CHECK(stored == Vec3{1, 2, 3});
}
