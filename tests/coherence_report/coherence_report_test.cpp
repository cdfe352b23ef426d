// The report of coherence on small pictures of the paper's sequence.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "desktop/coherence_report/page.h"
#include "desktop/coherence_report/plots.h"
#include "platform/file.h"
#include "present/png_file.h"
#include "scene/builtin_helpers.h"
#include "session/interrupt.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 48, kHeight = 36;
constexpr std::uint64_t kPixels = kWidth * kHeight;

struct Pair {
  std::unique_ptr<TestRenderer> whole, coherent;
  CoherencePair renderers() const { return {&whole->renderer, &coherent->renderer}; }
};

Pair make_pair(bool by_tables = false, std::uint32_t table_side = 16) {
  Settings settings;
  settings.width = kWidth, settings.height = kHeight;
  Pair pair;
  pair.whole = make_renderer(shared_builtin("seesaw")->scene, settings);
  settings.coherence = CoherenceMode::on;
  settings.coherence_by_tables = by_tables;
  settings.coherence_table = table_side;
  pair.coherent = make_renderer(shared_builtin("seesaw")->scene, settings);
  return pair;
}

SequenceRun run_frames(const Pair& pair, std::uint32_t first, std::uint32_t last) {
  SequenceRun run;
  FrameRange range = {first, last, true};
  Progress progress = start_progress("test", rendering_count(range));
  Status status = run_sequence(pair.renderers(), range, &progress, 0, &run);
  REQUIRE_MESSAGE(status.ok, status.message);
  return run;
}

// A report without rendering: 351 frames that each take a quarter of the rays and half the time, the first all.
SequenceRun invented_run(std::uint32_t frame_count) {
  SequenceRun run;
  run.width = kWidth, run.height = kHeight;
  for (std::uint32_t frame = 0; frame < frame_count; ++frame) {
    FrameFigures f;
    f.frame = frame;
    f.whole = {4000, 10, 10};
    f.coherent = frame == 0 ? RenderCost{4000, 11, 11} : RenderCost{1000, 5, 5};
    f.retraced = frame == 0 ? kPixels : kPixels / 4;
    f.changed = f.retraced / 2, f.shown = f.retraced / 4;
    f.whole_because = frame == 0 ? "no previous frame" : nullptr;
    run.frames.push_back(f);
  }
  return run;
}

CoherenceReport invented_report(std::uint32_t frame_count) {
  CoherenceReport report;
  report.scene = "seesaw", report.machine = "1 thread";
  report.is_papers_scene = true;
  report.ours = report.papers_way = invented_run(frame_count);
  return report;
}

std::uint64_t lines_of(const std::string& text) {
  return static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

// Goal: the figures are those of the frames. Method: each frame rendered again on its own, its rays and changes counted
// here; sums, pictures and order.
TEST_CASE("coherence_report_figures_are_those_of_the_frames") {
  constexpr std::uint32_t kLast = 20;  // more frames than a batch has
  Pair pair = make_pair(), again = make_pair();
  SequenceRun run = run_frames(pair, 0, kLast);
  REQUIRE(run.frames.size() == kLast + 1);
  CHECK(run.coherence_bytes > 0);
  Picture last;
  std::uint64_t rays = 0, retraced = 0;
  for (const FrameFigures& f : run.frames) {
    CAPTURE(f.frame);
    REQUIRE(render_frame(&again.whole->renderer, f.frame / 30.0).ok);
    std::uint64_t count = 0, changed = 0;
    for (std::uint64_t n : total_counts(again.whole->renderer).rays) count += n;
    const Array<Vec3>& image = again.whole->renderer.image;
    for (std::uint32_t i = 0; i < kPixels; ++i)
      changed += last.empty() || std::memcmp(&image[i], &last[i], sizeof(Vec3)) != 0;
    last.assign(image.begin(), image.end());
    CHECK(f.whole.rays == count);
    CHECK(f.changed == changed);
    CHECK(f.shown <= f.changed);
    CHECK(f.changed <= f.retraced);
    CHECK((f.whole_because != nullptr) == (f.frame == 0));
    if (f.frame > 0) CHECK(f.retraced < kPixels / 2);
    CHECK(f.whole.ms > 0);
    CHECK(f.coherent.ms > 0);
    rays += f.coherent.rays, retraced += f.retraced;
  }
  const FrameFigures all = entire(run);
  CHECK(all.coherent.rays == rays);
  CHECK(all.retraced == retraced);
  CHECK(all.coherent.rays < all.whole.rays / 2);
  CHECK(run.frames[0].coherent.rays == run.frames[0].whole.rays);
  CHECK(sum_of(run, 1, 1).whole.rays == 0);
  REQUIRE(run.pictures.size() == 3);
  CHECK(run.pictures[1].frame == 1);
  CHECK(run.pictures[2].frame == 15);
  for (const RetracedPicture& picture : run.pictures) {
    std::uint64_t colored = 0;
    for (std::uint64_t i = 0; i < kPixels; ++i)
      colored += picture.rgb[3 * i] != 0 || picture.rgb[3 * i + 1] != 0 || picture.rgb[3 * i + 2] != 0;
    CHECK(colored <= run.frames[picture.frame].retraced);
    CHECK(colored > run.frames[picture.frame].retraced / 2);
  }
}

// Goal: the paper's way is measured against its own tracer. Method: as many rays frame by frame, whole blocks retraced.
TEST_CASE("coherence_report_has_the_papers_way") {
  SequenceRun ours = run_frames(make_pair(), 0, 3), papers = run_frames(make_pair(true), 0, 3);
  CHECK(entire(papers).whole.rays == entire(ours).whole.rays);
  CHECK(entire(papers).changed == entire(ours).changed);
  CHECK(entire(papers).retraced > entire(ours).retraced);
  CHECK(papers.table_bytes > 0);
  CHECK(papers.coherence_bytes >= papers.table_bytes);
}

// Goal: a frame that differs is an error that names frame and pixel. Method: renderers with different cameras.
TEST_CASE("coherence_report_names_the_pixel_that_differs") {
  Pair pair = make_pair();
  Camera camera = pair.whole->renderer.view.camera;
  camera.eye.x += 0.5f;
  REQUIRE(set_camera(&pair.whole->renderer, camera).ok);
  SequenceRun run;
  Progress progress = start_progress("test", 1);
  Status status = run_sequence(pair.renderers(), {7, 9, true}, &progress, 0, &run);
  CHECK(!status.ok);
  CHECK(std::string(status.message).find("frame 7 differs at column ") == 0);
  CHECK(run.frames.empty());
  CHECK(run.pictures.empty());
}

// Goal: an interrupt keeps finished frames. Method: at once, and during a sequence that takes far too long.
TEST_CASE("coherence_report_keeps_frames_when_interrupted") {
  Pair pair = make_pair();
  interrupted = true;
  SequenceRun none = run_frames(pair, 0, 3);
  interrupted = false;
  CHECK(none.frames.empty());
  CHECK(none.pictures.empty());
  std::thread user([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(400 * std::min(kEffortDivisor, 10)));
    interrupted = true;
  });
  SequenceRun some = run_frames(pair, 0, 99999);
  user.join();
  interrupted = false;
  CHECK(some.frames.size() < 99999);
  for (std::size_t i = 0; i < some.frames.size(); ++i) CHECK(some.frames[i].frame == i);
  for (const RetracedPicture& picture : some.pictures) CHECK(picture.frame < some.frames.size());
}

// Goal: the table has the paper's rows, and its figures only where they may be compared. Method: the whole sequence, a
// part of it, another scene.
TEST_CASE("coherence_report_table_has_the_papers_rows") {
  std::vector<TableRow> rows = table_rows(invented_run(351), true);
  REQUIRE(rows.size() == 7);
  const char* const names[] = {"0", "1", "75", "150", "200", "350", "entire"};
  for (int i = 0; i < 7; ++i) {
    CHECK(rows[i].name == names[i]);
    CHECK(rows[i].paper != nullptr);
  }
  CHECK(rows[2].paper->rays == 0.4765);
  CHECK(rows[6].paper->time == 0.2672);
  CHECK(rows[6].pixels == 351 * kPixels);
  CHECK(rows[6].figures.whole.rays == 351 * 4000);
  for (const TableRow& row : table_rows(invented_run(351), false)) CHECK(row.paper == nullptr);
  rows = table_rows(invented_run(80), true);
  REQUIRE(rows.size() == 4);
  CHECK(rows[3].paper == nullptr);
  SequenceRun part = invented_run(80);
  part.frames.erase(part.frames.begin(), part.frames.begin() + 75);
  rows = table_rows(part, true);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].name == "75");
  CHECK(rows[0].paper == nullptr);  // the first frame is traced whole here, not there
}

// Goal: JSON and CSV have every figure. Method: invented ones, with known ratios.
TEST_CASE("coherence_report_files_have_the_figures") {
  CoherenceReport report = invented_report(5);
  report.ours.frames[2].whole_because = report.ours.frames[3].whole_because = "lights, \"all\"";
  Json json = report_json(report);
  CHECK(json["rays"].get<double>() == doctest::Approx(8000.0 / 20000));
  CHECK(json["time"].get<double>() == doctest::Approx(31.0 / 50));
  CHECK(json["cpu_time"].get<double>() == doctest::Approx(31.0 / 50));
  CHECK(json["frame0"].get<double>() == doctest::Approx(1.1));
  CHECK(json["retraced"].get<double>() == doctest::Approx(2.0 / 5));
  CHECK(json["changed"].get<double>() == doctest::Approx(1.0 / 5));
  CHECK(json["entire"]["retraced"] == 2 * kPixels);
  CHECK(json["after_first"]["retraced"] == kPixels);
  CHECK(json["frames"].size() == 5);
  CHECK(json["papers_way"]["rays"] == json["rays"]);
  CHECK(json["paper"]["rays"] == 0.1935);
  CHECK(json["settings"]["coherence_table"] == 16);
  CHECK(json["memory"].contains("coherence_bytes"));
  report.is_papers_scene = false;
  report.papers_way = SequenceRun();
  CHECK(report_json(report)["paper"].is_null());
  CHECK(report_json(report)["papers_way"].is_null());
  std::string csv = frames_csv(report.ours);
  CHECK(lines_of(csv) == 6);
  CHECK(csv.find("\n1,4000,1000,10,5,10,5,") != std::string::npos);
  CHECK(csv.find("\"lights, \"\"all\"\"\"\n") != std::string::npos);
  std::vector<std::string> whole = whole_frames(report.ours);
  REQUIRE(whole.size() == 2);
  CHECK(whole[0] == "frame 0: no previous frame");
  CHECK(whole[1] == "frames 2 to 3: lights, \"all\"");
}

// Goal: the folder has the page and what it names. Method: a real run of a few frames, and plots of one frame.
TEST_CASE("coherence_report_folder_is_complete") {
  CoherenceReport report = invented_report(1);
  CHECK(rays_plot(report).script.find("Table 2") != std::string::npos);
  CHECK(time_plot(report).script.find("$series") != std::string::npos);
  report.ours = run_frames(make_pair(), 0, 1);
  char folder[] = "/tmp/pocketray_XXXXXX";
  REQUIRE(mkdtemp(folder) != nullptr);
  bool drawn;
  Status status = write_coherence_report(folder, report, &drawn);
  CHECK_MESSAGE(status.ok, status.message);
  std::vector<std::string> names = {"index.html",   "report.json", "frames.csv", "frames_papers_way.csv",
                                    "rays.gnuplot", "time.gnuplot"};
  names.insert(names.end(), {"retraced-0000.png", "retraced-0001.png"});
  if (drawn) names.insert(names.end(), {"rays.png", "time.svg"});
  for (const std::string& name : names) {
    CAPTURE(name);
    platform::LoadedFile file;
    platform::FileError error;
    REQUIRE(platform::load_file((std::string(folder) + "/" + name).c_str(), &file, &error));
    CHECK(file.byte_count > 100);
    if (name == "index.html")
      CHECK(std::string(reinterpret_cast<const char*>(file.bytes), file.byte_count).find("</html>") !=
            std::string::npos);
    platform::unload_file(&file);
  }
  platform::remove_folder(folder);
}

// Goal: the side of the tables trades memory for pixels, never a picture. Method: the paper's way with three sides,
// each of whose frames is compared with whole frames; memory as in the paper, a bit for each block in each voxel.
TEST_CASE("coherence_report_sides_of_tables_trade_memory_for_pixels") {
  TableSweep sweep;
  sweep.papers_way = true;
  for (std::uint32_t side : {1, 8, 32}) {
    Pair pair = make_pair(true, side);
    sweep.sides.push_back(table_side(side, run_frames(pair, 0, 3)));
  }
  REQUIRE(sweep.sides.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const TableSide& s = sweep.sides[i];
    CAPTURE(s.side);
    CHECK(s.pixels == 4 * kPixels);
    CHECK(s.all.retraced >= s.all.changed);
    CHECK(s.all.changed == sweep.sides[0].all.changed);
    CHECK(s.table_bytes == std::size_t(4096) * std::max(4u, s.side * s.side / 8));
    CHECK(s.coherence_bytes > s.table_bytes);
    if (i > 0) CHECK(s.all.retraced < sweep.sides[i - 1].all.retraced);
  }
  CHECK(sweep.sides[0].all.retraced == 4 * kPixels);  // one block: any change is one of all pixels
  const Json json = table_sweep_json(sweep);
  REQUIRE(json["sides"].size() == 3);
  CHECK(json["sides"][0]["retraced"] == 1);
  CHECK(json["sides"][2]["table_bytes"] == sweep.sides[2].table_bytes);
  CHECK(json["papers_way"] == true);
  CHECK(json["sides"][1]["cpu_time"].get<double>() > 0);
  CHECK(lines_of(table_sweep_csv(sweep)) == 4);
  CHECK(table_sweep_csv(sweep).find("\n1,16384,") != std::string::npos);
  CHECK(table_sweep_markup(sweep).find("32 × 32") != std::string::npos);
  CHECK(table_plot(sweep).script.find("\"32\\n512K\" 32") != std::string::npos);
  CHECK(table_sweep_json(TableSweep()).is_null());
}
