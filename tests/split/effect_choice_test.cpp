// The choice between sharing frames by rows and by effect.
#include "split/effect_choice.h"

#include <doctest/doctest.h>

using namespace pocketray;

namespace {

EffectTimes times_of(double prepare, double device, double server, double transfer, double add) {
  return {prepare * 1e6, device * 1e6, server * 1e6, transfer * 1e6, add * 1e6};
}

// What a frame takes in either way, and is predicted to take.
struct World {
  double rows_ns = 0, effect_ns = 0, rows_predicted = 0, effect_predicted = 0;
};

// Frames of a world, of which that by effect is known once it has been tried; returns how many were by effect.
int effect_frames(EffectChoice* choice, int frames, const World& w) {
  int count = 0;
  for (int i = 0; i < frames; ++i) {
    const bool knows_effect = is_known(choice->effect_error);
    const double rows = w.rows_predicted * value_or(choice->rows_error, 1);
    const double effect = knows_effect ? w.effect_predicted * value_or(choice->effect_error, 1) : 0;
    const bool by_effect = choose_by_effect(choice, rows, effect);
    observe_choice(choice, by_effect, by_effect ? w.effect_predicted : w.rows_predicted,
                   by_effect ? w.effect_ns : w.rows_ns);
    count += by_effect;
  }
  return count;
}

}  // namespace

// Goal: the server's work and the link overlap with the device's tracing; preparing and adding do not.
TEST_CASE("effect_time_is_the_longer_of_device_and_server") {
  EffectModel model;
  CHECK(predict_effect_ns(model) == 0);
  observe_effect_times(&model, times_of(1, 50, 10, 20, 5));
  CHECK(predict_effect_ns(model) == doctest::Approx(56e6));
  model = EffectModel();
  observe_effect_times(&model, times_of(1, 50, 40, 30, 5));
  CHECK(predict_effect_ns(model) == doctest::Approx(76e6));
}

// Goal: both ways are tried, the faster one is kept, and the other is tried again, rarely, so that a change is noticed.
TEST_CASE("effect_choice_takes_the_faster") {
  EffectChoice rows_faster, effect_faster;
  const World rows_world = {40e6, 56e6, 40e6, 56e6}, effect_world = {90e6, 56e6, 90e6, 56e6};
  const int before_trials = int(kRetryFramesMin);
  CHECK(effect_frames(&rows_faster, before_trials + 5, rows_world) == int(kTrialFrames));
  CHECK(!rows_faster.by_effect);
  CHECK(effect_frames(&effect_faster, before_trials + 5, effect_world) == 5);
  CHECK(effect_frames(&effect_faster, 100, effect_world) > 75);
  // Rows become faster, as the model says at once.
  effect_faster = EffectChoice();
  effect_frames(&effect_faster, before_trials + 5, effect_world);
  CHECK(effect_frames(&effect_faster, 6, rows_world) == 0);
  // Trials in vain become rare.
  effect_frames(&rows_faster, 300, rows_world);
  CHECK(rows_faster.retry == kRetryFrames);
  CHECK(effect_frames(&rows_faster, 20 * int(kRetryFrames), rows_world) <= 20 * int(kTrialFrames));
}

// Goal: a way that takes longer than the model says is not taken for it, and one whose first frames were slow is tried
// again soon.
TEST_CASE("effect_choice_learns_how_far_the_model_is_off") {
  EffectChoice choice;
  const int first = int(kRetryFramesMin) + int(kTrialFrames);
  CHECK(effect_frames(&choice, first, {40e6, 56e6, 40e6, 30e6}) == int(kTrialFrames));
  CHECK(effect_frames(&choice, 2, {40e6, 56e6, 40e6, 30e6}) == 0);
  CHECK(choice.effect_error.value == doctest::Approx(56.0 / 30));
  choice = EffectChoice();
  effect_frames(&choice, int(kRetryFramesMin), {60e6, 41e6, 40e6, 41e6});
  CHECK(effect_frames(&choice, 5, {40e6, 41e6, 40e6, 41e6}) == 5);  // rows seem to take 60 ms
  effect_frames(&choice, 3 * int(kRetryFramesMin), {40e6, 41e6, 40e6, 41e6});
  CHECK(!choice.by_effect);
  // What the model does not know teaches nothing.
  const Smoothed before = choice.rows_error;
  observe_choice(&choice, false, 0, 1e6);
  CHECK(choice.rows_error.value == before.value);
}

// Goal: ways that take about as long do not alternate.
TEST_CASE("effect_choice_is_steady_where_both_take_as_long") {
  EffectChoice choice;
  int changes = 0;
  bool before = false;
  for (int i = 0; i < int(kRetryFrames); ++i) {
    const double noise = i % 2 ? 1.02 : 0.98;
    effect_frames(&choice, 1, {50e6 * noise, 50e6 / noise, 50e6, 50e6});
    changes += choice.by_effect != before;
    before = choice.by_effect;
  }
  CHECK(changes <= 10);  // trials, ever fewer
}
