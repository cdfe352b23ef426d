// The viewer on the null screen, with scripted buttons and clock.
#include "viewer/viewer.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "platform/file.h"
#include "platform/null/null.h"
#include "session/open_scene.h"
#include "support/generated_scene.h"
#include "viewer/stage.h"

using namespace pocketray;

namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

// Number of frames of a still rendered within a budget until the user quits.
std::uint32_t frames_until(std::uint64_t quit_ns, double budget_ms) {
  platform::Event script[1];
  script[0].type = platform::EventType::quit, script[0].time_ns = quit_ns;
  platform::NullSettings settings;
  settings.script = script, settings.script_count = 1;
  platform::null_configure(settings);
  CommonOptions common;
  common.scene = "cube", common.size = "8x8", common.threads = 1;
  ViewOptions options;
  options.backend = "null", options.rotation = 0;
  Viewer viewer;
  REQUIRE(open_viewer(options, "cube", 8, 8, &viewer).ok);
  OpenScene opened;
  OpenFront front;
  FrontSource ladder;
  ladder.file = "no-such.front", ladder.may_be_new = true;
  REQUIRE(open_scene_with_front(common, ladder, viewer_bytes, &opened, &front).ok);
  BudgetOptions budgeted;
  budgeted.ms = budget_ms;
  Budget budget;
  start_budget(budgeted, front, opened.renderer, 16, &budget);
  viewer.budget = &budget;
  bool again;
  REQUIRE(run_viewer(&viewer, &opened.renderer, &again).ok);
  CHECK(viewer.quit);
  close_viewer(&viewer);
  platform::null_configure(platform::NullSettings());
  return viewer.frames_finished;
}

}  // namespace

// Goal: a still with a budget is rendered again until its settings settle, and no longer. Method: the user quits after
// ten seconds of the screen's clock, and after a hundred; a frame takes 1/60 s.
TEST_CASE("viewer_settles_a_still_within_a_budget") {
  std::uint32_t early = frames_until(10 * kSecond, 1e6), late = frames_until(100 * kSecond, 1e6);
  CHECK(early > 1);
  CHECK(early == late);
  std::uint32_t too_dear = frames_until(100 * kSecond, 1e-3);
  CHECK(too_dear > 1);
  CHECK(too_dear <= 100);
}

namespace {

bool is_equal(const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

}  // namespace

// Goal: each button shows its result for a while. Method: buttons without effect in this run, and a screenshot; the
// screen two and eight seconds later.
TEST_CASE("viewer_answers_each_button") {
  char folder[] = "/tmp/pocketray_XXXXXX";
  REQUIRE(mkdtemp(folder) != nullptr);
  const struct {
    platform::Button button;
    std::string answer;
  } kAnswers[] = {{platform::Button::screenshot, std::string("saved ") + folder + "/pocketray-0001.p"},
                  {platform::Button::side_by_side, "V shows "},
                  {platform::Button::animation, "nothing moves"},
                  {platform::Button::finer, "quality high: "},
                  {platform::Button::faster, "quality low: "}};
  for (const auto& row : kAnswers) {
    for (bool soon : {true, false}) {
      CAPTURE(row.answer);
      Stage stage;
      stage.press(0, platform::Button::hud);  // hides the permanent overlay
      stage.press(1, row.button);
      stage.leave(soon ? 3 : 9);
      stage.open("cube", folder);
      OpenScene opened;
      CHECK_FALSE(stage.show("cube", &opened));
      CHECK_MESSAGE(std::strstr(stage.viewer.note.text, row.answer.c_str()), stage.viewer.note.text);
      CHECK(stage.viewer.note.number == 1);
      CHECK(stage.viewer.note_shown == (soon ? 1 : 0));
      CHECK((stage.viewer.hud_rows_shown > 0) == soon);
      platform::remove_folder(folder);
      REQUIRE(mkdir(folder, 0777) == 0);
    }
  }
  rmdir(folder);
}

// Goal: N plays the next animation, then none, then the first again, and says so. Method: presses in the seesaw, which
// has one.
TEST_CASE("viewer_steps_through_animations") {
  for (int presses : {1, 2}) {
    Stage stage;
    for (int i = 0; i < presses; ++i) stage.press(0.2 + 0.1 * i, platform::Button::animation);
    stage.leave(0.8);
    stage.open("seesaw");
    OpenScene opened;
    stage.show("seesaw", &opened);
    CHECK(opened.renderer.view.animation == (presses == 1 ? kNone : 0u));
    CHECK_MESSAGE(std::strstr(stage.viewer.note.text, presses == 1 ? "no animation plays" : "animation 0, "),
                  stage.viewer.note.text);
  }
}

// Goal: once its note is gone, the screen shows the picture again. Method: pixels before a note and after it.
TEST_CASE("viewer_takes_its_note_away") {
  std::vector<std::uint32_t> screens[2];
  for (bool told : {false, true}) {
    Stage stage;
    stage.press(0, platform::Button::hud);
    if (told) stage.press(1, platform::Button::side_by_side);
    stage.leave(9);
    stage.open("cube");
    OpenScene opened;
    stage.show("cube", &opened);
    screens[told] = stage.screen;
  }
  CHECK(screens[0] == screens[1]);
}

// Goal: a reloaded scene is shown from the user's camera, or from its own if the user did not move; another scene from
// its own. Method: turn the camera, or not, and reload.
TEST_CASE("viewer_keeps_the_camera") {
  for (bool moved : {true, false}) {
    for (bool other : {false, true}) {
      CAPTURE(moved);
      CAPTURE(other);
      Stage stage;
      if (moved) stage.press(1, platform::Button::right), stage.press(2, platform::Button::right, false);
      stage.press(2.5, platform::Button::select);
      stage.press(2.6, platform::Button::select, false);
      stage.press(2.7, platform::Button::finer);
      stage.press(3, platform::Button::reload);
      stage.leave(4);
      stage.open("seesaw");
      OpenScene first, second;
      CHECK(stage.show("seesaw", &first));
      CHECK(stage.viewer.kept.camera_moved == moved);
      CHECK(stage.viewer.kept.seconds > 2);
      if (other) stage.viewer.scene_path = "cube";
      CHECK_FALSE(stage.show(other ? "cube" : "seesaw", &second));
      CHECK(second.renderer.view.camera_overridden == (moved && !other));
      if (moved && !other) CHECK(is_equal(first.renderer.view.camera.eye, second.renderer.view.camera.eye));
    }
  }
}

// Goal: without a scene, the last picture stays and the user is told why; a finished change of the file ends the wait,
// as do buttons. Method: a reload is due; pixels below the text; a changed file, the button, and quitting.
TEST_CASE("viewer_keeps_the_picture_without_a_scene") {
  char path[] = "/tmp/pocketray_XXXXXX";
  int file = mkstemp(path);
  REQUIRE(file >= 0);
  Stage stage;
  stage.press(0, platform::Button::hud);
  stage.press(2, platform::Button::reload);
  stage.press(20, platform::Button::reload);
  stage.leave(30);
  stage.open(path);
  OpenScene opened;
  CHECK(stage.show("cube", &opened));
  std::vector<std::uint32_t> before = stage.screen;
  auto unlike = [&](int first_row) {
    int count = 0;
    for (std::size_t i = static_cast<std::size_t>(first_row * Stage::kWidth); i < before.size(); ++i)
      count += before[i] != stage.screen[i];
    return count;
  };
  CHECK(unlike(0) == 0);
  REQUIRE(show_waiting(&stage.viewer, "loading"));
  CHECK(unlike(0) > 0);
  CHECK(unlike(static_cast<int>(stage.viewer.hud_rows_shown)) == 0);
  // The file changes.
  watch_scene(&stage.viewer);
  REQUIRE(write(file, "changed", 7) == 7);
  std::uint64_t start = stage.viewer.backend->now_ns();
  CHECK(wait_for_another(&stage.viewer, "it is broken"));
  CHECK(unlike(static_cast<int>(stage.viewer.hud_rows_shown)) == 0);
  std::uint64_t waited = stage.viewer.backend->now_ns() - start;
  CHECK(waited > kSecond);  // two polls
  CHECK(waited < 3 * kSecond);
  // Nothing changes: the reload button, then quit.
  watch_scene(&stage.viewer);
  CHECK(wait_for_another(&stage.viewer, "it is broken"));
  CHECK(stage.viewer.backend->now_ns() > 19 * kSecond);
  CHECK_FALSE(wait_for_another(&stage.viewer, "it is broken"));
  CHECK(stage.viewer.quit);
  close(file);
  std::remove(path);
}

// Goal: start goes back to the scene's own view, to the bit, so that the picture is the one that render writes. Method:
// turn, then press start, in scenes whose cameras do not look at their centres.
TEST_CASE("viewer_goes_back_to_the_scenes_own_view") {
  for (const char* scene : {"cube", "cornell", "statue"}) {
    CAPTURE(scene);
    Stage stage;
    stage.press(0.5, platform::Button::right);
    stage.press(0.8, platform::Button::right, false);
    stage.press(1.5, platform::Button::start);
    stage.leave(2);
    stage.open(scene);
    OpenScene opened;
    stage.load(scene, "off", &opened);
    const Camera own = opened.renderer.view.camera;
    bool again;
    REQUIRE(run_viewer(&stage.viewer, &opened.renderer, &again).ok);
    CHECK(is_equal(opened.renderer.view.camera.eye, own.eye));
    CHECK(is_equal(opened.renderer.view.camera.target, own.target));
    CHECK(opened.renderer.view.camera_overridden);  // it was turned at all
  }
}

// Goal: the null screen is used only on request. Method: no display and no framebuffer.
TEST_CASE("viewer_wants_a_screen") {
  if (access("/dev/fb0", F_OK) == 0) return;
  std::string kept[3];
  const char* const names[] = {"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"};
  for (int i = 0; i < 3; ++i) {
    if (const char* value = std::getenv(names[i])) kept[i] = value;
    unsetenv(names[i]);
  }
  Viewer viewer;
  ViewOptions options;
  options.rotation = 0;
  Status status = open_viewer(options, "cube", 32, 24, &viewer);
  CHECK_FALSE(status.ok);
  CHECK(std::strstr(status.message, "no screen found") != nullptr);
  CHECK(std::strstr(status.message, "linux needs a framebuffer") != nullptr);
  CHECK(std::strstr(status.message, "--screen") != nullptr);
  close_viewer(&viewer);
  for (int i = 0; i < 3; ++i)
    if (!kept[i].empty()) setenv(names[i], kept[i].c_str(), 1);
}

namespace {

std::uint64_t sleep_count, sleep_ns_max;

void count_sleep(std::uint64_t duration) {
  ++sleep_count;
  sleep_ns_max = std::max(sleep_ns_max, duration);
  platform::kNullBackend.sleep_ns(duration);
}

// Shows a still with interpolated pixels, alone or within a budget, until a time, a button pressed before; the picture.
// *last receives the settings of the last frame.
Picture picture_at(double seconds, const Quality& quality, bool budgeted, double button_at, double button_seconds = 0.2,
                   Quality* last = nullptr, bool keeps_samples = false) {
  Stage stage;
  if (button_at > 0) {
    stage.press(button_at, platform::Button::left);
    stage.press(button_at + button_seconds, platform::Button::left, false);
  }
  stage.leave(seconds);
  stage.open("statue");
  stage.viewer.options.keeps_samples = keeps_samples;
  CommonOptions common;
  common.scene = "statue", common.size = "320x60", common.threads = 1;
  common.settings["selective"].real = static_cast<double>(quality.selective_contrast);
  common.settings["resolution"].choice = kResolutionNames[static_cast<int>(quality.resolution)];
  OpenHooks hooks;
  hooks.output_bytes = viewer_bytes;
  OpenScene opened;
  REQUIRE(open_scene(common, hooks, &opened).ok);
  REQUIRE(start_scene(&opened, common).ok);
  OpenFront front;
  Candidate only = candidate_of(opened.renderer.settings);
  only.ns_per_pixel = 1000;
  front.front.candidates[front.front.count++] = only;
  BudgetOptions options;
  options.ms = 1e6;
  Budget budget;
  start_budget(options, front, opened.renderer, 320 * 60, &budget);
  if (budgeted) stage.viewer.budget = &budget;
  bool again;
  REQUIRE(run_viewer(&stage.viewer, &opened.renderer, &again).ok);
  if (last) *last = opened.renderer.settings;
  return Picture(opened.renderer.image.begin(), opened.renderer.image.end());
}

Picture statue_of_samples(std::uint32_t count) {
  CommonOptions common;
  common.scene = "statue", common.size = "320x60", common.threads = 1;
  common.settings["samples"].count = count;
  OpenHooks hooks;
  hooks.output_bytes = viewer_bytes;
  OpenScene opened;
  REQUIRE(open_scene(common, hooks, &opened).ok);
  REQUIRE(start_scene(&opened, common).ok);
  REQUIRE(render_frame(&opened.renderer, 0).ok);
  return Picture(opened.renderer.image.begin(), opened.renderer.image.end());
}

}  // namespace

// Goal: what rests is refined to 16 samples of each pixel, and after a move it has few or is interpolated again.
// Method: pictures long after the first and soon after a move, with every pixel traced and without; a frame takes 1/60
// s of the screen's clock.
TEST_CASE("viewer_refines_what_rests") {
  for (bool budgeted : {false, true}) {
    CAPTURE(budgeted);
    const Quality all;
    Quality some;
    const Picture exact = picture_at(20, all, budgeted, 0), moved = picture_at(40, all, budgeted, 19);
    CHECK(!same_picture(moved, exact));
    CHECK(same_picture(exact, statue_of_samples(16)));
    for (int i = 0; i < 4; ++i) {
      some.selective_contrast = i % 3 == 0 ? 0.25f : 0;
      some.resolution = i == 0 ? Resolution::full : i == 1 ? Resolution::half : Resolution::checkerboard;
      CHECK(same_picture(picture_at(20, some, budgeted, 0), exact));
      CHECK(same_picture(picture_at(40, some, budgeted, 19), moved));
      Quality last;
      picture_at(20, some, budgeted, 19, 2, &last);  // still moving
      CHECK(same_quality(last, some));
    }
  }
}

// Goal: samples that were asked for stay while a picture rests; only interpolated pixels are traced. Method: as above.
TEST_CASE("viewer_keeps_the_samples_asked_for_at_rest") {
  const Quality all;
  Quality some;
  some.selective_contrast = 0.25f;
  for (bool budgeted : {false, true}) {
    CAPTURE(budgeted);
    const Picture one = picture_at(20, all, budgeted, 0, 0.2, nullptr, true);
    CHECK(same_picture(picture_at(20, some, budgeted, 0, 0.2, nullptr, true), one));
    CHECK(same_picture(one, statue_of_samples(1)));
  }
}

namespace {

struct DialEnd {
  Settings settings;
  std::string note;
  std::size_t memory;
  KeptView kept;
};

// Presses, at most one every half second, and what they lead to when the scene is reloaded after them.
DialEnd after_presses(const std::vector<std::pair<platform::Button, bool>>& presses, const char* memory = "64M",
                      bool shared = false, const char* scene = "cube") {
  Stage stage;
  stage.memory = memory;
  double seconds = 0;
  for (const auto& press : presses) stage.press(seconds += 0.5, press.first, press.second);
  stage.press(seconds + 1, platform::Button::reload);
  stage.leave(seconds + 2);
  stage.open(scene);
  OpenScene opened, reloaded;
  stage.load(scene, "off", &opened);
  if (shared) stage.viewer.dial = nullptr;
  bool again;
  REQUIRE(run_viewer(&stage.viewer, &opened.renderer, &again).ok);
  REQUIRE(again);
  DialEnd end = {opened.renderer.settings, stage.viewer.note.text, opened.renderer.memory.plan.total_bytes,
                 stage.viewer.kept};
  stage.viewer.reload = false;
  stage.show(scene, &reloaded);
  CHECK(same_quality(reloaded.renderer.settings, end.settings));
  return end;
}

}  // namespace

// Goal: + and − turn the dial, which stops at its ends; so do select with up and down, which then neither moves the
// camera nor changes its mode; a reload keeps the quality; a level without memory is refused. Method: presses, and the
// settings they lead to.
TEST_CASE("viewer_turns_the_dial") {
  using platform::Button;
  const Button finer = Button::finer, faster = Button::faster;
  const Quality medium, low = builtin_level(QualityLevel::low, EffectMask(0));
  const Quality high = after_presses({{finer, true}}).settings,
                best = after_presses({{finer, true}, {finer, true}}).settings;
  CHECK(high.edge_samples == 8);
  CHECK(best.samples_per_pixel == 16);
  const DialEnd beyond = after_presses({{finer, true}, {finer, true}, {finer, true}});
  CHECK(same_quality(beyond.settings, best));
  CHECK(beyond.note == "best is the highest quality");
  CHECK(same_quality(after_presses({{finer, true}, {faster, true}}).settings, medium));
  CHECK(after_presses({{faster, true}}).settings.points_per_area_light == low.points_per_area_light);
  const DialEnd combined =
      after_presses({{Button::select, true}, {Button::up, true}, {Button::up, false}, {Button::select, false}});
  CHECK(same_quality(combined.settings, high));
  CHECK(combined.kept.control.mode == CameraMode::orbit);
  CHECK(!combined.kept.camera_moved);
  CHECK(after_presses({{finer, true}}, "64M", true).note ==
        "+ and - change the quality, but not of frames shared with servers");
  const std::string tight = std::to_string(after_presses({}, "64M", false, "seesaw").memory - 1000);
  const DialEnd refused = after_presses({{finer, true}, {finer, true}}, tight.c_str(), false, "seesaw");
  CHECK(same_quality(refused.settings, medium));
  CHECK(refused.note == "quality high needs more memory than was planned: raise --memory");
}

// Goal: a viewer that nobody touches wakes rarely, shows nothing, and answers soon all the same. Method: count the
// sleeps of a minute; a key at its end, and the time of the answer. Stills, and an animation that is paused or not
// chosen.
TEST_CASE("viewer_rests_while_idle") {
  const std::pair<const char*, platform::Button> kCases[] = {
      {"cube", platform::Button::x}, {"seesaw", platform::Button::x}, {"seesaw", platform::Button::animation}};
  for (const auto& one : kCases) {
    const char* scene = one.first;
    const platform::Button button = one.second;
    CAPTURE(scene);
    CAPTURE(static_cast<int>(button));
    Stage stage;
    stage.press(0.5, platform::Button::hud);
    stage.press(0.6, button);
    stage.press(61, platform::Button::finer);
    stage.leave(62);
    stage.open(scene);
    platform::Backend counting = *stage.viewer.backend;
    counting.sleep_ns = count_sleep;
    stage.viewer.backend = &counting;
    sleep_count = sleep_ns_max = 0;
    OpenScene opened;
    stage.show(scene, &opened, "on");
    CHECK(sleep_count > 60 * 25);
    CHECK(sleep_count < 62 * 33 + 2 * 125);
    CHECK(sleep_ns_max <= 40'000'000);
    REQUIRE(stage.viewer.note.number == (button == platform::Button::animation ? 2 : 1));
    CHECK(stage.viewer.note.until_ns <= 65 * kSecond + 40'000'000);
    CHECK(platform::null_record().frames_shown < 100);
  }
}
