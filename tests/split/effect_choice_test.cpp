// The choice between sharing frames by rows and by effect.
#include "split/effect_choice.h"

#include <doctest/doctest.h>

using namespace pocketray;

namespace {

EffectTimes times_of(double prepare, double device, double server, double transfer, double add) {
  return {prepare * 1e6, device * 1e6, server * 1e6, transfer * 1e6, add * 1e6};
}

// Frames of a world in which either way takes its time; returns how many were by effect.
int effect_frames(EffectChoice* choice, int frames, double rows_ms, const EffectTimes& times) {
  int count = 0;
  for (int i = 0; i < frames; ++i) {
    const bool by_effect = choose_by_effect(choice);
    by_effect ? observe_effect_frame(choice, times) : observe_rows_frame(choice, rows_ms * 1e6);
    count += by_effect;
  }
  return count;
}

}  // namespace

// Goal: the server's work and the link overlap with the device's tracing; preparing and adding do not.
TEST_CASE("effect_time_is_the_longer_of_device_and_server") {
  EffectChoice choice;
  CHECK(predict_effect_ns(choice) == 0);
  observe_effect_frame(&choice, times_of(1, 50, 10, 20, 5));
  CHECK(predict_effect_ns(choice) == doctest::Approx(56e6));
  choice = EffectChoice();
  observe_effect_frame(&choice, times_of(1, 50, 40, 30, 5));
  CHECK(predict_effect_ns(choice) == doctest::Approx(76e6));
}

// Goal: both ways are tried, the faster one is kept, and the other is tried again, rarely, so that a change is noticed.
TEST_CASE("effect_choice_takes_the_faster") {
  const EffectTimes times = times_of(1, 50, 10, 20, 5);
  EffectChoice rows_faster, effect_faster;
  CHECK(effect_frames(&rows_faster, 100, 40, times) == int(kTrialFrames));
  CHECK(!rows_faster.by_effect);
  CHECK(effect_frames(&effect_faster, 100, 90, times) == 100 - int(kTrialFrames));
  CHECK(effect_faster.by_effect);
  // Rows become faster: the next trial shows it.
  effect_frames(&effect_faster, int(kRetryFrames) + int(kTrialFrames), 20, times);
  CHECK(!effect_faster.by_effect);
  // Trials of the slower way are rare.
  CHECK(effect_frames(&rows_faster, 20 * int(kRetryFrames), 40, times) <= 20 * int(kTrialFrames));
}

// Goal: ways that take about as long do not alternate.
TEST_CASE("effect_choice_is_steady_where_both_take_as_long") {
  EffectChoice choice;
  int changes = 0;
  bool before = false;
  for (int i = 0; i < int(kRetryFrames); ++i) {
    const bool by_effect = choose_by_effect(&choice);
    const double noise = i % 2 ? 1.02 : 0.98;
    by_effect ? observe_effect_frame(&choice, times_of(0, 50 * noise, 0, 0, 0))
              : observe_rows_frame(&choice, 50e6 * noise);
    changes += by_effect != before;
    before = by_effect;
  }
  CHECK(changes <= 2);
}
