#include "split/smooth.h"

namespace pocketray {
namespace {

// Tuned with tests/split/simulation_test.cpp: frames to settle versus jitter of the split.
constexpr double kWeight = 0.25;      // of a new sample in the exponential mean
constexpr double kNoise = 0.125;      // samples this close to the value indicate no change
constexpr double kOutlierFactor = 2;  // samples farther off wait for confirmation
constexpr int kRunMax = 3;            // this many in a row on one side are a change; their mean becomes the value
constexpr double kSampleMin = 1e-30, kSampleMax = 1e30;  // floats hold them and the products of their ratios

double clamp(double x) { return x < kSampleMin ? kSampleMin : x > kSampleMax ? kSampleMax : x; }

}  // namespace

void smooth(Smoothed* s, double sample) {
  if (!(sample >= kSampleMin && sample <= kSampleMax)) return;
  if (!is_known(*s)) {
    *s = {static_cast<float>(sample), 0, 0};
    return;
  }
  double value = static_cast<double>(s->value);
  bool above = sample > value;
  if (sample >= value * (1 - kNoise) && sample <= value * (1 + kNoise)) {
    s->run = 0;
  } else {
    bool goes_on = above ? s->run > 0 : s->run < 0;
    int count = goes_on ? (above ? s->run : -s->run) + 1 : 1;
    double mean = goes_on ? static_cast<double>(s->run_mean) : 0;
    mean += (sample - mean) / count;
    s->run_mean = static_cast<float>(mean);
    s->run = static_cast<std::int8_t>(above ? count : -count);
    if (count == kRunMax) {
      *s = {static_cast<float>(clamp(mean)), 0, 0};
      return;
    }
    if (sample > value * kOutlierFactor || sample * kOutlierFactor < value) return;
  }
  s->value = static_cast<float>(clamp(value + kWeight * (sample - value)));
}

void scale(Smoothed* s, double factor) {
  if (!is_known(*s) || !(factor >= kSampleMin && factor <= kSampleMax)) return;
  s->value = static_cast<float>(clamp(static_cast<double>(s->value) * factor));
  s->run_mean = static_cast<float>(clamp(static_cast<double>(s->run_mean) * factor));
}

}  // namespace pocketray
