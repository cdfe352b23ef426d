#include "scene/channel.h"

#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "base/limits.h"

namespace pocketray {
namespace {

// A time among the keys: between `key` and the next one, or exactly on `key` when fraction is 0.
struct KeyPosition {
  std::uint32_t key;
  double fraction;  // 0 ≤ fraction < 1
  double step;      // seconds from this key to the next
};

KeyPosition find_key(const Scene& scene, const Channel& channel, double time) {
  CHECK_GT(channel.key_count, 0u);
  CHECK_LE(std::uint64_t(channel.key_begin) + channel.key_count, scene.key_times.count);
  const float* times = scene.key_times.data + channel.key_begin;
  std::uint32_t last = channel.key_count - 1;
  if (time <= times[0]) return {0, 0, 0};
  if (time >= times[last]) return {last, 0, 0};
  std::uint32_t low = 0, high = last;  // times[low] ≤ time < times[high]
  while (high - low > 1) {
    std::uint32_t middle = low + (high - low) / 2;
    (time < times[middle] ? high : low) = middle;
  }
  double step = static_cast<double>(times[high]) - times[low];
  return {low, (time - times[low]) / step, step};
}

// Cubic Hermite spline [glTF 2.0, appendix C.5]. Elements of a key: in-tangent, value, out-tangent.
struct Hermite {
  double value0, tangent0, value1, tangent1;
};
Hermite hermite(const KeyPosition& at) {
  double t = at.fraction, t2 = t * t, t3 = t2 * t;
  return {2 * t3 - 3 * t2 + 1, at.step * (t3 - 2 * t2 + t), -2 * t3 + 3 * t2, at.step * (t3 - t2)};
}

// Narrows to float, clamped to ±kCoordinateMax: a spline may overshoot.
float narrowed(double x) {
  if (x > kCoordinateMax) return kCoordinateMax;
  if (x < -kCoordinateMax) return -kCoordinateMax;
  return static_cast<float>(x);
}

// One component of the value between two keys; `key` points to the first element of the key, of `width` floats each.
double cubic(const Hermite& h, const float* key, std::uint32_t width, std::uint32_t component) {
  const float* next = key + 3 * width;
  return h.value0 * key[width + component] + h.tangent0 * key[2 * width + component] +
         h.value1 * next[width + component] + h.tangent1 * next[component];
}

Quaternion unit_quaternion(const double* q) {
  double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(size > 0) || !std::isfinite(size)) return Quaternion();
  return {static_cast<float>(q[0] / size), static_cast<float>(q[1] / size), static_cast<float>(q[2] / size),
          static_cast<float>(q[3] / size)};
}

// Spherical linear interpolation along the shorter arc [glTF 2.0, appendix C.4].
void slerp(const float* a, const float* b, double t, double* result) {
  double d = 0;
  for (int i = 0; i < 4; ++i) d += static_cast<double>(a[i]) * b[i];
  double weight_a = 1 - t, weight_b = t;
  // Below an angle of 0.0014 the chord and the arc differ by less than 1e-9 once normalised.
  if (std::fabs(d) < 0.999999) {
    double angle = det_acos(std::fabs(d));
    double sine = det_sin(angle);
    weight_a = det_sin(angle * (1 - t)) / sine;
    weight_b = det_sin(angle * t) / sine;
  }
  if (d < 0) weight_b = -weight_b;
  for (int i = 0; i < 4; ++i) result[i] = weight_a * a[i] + weight_b * b[i];
}

}  // namespace

std::uint32_t channel_width(const Scene& scene, const Channel& channel) {
  if (channel.path != ChannelPath::weights) return channel_width(channel.path, 0);
  CHECK_LT(channel.node, scene.nodes.count);
  return channel_width(channel.path, scene.nodes[channel.node].weight_count);
}

std::uint32_t channel_width(ChannelPath path, std::uint32_t weight_count) {
  CHECK(weight_count == 0 || path == ChannelPath::weights);
  switch (path) {
    case ChannelPath::rotation:
      return 4;
    case ChannelPath::weights:
      return weight_count;
    case ChannelPath::visibility:
    case ChannelPath::light_scale:
    case ChannelPath::camera_size:
      return 1;
    default:
      return 3;
  }
}

void channel_value(const Scene& scene, const Channel& channel, double time, std::uint32_t width, float* value) {
  CHECK_GT(width, 0u);
  KeyPosition at = find_key(scene, channel, time);
  bool is_cubic = channel.interpolation == Interpolation::cubic;
  std::uint32_t stride = is_cubic ? 3 * width : width;
  CHECK_LE(channel.value_begin + std::uint64_t(channel.key_count) * stride, scene.key_values.count);
  const float* key = scene.key_values.data + channel.value_begin + std::size_t(at.key) * stride;
  if (at.fraction == 0 || channel.interpolation == Interpolation::step) {
    if (is_cubic) key += width;
    for (std::uint32_t i = 0; i < width; ++i) value[i] = key[i];
  } else if (is_cubic) {
    Hermite h = hermite(at);
    for (std::uint32_t i = 0; i < width; ++i) value[i] = narrowed(cubic(h, key, width, i));
  } else {
    for (std::uint32_t i = 0; i < width; ++i)
      value[i] = narrowed((1 - at.fraction) * key[i] + at.fraction * key[width + i]);
  }
}

Quaternion channel_rotation(const Scene& scene, const Channel& channel, double time) {
  CHECK(channel.path == ChannelPath::rotation);
  double q[4];
  KeyPosition at = find_key(scene, channel, time);
  if (channel.interpolation == Interpolation::linear && at.fraction > 0) {
    const float* key = scene.key_values.data + channel.value_begin + std::size_t(at.key) * 4;
    slerp(key, key + 4, at.fraction, q);
  } else {
    float value[4];
    channel_value(scene, channel, time, 4, value);
    for (int i = 0; i < 4; ++i) q[i] = value[i];
  }
  return unit_quaternion(q);
}

}  // namespace pocketray
