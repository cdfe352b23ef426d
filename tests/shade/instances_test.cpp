#include "shade/instances.h"

#include <doctest/doctest.h>

#include <set>

using namespace pocketray;

namespace {

// Calls f for every plan that has only effects of the table.
template <class Table, class F>
void each_plan(const Table& table, F f) {
  EffectMask plan = 0;
  do {
    f(plan);
    plan = (plan - table.effects) & table.effects;
  } while (plan);
}

template <class Table>
std::size_t instance_count(const Table& table) {
  std::set<EffectMask> instances;
  each_plan(table, [&](EffectMask plan) { instances.insert(table.instance_of(plan)); });
  return instances.size();
}

}  // namespace

TEST_CASE("an instance of radiance has the code of its plan") {
  each_plan(kRadianceTable, [](EffectMask plan) {
    EffectMask lacking = plan & ~kRadianceTable.instance_of(plan);
    // These have no effect by themselves, and metallic roughness includes a grain.
    if (!has(plan, Effect::refraction)) lacking &= ~bit(Effect::absorption);
    if (!(plan & kGoesOn)) lacking &= ~bit(Effect::mip_map);
    if (has(kRadianceTable.instance_of(plan), Effect::metallic_roughness)) lacking &= ~bit(Effect::anisotropy);
    REQUIRE(lacking == 0);
  });
}

TEST_CASE("scenes without lobes, contacts and maps get instances without their code") {
  CHECK(kRadianceTable.instance_of(0) == 0);
  CHECK(kRadianceTable.instance_of(kAllEffects & ~kRadianceTable.effects) == 0);
  CHECK(kRadianceTable.instance_of(bit(Effect::shadow)) == bit(Effect::shadow));
  CHECK(kRadianceTable.instance_of(kLobeEffects) == kLobeEffects);
  CHECK((kRadianceTable.instance_of(bit(Effect::alpha_blend)) & bit(Effect::refraction)) == 0);
}

TEST_CASE("an instance of a surface, its glow or its maps has the code of its plan") {
  each_plan(kSurfaceTable, [](EffectMask plan) {
    // With two sets of texture coordinates, the glow is a function of its own.
    const EffectMask by_glow = has(plan, Effect::second_uv) ? bit(Effect::emission) | kStoredLight : 0;
    REQUIRE((plan & ~by_glow & ~kSurfaceTable.instance_of(plan)) == 0);
  });
  each_plan(kGlowTable, [](EffectMask plan) {
    const EffectMask instance = kGlowTable.instance_of(plan);
    const EffectMask by_kernels = has(instance, Effect::second_uv) ? bit(Effect::mip_map) : 0;
    const bool has_texture = (plan & kTexturedGlow) == kTexturedGlow;
    REQUIRE((plan & ~by_kernels & ~(has_texture ? 0 : bit(Effect::second_uv)) & ~instance) == 0);
  });
  each_plan(kMapsTable, [](EffectMask plan) {
    const EffectMask instance = kMapsTable.instance_of(plan);
    const EffectMask by_kernels = has(instance, Effect::second_uv) ? bit(Effect::mip_map) : 0;
    REQUIRE((plan & ~by_kernels & ~instance) == 0);
  });
}

// Each takes a quarter of a second to compile.
TEST_CASE("radiance has few instances") {
  CHECK(instance_count(kRadianceTable) == 90);
  CHECK(instance_count(kSurfaceTable) == 136);
  CHECK(instance_count(kGlowTable) == 36);
  CHECK(instance_count(kMapsTable) == 19);
}
