// The sweep as a whole, on a picture of a few pixels.
#include <doctest/doctest.h>
#include <stdlib.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>
#include <thread>

#include "desktop/accuracy/display.h"
#include "desktop/sweep/references.h"
#include "platform/file.h"
#include "scene/baked.h"
#include "session/heap_scene.h"
#include "session/interrupt.h"
#include "session/output.h"
#include "sweep/folder.h"

using namespace pocketray;

namespace {

Status run_sweep(const AccuracyOptions& options, Sweep* sweep, bool* whole, const std::string& cache = "") {
  setenv("XDG_CACHE_HOME", cache.empty() ? (options.folder + "/cache").c_str() : cache.c_str(), 1);
  return measure_sweep(options, sweep, whole);
}

// A file of `cube` that stores no radiosity: only these are not solved for when they are opened.
const std::string& plain_cube() {
  static const Folder folder;
  static const std::string path = [] {
    HeapScene heap;
    REQUIRE(read_heap_scene("cube", ModelOptions(), &heap).ok);
    std::string bytes(baked_size(heap.scene), 0);
    baked_write(heap.scene, reinterpret_cast<std::uint8_t*>(&bytes[0]));
    const std::string made = folder.file("cube.pray");
    REQUIRE(write_file(made, bytes).ok);
    return made;
  }();
  return path;
}

AccuracyOptions small(const Folder& folder) {
  AccuracyOptions o;
  o.common.scene = plain_cube();
  o.common.size = "32x24";
  o.common.threads = 2;
  o.common.memory = "16M";
  o.folder = folder.path;
  o.reference_samples = 8;
  o.rounds = 2;
  return o;
}

Sweep measure(const AccuracyOptions& options, const std::string& cache = "") {
  Sweep sweep;
  bool whole;
  Status status = run_sweep(options, &sweep, &whole, cache);
  REQUIRE_MESSAGE(status.ok, status.message);
  CHECK(whole);
  return sweep;
}

void check_same_errors(const Sweep& a, const Sweep& b) {
  CHECK(a.truth.rmse == b.truth.rmse);
  CHECK(a.model.flip == b.model.flip);
  CHECK(a.model_distance == b.model_distance);
  CHECK(a.reference_picture.rgb == b.reference_picture.rgb);
  REQUIRE(a.measured.size() == b.measured.size());
  for (std::size_t i = 0; i < a.measured.size(); ++i) {
    const Measured &m = a.measured[i], &n = b.measured[i];
    CAPTURE(m.value);
    CHECK(m.value == n.value);
    CHECK(m.missing == n.missing);
    CHECK(m.truth.flip == n.truth.flip);
    CHECK(m.truth.one == n.truth.one);
    CHECK(m.model.flip == n.model.flip);
    CHECK(m.model.other == n.model.other);
    CHECK(m.flip_before == n.flip_before);
    CHECK(m.flip_as == n.flip_as);
    CHECK(m.errors.rmse == n.errors.rmse);
    CHECK(m.errors.rel_mse == n.errors.rel_mse);
    CHECK(m.errors.max == n.errors.max);
    CHECK(m.errors.bias == n.errors.bias);
  }
}

void copy_file(const std::string& from, const std::string& to) {
  platform::LoadedFile file;
  platform::FileError error;
  REQUIRE(platform::load_file(from.c_str(), &file, &error));
  platform::FileWriter writer;
  REQUIRE(platform::open_writer(to.c_str(), &writer, &error));
  platform::write_bytes(&writer, file.bytes, file.byte_count);
  REQUIRE(platform::close_writer(&writer, &error));
  platform::unload_file(&file);
}

// Interrupts the sweep as soon as one round is complete.
void interrupt_after_a_round(const Folder& folder, const std::atomic<bool>& done) {
  while (!done) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    platform::LoadedFile file;
    platform::FileError error;
    if (!platform::load_file(folder.file("accuracy.state").c_str(), &file, &error)) continue;
    std::string text(reinterpret_cast<const char*>(file.bytes), file.byte_count);
    platform::unload_file(&file);
    if (text.find("\"rounds\": 0") != std::string::npos) continue;
    interrupted = true;
    return;
  }
}

}  // namespace

// Goal: the sweep has every knob of the scene with figures, a strip of each, and samples reduce errors. Method: `cube`,
// which has no mirror: depth and cut-off are skipped with a note.
TEST_CASE("accuracy_measures_every_knob_of_the_scene") {
  Folder folder;
  Sweep sweep = measure(small(folder));
  CHECK(sweep.rounds == 2);
  CHECK(sweep.width == 32);
  CHECK(sweep.judge == Judge::truth);
  for (const ReferenceFigures* figures : {&sweep.truth, &sweep.model}) {
    CHECK(figures->samples == 8);
    CHECK(figures->rmse > 0);
    CHECK(figures->flip > 0);
  }
  CHECK(sweep.model_rmse > 0);
  std::string names, notes;
  for (const KnobFigures& k : sweep.knobs) names += k.name + " ";
  for (const std::string& note : sweep.notes) notes += note + "\n";
  std::string wanted =
      "samples area-lights indirect selective "
      "resolution edge-samples output ";
#ifdef POCKETRAY_HAVE_NETWORK
  wanted += "near-lossless ";
#endif
  CHECK(names == wanted);
  CHECK(notes.find("depth is skipped") != std::string::npos);
  CHECK(sweep.strips.size() == sweep.knobs.size());
  for (const Strip& strip : sweep.strips) {
    CHECK(strip.rows.size() >= 2);
    for (const StripRow& row : strip.rows) {
      CHECK(row.picture.rgb.size() == 3u * 32 * 24);
      CHECK(row.flip_map.size() == 32u * 24);
      CHECK(row.ms > 0);
      CHECK(mean_of(row.flip_map) == doctest::Approx(row.flip).epsilon(0.3));  // the measured picture, noise included
    }
  }
  double one = 0, sixteen = 0;
  std::set<std::string> methods;
  for (const Measured& m : sweep.measured) {
    CAPTURE(m.value);
    CHECK(m.missing.empty());
    CHECK(m.ns_per_pixel.value > 0);
    CHECK(m.ns_per_pixel.low <= m.ns_per_pixel.value);
    CHECK(m.model.flip > 0);
    CHECK((m.truth.flip > 0 && m.truth.flip != m.model.flip));
    CHECK(m.truth.one.size() == 64);
    CHECK(m.flip_as[1] > 0);
    if (m.knob == "baseline") CHECK(m.flip_as[1] == m.truth.flip);
    if (m.knob == "output" && m.value == "rgb888") CHECK(m.flip_as[2] == m.truth.flip);
    methods.insert(m.indirect);
    if (m.knob == "samples" && m.value == "1") one = m.errors.rmse;
    if (m.knob == "samples" && m.value == "16") sixteen = m.errors.rmse;
  }
  CHECK(sixteen < 0.7 * one);
  CHECK(methods == std::set<std::string>{"ambient", "instant-radiosity", "none"});
  REQUIRE(sweep.quality.size() == 5);
  for (const LevelPicture& level : sweep.quality) {
    CAPTURE(level.level);
    const Measured& row = sweep.measured.at(level.measured_index);
    CHECK(level.ms == doctest::Approx(row.ns_per_pixel.value * 1e-6 * 32 * 24));
    CHECK(level.flip == doctest::Approx(row.flip_as[2]));
  }
}

// Goal: a frame's time covers all its work. Method: a moving scene with few pixels, so that posing and refitting
// dominate: at least the sum of the renderer's own times.
TEST_CASE("accuracy_times_whole_frames") {
  Folder folder;
  AccuracyOptions o = small(folder);
  o.common.scene = "seesaw", o.common.size = "8x6", o.common.memory = "64M";
  std::unique_ptr<Rig> rig;
  REQUIRE(open_rig(o, kCornellSphereColumns, &rig).ok);
  double ns_per_pixel = 0;
  REQUIRE(time_frame(rig.get(), rig->baseline, 0.5, &ns_per_pixel).ok);
  const Timings& t = rig->opened.renderer.timings;
  CHECK(t.refit_ms > 0);
  CHECK(ns_per_pixel * 8 * 6 * 1e-6 >= t.pose_ms + t.refit_ms + t.trace_ms);
}

// Goal: a sweep that was interrupted and resumed has the errors of an uninterrupted one. Method: an interrupt between
// rounds; then only the finished rounds, then one more; against a fresh folder with one round.
TEST_CASE("accuracy_resumes_where_it_was_interrupted") {
  Folder stopped, fresh;
  AccuracyOptions o = small(stopped);
  o.rounds = 1000;
  std::atomic<bool> done{false};
  std::thread interrupter(interrupt_after_a_round, std::ref(stopped), std::ref(done));
  Sweep sweep;
  bool whole = true;
  Status status = run_sweep(o, &sweep, &whole);
  done = true;
  interrupter.join();
  interrupted = false;
  REQUIRE_MESSAGE(status.ok, status.message);
  CHECK_FALSE(whole);
  o.rounds = 1;  // the finished ones suffice
  Sweep resumed = measure(o);
  CHECK(resumed.rounds >= 1);
  CHECK(resumed.rounds < 1000);
  AccuracyOptions other = small(fresh);
  other.rounds = 1;
  check_same_errors(resumed, measure(other));
  // Measures one more round and repeats none.
  o.rounds = resumed.rounds + 1;
  Sweep more = measure(o);
  CHECK(more.rounds == resumed.rounds + 1);
  check_same_errors(more, resumed);
}

// Goal: an immediate interrupt leaves the folder usable, without a partial reference. Method: set the flag before the
// first picture; then the same command, against a fresh folder.
TEST_CASE("accuracy_interrupted_in_a_reference_goes_on") {
  Folder folder;
  AccuracyOptions o = small(folder);
  o.rounds = 1;
  interrupted = true;
  Sweep sweep;
  bool whole = true;
  Status status = run_sweep(o, &sweep, &whole);
  interrupted = false;
  CHECK(status.ok);
  CHECK_FALSE(whole);
  Folder fresh;
  AccuracyOptions other = small(fresh);
  other.rounds = 1;
  check_same_errors(measure(o), measure(other));
}

// Goal: samples of a reference are kept, and its picture equals an uninterrupted one. Method: an interrupt after seven
// rows of the second reference; each row is traced once over both runs. Then the file of a program killed after saving
// some rows.
TEST_CASE("accuracy_goes_on_within_a_reference") {
  constexpr std::uint32_t kRows = 24, kPictures = 2;
  Folder folder, fresh, killed;
  AccuracyOptions o = small(folder), other = small(fresh);
  o.rounds = other.rounds = 1;
  std::uint32_t traced = 0, again = 0;
  o.row_done = [&](std::uint32_t) {
    if (++traced == kRows + 7) interrupted = true;
  };
  Sweep sweep;
  bool whole = true;
  Status status = run_sweep(o, &sweep, &whole);
  interrupted = false;
  REQUIRE_MESSAGE(status.ok, status.message);
  CHECK_FALSE(whole);
  CHECK((traced >= kRows + 7 && traced <= kRows + 7 + o.common.threads));
  o.row_done = [&](std::uint32_t) { ++again; };
  other.save_seconds = 0;
  std::uint32_t rows = 0;
  other.row_done = [&](std::uint32_t) {
    if (++rows != 9) return;
    std::string cache = fresh.file("cache/pocketray"), name;
    platform::FileError error;
    auto found = [](void* context, const char* entry) { *static_cast<std::string*>(context) = entry; };
    REQUIRE(platform::list_folder(cache.c_str(), found, &name, &error));
    for (const char* made : {"cache", "cache/pocketray"})
      REQUIRE(platform::make_folder(killed.file(made).c_str(), &error));
    copy_file(cache + "/" + name, killed.file("cache/pocketray/" + name));
  };
  Sweep resumed = measure(o), never_stopped = measure(other);
  CHECK(traced + again == kPictures * kRows);
  check_same_errors(resumed, never_stopped);

  AccuracyOptions after = small(killed);
  after.rounds = 1;
  std::uint32_t left = 0;
  after.row_done = [&](std::uint32_t) { ++left; };
  check_same_errors(measure(after), never_stopped);
  CHECK(left < kPictures * kRows - 5);
  CHECK(left > kPictures * kRows - 10);
}

// Goal: sweeps share the cache's samples, adding what it lacks, and a file of their own gives the same. Method: the
// samples traced by a second sweep with the cache of the first, by one with twice as many samples, and by one with the
// first's file as --reference; the errors of all. A damaged cache is traced again.
TEST_CASE("accuracy_keeps_references_per_scene_and_camera") {
  Folder first, second, twice, named, moved;
  AccuracyOptions o = small(first);
  o.rounds = 1;
  Sweep sweep = measure(o);
  std::uint32_t traced = 0;
  auto sweep_in = [&](const Folder& folder, const std::function<void(AccuracyOptions*)>& change) {
    AccuracyOptions a = small(folder);
    a.rounds = 1, traced = 0;
    a.row_done = [&](std::uint32_t) { ++traced; };
    change(&a);
    REQUIRE(name_reference(&a).ok);
    return measure(a, first.cache());
  };
  check_same_errors(sweep_in(second, [](AccuracyOptions*) {}), sweep);
  CHECK(traced == 0);
  Sweep by_file = sweep_in(named, [&](AccuracyOptions* a) { a->reference = first.file("reference-physical.pfm"); });
  CHECK(traced == 0);
  CHECK(by_file.judge == Judge::truth);
  check_same_errors(by_file, sweep);
  Sweep more = sweep_in(twice, [](AccuracyOptions* a) { a->reference_samples = 16; });
  CHECK(traced == 2 * 24);  // of both kinds
  CHECK(more.truth.samples == 16);
  CHECK(more.truth.rmse < sweep.truth.rmse);
  sweep_in(moved, [](AccuracyOptions* a) { a->common.camera = "0,1,5 0,0,0 0,1,0 40"; });
  CHECK(traced == 2 * 24);
}

// Goal: a reference that does not fit is refused in one line. Method: that of another kind of file, camera or size.
TEST_CASE("accuracy_refuses_other_references") {
  Folder folder, other;
  AccuracyOptions o = small(folder);
  o.rounds = 1;
  measure(o);
  struct Case {
    std::function<void(AccuracyOptions*)> change;
    const char* named;
  };
  const Case cases[] = {{[](AccuracyOptions* a) { a->common.size = "24x24"; }, "size"},
                        {[](AccuracyOptions* a) { a->common.scene = "furnace"; }, "scene"},
                        {[](AccuracyOptions* a) { a->common.camera = "0,1,5 0,0,0 0,1,0 40"; }, "camera"},
                        {[](AccuracyOptions* a) { a->seconds = 2; }, "time"},
                        {[](AccuracyOptions* a) { a->common.effects = "auto,-shadow"; }, "effects"}};
  for (const Case& c : cases) {
    CAPTURE(c.named);
    AccuracyOptions changed = small(other);
    changed.reference = folder.file("reference-model.pfm"), changed.restart = true;
    REQUIRE(name_reference(&changed).ok);
    c.change(&changed);
    Sweep sweep;
    bool whole;
    std::string message = run_sweep(changed, &sweep, &whole).message;
    CAPTURE(message);
    CHECK(message.find(std::string("reference with ") + c.named) != std::string::npos);
  }
  for (const char* name : {"best", "/dev/null", "/tmp"}) {
    AccuracyOptions changed = small(other);
    changed.reference = name;
    CHECK_FALSE(name_reference(&changed).ok);
  }
}

// Goal: another sweep's measurements are not reused. Method: other options in the same folder; the message names the
// difference and the remedy; --restart starts over.
TEST_CASE("accuracy_refuses_the_state_of_another_sweep") {
  Folder folder;
  AccuracyOptions o = small(folder);
  o.rounds = 1;
  measure(o);
  struct Case {
    std::function<void(AccuracyOptions*)> change;
    const char* named;
  };
  std::vector<Case> cases = {{[](AccuracyOptions* a) { a->common.size = "24x24"; }, "size"},
                             {[](AccuracyOptions* a) { a->common.scene = "furnace"; }, "scene"},
                             {[](AccuracyOptions* a) { a->reference_samples = 16; }, "reference-samples"},
                             {[](AccuracyOptions* a) { a->reference = "model"; }, "reference"},
                             {[](AccuracyOptions* a) { a->output = "rgb888"; }, "output"},
                             {[](AccuracyOptions* a) { a->price_limit = 4; }, "configurations"}};
  for (const SettingRow& row : kSettingList)
    cases.push_back({[&row](AccuracyOptions* a) {
                       SettingOption* option = &a->common.settings[row.name];
                       option->count += 1, option->real = row.sweep.values[0];
                       if (row.field.names) option->choice = row.field.names[row.field.get(Settings()) == 1 ? 0 : 1];
                     },
                     row.name});
  for (const Case& c : cases) {
    CAPTURE(c.named);
    AccuracyOptions changed = o;
    c.change(&changed);
    Sweep sweep;
    bool whole;
    Status status = run_sweep(changed, &sweep, &whole);
    CHECK_FALSE(status.ok);
    std::string message = status.message;
    CHECK(message.find(c.named) != std::string::npos);
    CHECK(message.find("--restart") != std::string::npos);
  }
  AccuracyOptions changed = o;
  changed.common.size = "24x24", changed.restart = true;
  CHECK(measure(changed).width == 24);
}
