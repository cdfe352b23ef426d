#include "shade/source_selection.h"

#include <cstring>

#include "base/check.h"
#include "base/float_bits.h"
#include "base/limits.h"
#include "brdf/brdf_list.h"
#include "shade/instances.h"
#include "shade/lights.h"
#include "shade/lit_surface.h"
#include "shade/tile_receivers.h"

namespace pocketray {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

constexpr std::uint16_t kEnd = 0xFFFF;

// Pixels that select a light before rays to it are traced together, and the fewest such rays. Chosen: of 2, 4 and 8.
constexpr std::uint32_t kTogetherMin = 4;

// Index of an entry's list: greater bounds, including infinite ones, go to later lists.
std::uint32_t strength_of(float most) { return float_bits(most) >> 22; }

}  // namespace

SourceSearch::SourceSearch(Tracer* tracer, const Surface& surface, const Material& m, const Vec3& to_viewer)
    : frame_(*tracer->frame),
      light_points_(tracer->light_points),
      surface_(surface),
      material_(m),
      lobe_(lobe_at(*tracer->frame, surface, m)),
      to_viewer_(to_viewer),
      diffuse_(surface.diffuse * (1 / kPiF)),
      specular_({0, 0, 0}),
      shines_(has(tracer->frame->mask, Effect::specular) && !is_zero(m.specular)),
      diffuse_most_(max_component(diffuse_)),
      specular_most_(0),
      entries_(tracer->light_entries) {
  CHECK_LE(search_entry_count(frame_.lights.points.count), entries_.count);
  if (shines_) {
    effect_entered<Effect::specular>();
    specular_ = reflectance_at(surface, m.specular, m.specular_tinted);
    diffuse_most_ *= lobe_.diffuse_max;
    specular_most_ = max_component(lobe_.peak(m));
  }
  if (frame_.mask & kLayerEffects & kEffectsBuilt) {
    diffuse_ = diffuse_value<kLayerEffects>(surface), diffuse_most_ = max_component(diffuse_);
    if (shines_) diffuse_most_ *= lobe_.diffuse_max;
    if (!is_zero(surface.sheen.color))
      specular_most_ += max_component(surface.sheen.color) * sheen_peak(surface.sheen.roughness);
  }
  if (shines_by_coat(frame_, surface)) {
    const Material coat = coat_lobe(surface.coat.roughness);
    specular_most_ += surface.coat.lobe * kBrdfList[coat.brdf]->peak(coat).x;
  }
  for (std::uint16_t run = 0; run < frame_.lights.run_count; ++run) {
    const std::uint32_t root = frame_.lights.tree.roots[run];
    if (root != kNone) {
      add_node(root, run);
      continue;
    }
    for (std::uint32_t i = frame_.lights.runs[run].begin; i < frame_.lights.runs[run].end; ++i) add_light(i, run);
  }
}

bool SourceSearch::radiance(const LightPoint& light, std::uint32_t run, Vec3* radiance) const {
  LightSample sample;
  if (!lights_up(frame_, surface_, frame_.lights.runs[run], light, &sample)) return false;
  if (!has(frame_.mask, Effect::shadow) && is_below(surface_, sample.direction)) return false;
  const float cosine = dot(surface_.normal, sample.direction);
  const bool is_coated = (frame_.mask & kLayerEffects & kEffectsBuilt) != 0;
  Vec3 f = diffuse_;
  if (shines_)
    f = is_coated ? value_under_coat(lobe_, material_, specular_, diffuse_, surface_, to_viewer_, sample.direction)
                  : lobe_.value(material_, specular_, diffuse_, surface_, to_viewer_, sample.direction);
  *radiance = f * sample.irradiance * cosine;
  if (is_coated) *radiance += sample.irradiance * layer_reflection(surface_, to_viewer_, sample.direction);
  return true;
}

void SourceSearch::add(const LightEntry& entry) {
  CHECK_LT(entry_count_, entries_.count);
  const std::uint32_t strength = strength_of(entry.most), word = strength / 32, mark = 1u << strength % 32;
  const std::uint16_t index = static_cast<std::uint16_t>(entry_count_++);
  entries_[index] = entry;
  entries_[index].next = marks_[word] & mark ? first_[strength] : kEnd;
  first_[strength] = index;
  marks_[word] |= mark, strengths_ |= 1u << word;
  if (entry.most < kInfinity)
    remaining_ += static_cast<double>(entry.most);
  else
    ++unbounded_;
  if (remaining_ > remaining_max_) remaining_max_ = remaining_;
}

// Visits lists from the strongest to the weakest.
template <class Visit>
void SourceSearch::each_entry(Visit visit) const {
  for (std::uint32_t word = kListCount / 32; word-- > 0;)
    for (std::uint32_t marks = marks_[word], place; marks; marks &= ~(1u << place)) {
      place = 31u - static_cast<std::uint32_t>(__builtin_clz(marks));
      for (std::uint32_t i = first_[32 * word + place]; i != kEnd; i = entries_[i].next) visit(entries_[i]);
    }
}

void SourceSearch::sum_up() {
  double sum = 0;
  each_entry([&](const LightEntry& entry) { sum += static_cast<double>(entry.most); });
  remaining_ = remaining_max_ = sum;
}

void SourceSearch::add_light(std::uint32_t light, std::uint16_t run) {
  LightEntry entry;
  if (!radiance(light_points_[light], run, &entry.radiance)) return;
  entry.most = max_component(entry.radiance);
  if (!(entry.most > 0)) return;
  entry.light = light, entry.node = kNone, entry.run = run;
  add(entry);
}

// Its bound puts all lights of the group at the point of its box nearest to the surface, at their steepest angle.
void SourceSearch::add_node(std::uint32_t index, std::uint16_t run) {
  const LightNode& node = frame_.lights.tree.nodes[index];
  const Vec3 low = node.box.low - surface_.point, high = node.box.high - surface_.point, &n = surface_.normal;
  const Vec3 near = max(max(low, -high), Vec3{0, 0, 0}), above = max(n * low, n * high);
  constexpr float kRounding = 1e-5f;  // chosen: several times the rounding error below
  const float height = above.x + above.y + above.z + kRounding * dot(abs(n), max(abs(low), abs(high)));
  if (!(height > 0)) return;
  const float square = dot(near, near);
  LightEntry entry;
  entry.most = kInfinity;
  if (square > 0) {
    const float distance = std::sqrt(square), cosine = height < distance ? height / distance : 1;
    entry.most = (node.intensity / square) * (diffuse_most_ * cosine + specular_most_) * (1 + kRounding);
    if (!(entry.most < kInfinity)) entry.most = kInfinity;
    if (!(entry.most > 0)) return;  // nothing reflects, or nothing shines
  }
  entry.light = kNone, entry.node = index, entry.run = run;
  add(entry);
}

bool SourceSearch::take(LightEntry* light) {
  CHECK(strengths_ != 0);
  const std::uint32_t word = 31u - static_cast<std::uint32_t>(__builtin_clz(strengths_)),
                      place = 31u - static_cast<std::uint32_t>(__builtin_clz(marks_[word])),
                      strength = 32 * word + place;
  const LightEntry& entry = entries_[first_[strength]];
  first_[strength] = entry.next;
  if (entry.next == kEnd && !(marks_[word] &= ~(1u << place))) strengths_ &= ~(1u << word);
  if (entry.most < kInfinity)
    remaining_ -= static_cast<double>(entry.most);
  else
    --unbounded_;
  if (entry.node == kNone) {
    *light = entry;
    return true;
  }
  const std::uint32_t index = entry.node;
  const std::uint16_t run = entry.run;
  const LightNode& node = frame_.lights.tree.nodes[index];
  if (node.right == kNone) {
    for (std::uint32_t i = node.begin; i < node.end; ++i) add_light(frame_.lights.tree.order[i], run);
  } else {
    add_node(index + 1, run);
    add_node(node.right, run);
  }
  return false;
}

Vec3 SourceSearch::estimate() const {
  Vec3 sum = {0, 0, 0};
  each_entry([&](const LightEntry& entry) {
    Vec3 unblocked = entry.radiance;
    if (entry.node != kNone) {
      if (!radiance(frame_.lights.tree.nodes[entry.node].mean, entry.run, &unblocked)) return;
      unblocked = min(unblocked, Vec3{entry.most, entry.most, entry.most});
    }
    sum += unblocked;
  });
  return sum;
}

void count_selected(Tracer* tracer, const LightRun& run, std::uint32_t light) {
  TileShadows* tile = tracer->tile_shadows;
  CHECK(tile != nullptr);
  CHECK_LT(light, kTileLightMax);
  const std::uint32_t shaded = tracer->tile_pixel + 1, count = ++tile->selected[light];
  if (count < kTogetherMin || 2 * count < shaded) return;
  TileReceivers* left = &tile->receivers;
  std::uint32_t done = 0;
  while (done < left->count && left->pixel[done] < tracer->tile_pixel) ++done;
  left->count -= done;
  std::memmove(left->pixel, left->pixel + done, left->count);
  if (left->count < kTogetherMin || (emitter_of(tracer->light_points[light]) && is_grouped(*tracer))) return;
  tile->selected[light] = kTileTraced;
  trace_light(tracer, run, light, *left, nullptr, tile);
}

void find_tile_surfaces(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows) {
  shadows->receivers.count = 0;
  find_receivers(*tracer->frame, rays, hits, shadows, &shadows->receivers);
  std::memset(shadows->traced, 0, sizeof shadows->traced);
  std::memset(shadows->selected, 0, sizeof shadows->selected);
}

}  // namespace pocketray
