// The image-space methods on pictures made up here, whose right answer is known, and on a small part of a sequence.
#include "desktop/coherence_report/image_space_report.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/frame.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

using Frames = std::vector<FrameImage>;

// "Traces" frames that are known.
TracePixels look_up(const Frames& frames) {
  return [&frames](std::uint32_t frame, const PixelList& pixels, FrameImage* image) {
    CHECK(std::is_sorted(pixels.begin(), pixels.end()));
    for (std::uint32_t pixel : pixels) (*image)[pixel] = frames[frame][pixel];
    return success();
  };
}

constexpr std::uint32_t kWidth = 12, kHeight = 9, kPixels = kWidth * kHeight;
constexpr Vec3 kBlack = {0, 0, 0}, kWhite = {1, 1, 1};
std::uint32_t at(std::uint32_t column, std::uint32_t row) { return row * kWidth + column; }

FrameImage black() { return FrameImage(kPixels, kBlack); }

// Every pixel changes in about half of the frames.
Frames random_frames(std::uint32_t count) {
  Rng rng = make_rng(13);
  Frames frames(count, black());
  for (FrameImage& frame : frames)
    for (Vec3& pixel : frame) pixel.x = static_cast<float>(next_u32(&rng) % 2);
  return frames;
}

BadtState after(const FrameImage& image) { return {kWidth, kHeight, image, {}, make_rng(1)}; }

std::uint64_t wrong_of(const FrameImage& whole, const FrameImage& image) {
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) wrong += differs(whole[i], image[i]);
  return wrong;
}

// Chapman over all frames, a picture for each; returns how many pixels were traced after the first.
std::uint64_t chapman(const Frames& frames, std::size_t step, Frames* images) {
  images->assign(frames.size(), {});
  images->front() = frames[0];
  std::vector<std::uint64_t> traced(frames.size());
  for (std::size_t begin = 0, end; begin + 1 < frames.size(); begin = end) {
    end = std::min(begin + step, frames.size() - 1);
    REQUIRE(chapman_frames(look_up(frames), static_cast<std::uint32_t>(begin), end - begin + 1, &(*images)[begin],
                           &traced[begin])
                .ok);
  }
  std::uint64_t sum = 0;
  for (std::uint64_t count : traced) sum += count;
  return sum;
}

}  // namespace

// Goal: a sample has that many pixels, each as likely as any other. Method: many samples of a quarter, counted, within
// five standard deviations; none, and all.
TEST_CASE("image_space_samples_are_fair") {
  Rng rng = make_rng(7);
  CHECK(sample_pixels(kPixels, 0, &rng).empty());
  const PixelList all = sample_pixels(kPixels, kPixels, &rng);
  REQUIRE(all.size() == kPixels);
  for (std::uint32_t i = 0; i < kPixels; ++i) CHECK(all[i] == i);
  constexpr int kSamples = 4000;
  std::vector<int> counts(kPixels);
  for (int n = 0; n < kSamples; ++n) {
    const PixelList sample = sample_pixels(kPixels, kPixels / 4, &rng);
    REQUIRE(sample.size() == kPixels / 4);
    REQUIRE(std::adjacent_find(sample.begin(), sample.end(), std::greater_equal<>()) == sample.end());
    for (std::uint32_t pixel : sample) ++counts[pixel];
  }
  const double mean = kSamples / 4.0, deviation = std::sqrt(kSamples * 0.25 * 0.75);
  for (int count : counts) CHECK(std::fabs(count - mean) < 5 * deviation);
}

// Goal: a flood finds what hangs together with a pixel that changed, and no more. Method: a block of 4 × 3 pixels and a
// lone pixel change; the flood begins in the block's corner, beside the block, and far away.
TEST_CASE("image_space_flood_finds_what_hangs_together") {
  Frames frames(2, black());
  for (std::uint32_t row = 3; row < 6; ++row)
    for (std::uint32_t column = 2; column < 6; ++column) frames[1][at(column, row)] = kWhite;
  frames[1][at(10, 7)] = kWhite;
  std::uint64_t traced;
  BadtState state = after(frames[0]);
  REQUIRE(flood_changes(look_up(frames), 1, {at(2, 3)}, &state, &traced).ok);
  CHECK(traced == 6 * 5);  // and the ring around it
  CHECK(state.changed.size() == 12);
  CHECK(wrong_of(frames[1], state.image) == 1);
  for (std::uint32_t first : {at(1, 3), at(0, 0)}) {
    state = after(frames[0]);
    REQUIRE(flood_changes(look_up(frames), 1, {first}, &state, &traced).ok);
    CHECK(traced == 1);
    CHECK(state.changed.empty());
    CHECK(wrong_of(frames[1], state.image) == 13);
  }
}

// Goal: a flood stays in the picture. Method: changes in each corner, and of all pixels.
TEST_CASE("image_space_flood_stays_in_the_picture") {
  const std::uint32_t corners[] = {at(0, 0), at(kWidth - 1, 0), at(0, kHeight - 1), at(kWidth - 1, kHeight - 1)};
  std::uint64_t traced;
  for (std::uint32_t corner : corners) {
    Frames frames(2, black());
    frames[1][corner] = kWhite;
    BadtState state = after(frames[0]);
    REQUIRE(flood_changes(look_up(frames), 1, {corner}, &state, &traced).ok);
    CHECK(traced == 4);
  }
  Frames frames = {black(), FrameImage(kPixels, kWhite)};
  BadtState state = after(frames[0]);
  REQUIRE(flood_changes(look_up(frames), 1, {at(5, 5)}, &state, &traced).ok);
  CHECK(traced == kPixels);
  CHECK(wrong_of(frames[1], state.image) == 0);
}

// Goal: a sample of every pixel is exact; no sample finds nothing, but what has changed is traced again. Method: random
// frames.
TEST_CASE("image_space_badt_with_every_pixel_is_exact") {
  const Frames frames = random_frames(6);
  BadtState state = after(frames[0]), blind = state;
  for (std::uint32_t frame = 1; frame < frames.size(); ++frame) {
    std::uint64_t traced;
    REQUIRE(badt_frame(look_up(frames), frame, 1, &state, &traced).ok);
    CHECK(traced == kPixels);
    CHECK(wrong_of(frames[frame], state.image) == 0);
    REQUIRE(badt_frame(look_up(frames), frame, 0, &blind, &traced).ok);
    CHECK(traced == 0);
  }
  CHECK(wrong_of(frames[0], blind.image) == 0);
  blind.changed = {at(4, 4)};
  std::uint64_t traced;
  REQUIRE(badt_frame(look_up(frames), 1, 0, &blind, &traced).ok);
  CHECK(traced > 0);
}

// Goal: with every frame traced, Chapman is exact. Method: random frames.
TEST_CASE("image_space_chapman_with_every_frame_is_exact") {
  const Frames frames = random_frames(7);
  Frames images;
  CHECK(chapman(frames, 1, &images) == 6 * kPixels);
  for (std::size_t i = 0; i < frames.size(); ++i) CHECK(wrong_of(frames[i], images[i]) == 0);
}

// Goal: a pixel that is lit in one frame alone is missed unless that frame is traced. Method: each frame of eight, each
// distance; as wrong pixels are counted, a missed blink is one.
TEST_CASE("image_space_chapman_misses_a_blink_between_traced_frames") {
  for (std::size_t step : {2, 4, 8})
    for (std::size_t blink = 1; blink < 8; ++blink) {
      Frames frames(9, black()), images;
      frames[blink][at(3, 3)] = kWhite;
      const std::uint64_t traced = chapman(frames, step, &images);
      std::uint64_t wrong = 0;
      for (std::size_t i = 0; i < frames.size(); ++i) wrong += wrong_of(frames[i], images[i]);
      CAPTURE(step);
      CAPTURE(blink);
      CHECK(wrong == (blink % step == 0 ? 0 : 1));
      if (blink % step != 0) CHECK(traced == 8 / step * kPixels);
    }
}

// Goal: halving finds the frame in which a pixel changes, at the price of a pixel for each halving. Method: one change,
// in each of sixteen frames; and of a group that is no power of two.
TEST_CASE("image_space_chapman_finds_when_a_pixel_changes") {
  for (std::size_t count : {17, 12})
    for (std::size_t change = 1; change < count; ++change) {
      Frames frames(count, black()), images;
      for (std::size_t i = change; i < count; ++i) frames[i][at(7, 2)] = kWhite;
      const std::uint64_t traced = chapman(frames, 16, &images);
      CAPTURE(change);
      if (count == 17) CHECK(traced == kPixels + 4);
      for (std::size_t i = 0; i < count; ++i) CHECK(wrong_of(frames[i], images[i]) == 0);
    }
}

// Goal: errors are counted rightly. Method: differences that a screen does not show, that it shows, and none; ꟻLIP of
// black and white all over is 1.
TEST_CASE("image_space_errors_are_counted") {
  ImageSpaceErrors errors;
  FrameImage whole = black(), image = whole;
  add_errors(whole, image, kWidth, kHeight, 1, &errors);
  CHECK(errors.wrong == 0);
  image[3].y = 1e-7f, image[4].z = -0.0f, image[5] = kWhite;
  add_errors(whole, image, kWidth, kHeight, 1, &errors);
  CHECK(errors.wrong == 3);
  CHECK(errors.wrong_shown == 1);
  CHECK(errors.wrong_most == 3);
  CHECK(errors.flip_sum > 0);
  CHECK(errors.flip_sum < errors.flip_max / 10);
  image.assign(kPixels, kWhite);
  add_errors(whole, image, kWidth, kHeight, 1, &errors);
  CHECK(errors.wrong == 3 + kPixels);
  CHECK(errors.wrong_shown == 1 + kPixels);
  CHECK(errors.wrong_most == kPixels);
  errors = ImageSpaceErrors();
  add_errors(whole, image, kWidth, kHeight, 1, &errors);
  CHECK(errors.flip_sum == doctest::Approx(errors.flip_max).epsilon(1e-5));
  CHECK(errors.flip_max > 0.9);
}

// Goal: a run's figures are those of its frames. Method: whole frames rendered here, looked up instead of traced, give
// as many pixels traced and wrong; more frames than a group has.
TEST_CASE("image_space_run_is_that_of_whole_frames") {
  Settings settings;
  settings.width = 40, settings.height = 30;
  std::unique_ptr<TestRenderer> traced = make_renderer(shared_builtin("seesaw")->scene, settings);
  std::unique_ptr<TestRenderer> again = make_renderer(shared_builtin("seesaw")->scene, settings);
  constexpr std::uint32_t kFirst = 5, kLast = 24;
  ImageSpaceRun run;
  Progress progress = start_progress("test", image_space_step_count({kFirst, kLast, true}));
  REQUIRE(run_image_space(&traced->renderer, {kFirst, kLast, true}, &progress, &run).ok);
  CHECK(run.frame_count == kLast - kFirst + 1);
  Frames frames(kLast + 1);
  std::uint64_t rays = 0;
  for (std::uint32_t frame = kFirst; frame <= kLast; ++frame) {
    REQUIRE(render_frame(&again->renderer, frame / 30.0).ok);
    frames[frame].assign(again->renderer.image.begin(), again->renderer.image.end());
    rays += ray_count(again->renderer);
  }
  CHECK(run.whole.rays == rays);
  CHECK(run.whole.ms > 0);
  REQUIRE(run.ways.size() == std::size(kImageSpaceWays));
  std::uint64_t last_traced = ~std::uint64_t(0);
  for (const ImageSpaceFigures& f : run.ways) {
    CAPTURE(f.way.parameter);
    const bool is_badt = f.way.method == ImageSpaceMethod::badt;
    const std::uint64_t pixels = settings.width * settings.height;
    std::uint64_t sum = pixels, wrong = 0;
    if (is_badt) {
      BadtState state = {settings.width, settings.height, frames[kFirst], {}, make_rng(1988)};
      for (std::uint32_t frame = kFirst + 1; frame <= kLast; ++frame) {
        std::uint64_t count;
        REQUIRE(badt_frame(look_up(frames), frame, 1.0 / f.way.parameter, &state, &count).ok);
        sum += count, wrong += wrong_of(frames[frame], state.image);
      }
    } else {
      const Frames part(frames.begin() + kFirst, frames.end());
      Frames images;
      sum += chapman(part, f.way.parameter, &images);
      for (std::size_t i = 0; i < part.size(); ++i) wrong += wrong_of(part[i], images[i]);
    }
    CHECK(f.traced == sum);
    CHECK(f.errors.wrong == wrong);
    CHECK(f.errors.wrong_shown <= wrong);
    CHECK(f.errors.wrong_most <= pixels);
    CHECK(f.cost.rays < rays);
    CHECK(f.cost.rays > rays / 40);
    if (f.way.method == ImageSpaceMethod::badt || f.way.parameter > 2) CHECK(f.traced < last_traced);
    last_traced = f.traced;
  }
}

// Goal: rows, JSON and CSV have the figures as ratios. Method: an invented run.
TEST_CASE("image_space_report_has_the_figures") {
  CoherenceReport report;
  report.ours.width = 10, report.ours.height = 10;
  for (std::uint32_t frame = 0; frame < 4; ++frame) {
    FrameFigures f;
    f.frame = frame, f.retraced = frame ? 10 : 100;
    f.whole = {1000, 8, 8}, f.coherent = {100, 2, 2};
    report.ours.frames.push_back(f);
  }
  CHECK(report_json(report)["image_space"].is_null());
  ImageSpaceRun* run = &report.image_space;
  run->width = 10, run->height = 10, run->frame_count = 4;
  run->whole = {4000, 32, 32};
  for (const ImageSpaceWay& way : kImageSpaceWays)
    run->ways.push_back({way, {1000, 16, 16}, 300, {40, 20, 25, 0.5, 0.75}});
  const std::vector<ErrorRow> rows = error_rows(report);
  REQUIRE(rows.size() == 10);
  CHECK(rows[0].pixels == doctest::Approx(0.325));
  CHECK(rows[0].time == doctest::Approx(0.25));
  CHECK(rows[0].wrong == 0);
  CHECK(rows[1].name == "Badt 1988, 1/4 of the pixels sampled");
  CHECK(rows[9].name == "Chapman 1990, frames 16 apart");
  CHECK(rows[1].pixels == doctest::Approx(0.75));
  CHECK(rows[1].rays == doctest::Approx(0.25));
  CHECK(rows[1].time == doctest::Approx(0.5));
  CHECK(rows[1].wrong == doctest::Approx(0.1));
  CHECK(rows[1].wrong_shown == doctest::Approx(0.05));
  CHECK(rows[1].wrong_most == doctest::Approx(0.25));
  CHECK(rows[1].flip == doctest::Approx(0.125));
  CHECK(rows[1].flip_max == doctest::Approx(0.75));
  const Json json = report_json(report)["image_space"];
  CHECK(json["ways"].size() == 9);
  CHECK(json["ways"][0]["sampled_one_of"] == 4);
  CHECK(json["ways"][5]["frames_apart"] == 2);
  CHECK(json["ways"][5]["wrong"].get<double>() == doctest::Approx(0.1));
  const std::string csv = image_space_csv(report);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 11);
  CHECK(csv.find("\n\"Badt 1988, 1/4 of the pixels sampled\",0.75,0.25,0.5,0.1,0.05,0.25,0.125,0.75\n") !=
        std::string::npos);
  CHECK(image_space_table(report).find("<th>pocketray</th>") != std::string::npos);
  CHECK(wrong_plot(report).script.find("no error") != std::string::npos);
}
