#include "plan/place_light_tree.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "base/fmath.h"
#include "shade/frame_data.h"
#include "shade/lights.h"

namespace pocketray {
namespace {

// Chosen: with groups of four, nearly all are divided, and bounding them is wasted.
constexpr std::uint32_t kGroupMax = 16;

struct TreeBuilder {
  Array<const LightPoint> lights, sample_lights;  // as in Lights
  Array<LightNode> nodes;
  Array<std::uint32_t> order;
  std::uint32_t node_count = 0;

  // Calls visit(point) for a light's points of all samples.
  template <class Visit>
  void each_point(std::uint32_t light, Visit visit) const {
    visit(lights[light]);
    for (std::uint32_t i = light; i < sample_lights.count; i += lights.count) visit(sample_lights[i]);
  }
};

// Merges two lights: their total power, at the centre of their power.
LightPoint joined(const LightPoint& a, float a_intensity, const LightPoint& b, float b_intensity) {
  constexpr float most = std::numeric_limits<float>::max();
  const float sum = a_intensity + b_intensity, share = sum > 0 ? b_intensity / sum : 0.5f;
  LightPoint p = a;
  p.position = a.position + (b.position - a.position) * share;
  const Vec3 direction = a.direction + (b.direction - a.direction) * share;
  if (dot(direction, direction) > 0) p.direction = normalize(direction);
  p.intensity = min(a.intensity + b.intensity, Vec3{most, most, most});
  p.range = a.range > 0 && b.range > 0 ? std::max(a.range, b.range) : 0;
  p.cos_inner = std::min(a.cos_inner, b.cos_inner), p.cos_outer = std::min(a.cos_outer, b.cos_outer);
  if (a.material != b.material) p.material = kNone;
  p.two_sided = a.two_sided || b.two_sided;
  return p;
}

void measure_group(TreeBuilder* b, LightNode* node) {
  node->right = kNone;
  for (std::uint32_t i = node->begin; i < node->end; ++i) {
    const LightPoint& light = b->lights[b->order[i]];
    float intensity = 0;
    b->each_point(b->order[i],
                  [&](const LightPoint& p) { intensity = std::max(intensity, max_component(p.intensity)); });
    node->mean = i == node->begin ? light : joined(node->mean, node->intensity, light, intensity);
    node->intensity = i == node->begin ? intensity : node->intensity + intensity;
  }
}

std::uint32_t build(TreeBuilder* b, std::uint32_t begin, std::uint32_t end) {
  CHECK_LT(begin, end);
  CHECK_LT(b->node_count, b->nodes.count);
  const std::uint32_t index = b->node_count++;
  LightNode* node = &b->nodes[index];
  node->begin = begin, node->end = end;
  node->box = empty_box();
  for (std::uint32_t i = begin; i < end; ++i)
    b->each_point(b->order[i], [&](const LightPoint& p) { node->box = merge(node->box, p.position); });
  if (end - begin <= kGroupMax) {
    measure_group(b, node);
    return index;
  }
  const Vec3 size = extent(node->box);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::sort(&b->order[begin], &b->order[begin] + (end - begin), [&](std::uint32_t l, std::uint32_t r) {
    const float at_l = b->lights[l].position[axis], at_r = b->lights[r].position[axis];
    return at_l != at_r ? at_l < at_r : l < r;
  });
  const std::uint32_t middle = begin + (end - begin) / 2;
  const std::uint32_t left = build(b, begin, middle);
  CHECK_EQ(left, index + 1);
  node->right = build(b, middle, end);
  const LightNode &l = b->nodes[left], &r = b->nodes[node->right];
  node->intensity = l.intensity + r.intensity;
  node->mean = joined(l.mean, l.intensity, r.mean, r.intensity);
  return index;
}

}  // namespace

void place_light_tree(Array<LightNode> nodes, Array<std::uint32_t> order, FrameData* frame) {
  CHECK(frame != nullptr);
  CHECK(frame->lights.points.count <= nodes.count && frame->lights.points.count <= order.count);
  TreeBuilder b = {frame->lights.points, frame->lights.sample_points, nodes, order};
  for (std::uint32_t i = 0; i < frame->lights.points.count; ++i) order[i] = i;
  for (int r = 0; r < frame->lights.run_count; ++r) {
    const LightRun& run = frame->lights.runs[r];
    const bool everywhere = run.sample == find_light_sampler(Effect::directional_light);
    frame->lights.tree.roots[r] = everywhere ? kNone : build(&b, run.begin, run.end);
  }
  frame->lights.tree.nodes = {nodes.data, b.node_count};
  frame->lights.tree.order = {order.data, frame->lights.points.count};
}

}  // namespace pocketray
