// bench_povray: whole frames against POV-Ray.
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "app/options.h"
#include "bench/povray/povray_run.h"
#include "bench/povray/povray_scene.h"
#include "bench/statistics.h"
#include "engine/frame.h"
#include "session/picture.h"
#include "session/report.h"

namespace pocketray {
namespace {

struct PovrayOptions {
  std::vector<std::string> sizes = {"320x240", "1280x960"};
  std::string program = "povray", folder = POCKETRAY_CACHE, json;
  int rounds = 5;
};

// A ratio is POV-Ray's CPU time over ours, both only for tracing, of frames rendered in turn.
struct FrameRow {
  std::string size;
  double povray_ns, ours_ns;  // per pixel, medians
  double ratio, ratio_low, ratio_high;
  double povray_lit, ours_lit;  // share of the pixels that are not black
  double differing;             // share of the pixels that differ visibly
};

constexpr double kRatioWanted = 8, kDifferingMax = 0.02;
constexpr int kVisibleLevels = 6;  // of 255

bool is_lit(const Vec3& c) { return srgb_level(max_component(c)) > 0; }
bool differs(const Vec3& a, const Vec3& b) {
  for (int k = 0; k < 3; ++k)
    if (std::abs(srgb_level(a[k]) - srgb_level(b[k])) > kVisibleLevels) return true;
  return false;
}

void compare(const Array<Vec3>& ours, const std::vector<Vec3>& povray, FrameRow* row) {
  double count = static_cast<double>(povray.size());
  row->ours_lit = row->povray_lit = row->differing = 0;
  for (std::size_t i = 0; i < povray.size(); ++i) {
    row->ours_lit += is_lit(ours[i]) / count;
    row->povray_lit += is_lit(povray[i]) / count;
    row->differing += differs(ours[i], povray[i]) / count;
  }
}

// Writes both pictures for inspection.
Status write_pictures(const std::string& folder, const std::vector<Vec3>& povray, Renderer* renderer) {
  std::string size = std::to_string(renderer->settings.width) + "x" + std::to_string(renderer->settings.height);
  RETURN_IF_ERROR(write_picture((folder + "/statue-" + size + "-ours.png").c_str(), PictureOptions(), renderer));
  std::vector<Vec3> ours(renderer->image.begin(), renderer->image.end());
  std::copy(povray.begin(), povray.end(), renderer->image.begin());
  renderer->memory.frame.used = 0;
  Status status = write_picture((folder + "/statue-" + size + "-povray.png").c_str(), PictureOptions(), renderer);
  std::copy(ours.begin(), ours.end(), renderer->image.begin());
  renderer->memory.frame.used = 0;
  return status;
}

Status bench_size(const std::string& size, const PovrayOptions& options, std::vector<FrameRow>* rows) {
  std::uint32_t width, height;
  RETURN_IF_ERROR(parse_size(size, &width, &height));
  PovrayScene scene;
  RETURN_IF_ERROR(open_povray_scene(width, height, &scene));
  std::string path = options.folder + "/statue-" + size + ".pov";
  RETURN_IF_ERROR(write_povray_scene(scene, path));
  Renderer* renderer = scene.renderer.get();
  PovrayPicture picture;
  std::vector<double> ours, theirs, ratios;
  double ns = 1e9 / (static_cast<double>(width) * height);
  for (int round = 0; round < options.rounds; ++round) {
    Status status = success();
    double before = thread_seconds_of([&] { status = render_frame(renderer, 0); });
    RETURN_IF_ERROR(status);
    RETURN_IF_ERROR(run_povray(options.program, path, width, height, &picture));
    double after = thread_seconds_of([&] { status = render_frame(renderer, 0); });
    RETURN_IF_ERROR(status);
    ours.push_back((before + after) / 2 * ns);
    theirs.push_back(picture.trace_seconds * ns);
    ratios.push_back(theirs.back() / ours.back());
  }
  FrameRow row = {
      size, median(&theirs), median(&ours), median(&ratios), percentile(&ratios, 0.1), percentile(&ratios, 0.9), 0, 0,
      0};
  compare(renderer->image, picture.image, &row);
  rows->push_back(row);
  return write_pictures(options.folder, picture.image, renderer);
}

void print_rows(const std::vector<FrameRow>& rows, const std::string& folder) {
  std::printf("statue, one point light with hard shadows, one thread; CPU ns per pixel of tracing\n");
  std::printf("%-9s %10s %10s %8s %19s %8s %8s %10s\n", "size", "POV-Ray", "ours", "ratio", "spread", "lit, %",
              "ours, %", "differ, %");
  for (const FrameRow& r : rows)
    std::printf("%-9s %10.0f %10.0f %8.2f   (%6.2f … %6.2f) %8.2f %8.2f %10.3f\n", r.size.c_str(), r.povray_ns,
                r.ours_ns, r.ratio, r.ratio_low, r.ratio_high, r.povray_lit * 100, r.ours_lit * 100, r.differing * 100);
  for (const FrameRow& r : rows)
    std::printf("target: %s POV-Ray / ours ≥ %.0f: %.2f, %s\n", r.size.c_str(), kRatioWanted, r.ratio,
                r.ratio >= kRatioWanted ? "reached" : "missed");
  std::printf("the pictures are %s/statue-SIZE-{ours,povray}.png\n", folder.c_str());
}

Json rows_json(const std::vector<FrameRow>& rows) {
  Json list = Json::array();
  for (const FrameRow& r : rows)
    list.push_back({{"scene", "statue"},
                    {"size", r.size},
                    {"povray_ns_per_pixel", r.povray_ns},
                    {"ours_ns_per_pixel", r.ours_ns},
                    {"ratio", r.ratio},
                    {"ratio_low", r.ratio_low},
                    {"ratio_high", r.ratio_high},
                    {"povray_lit_share", r.povray_lit},
                    {"ours_lit_share", r.ours_lit},
                    {"differing_share", r.differing}});
  return list;
}

int run(const PovrayOptions& options) {
  if (std::system(("mkdir -p '" + options.folder + "'").c_str()) != 0)
    return report(failure("cannot create %s", options.folder.c_str()));
  std::vector<FrameRow> rows;
  for (const std::string& size : options.sizes) {
    Status status = bench_size(size, options, &rows);
    if (!status.ok) return report(status);
  }
  if (options.json != "-") print_rows(rows, options.folder);
  Status status = options.json.empty() ? success() : write_json(options.json, rows_json(rows));
  for (const FrameRow& r : rows)
    if (status.ok && r.differing > kDifferingMax)
      status = failure("%s: %.2f %% of the pixels differ from POV-Ray's, more than %.0f %%: see the pictures",
                       r.size.c_str(), r.differing * 100, kDifferingMax * 100);
  return report(status);
}

}  // namespace
}  // namespace pocketray

int main(int argument_count, char** arguments) {
  using namespace pocketray;
  PovrayOptions options;
  CommandLine line(
      "bench_povray",
      "bench_povray renders the statue under one point light with hard shadows with POV-Ray and pocketray, in turn, "
      "on one thread, compares the pictures, and prints the tracing time per pixel of each.");
  Command program = line.program();
  program.example("bench_povray --size 320x240");
  program.add_option("--size WxH", options.sizes, "picture sizes").default_str("320x240 1280x960");
  program.add_option("--rounds", options.rounds, "rounds in which both render in turn")
      .range(1, 1000)
      .capture_default_str();
  program.add_option("--povray COMMAND", options.program, "POV-Ray's command").capture_default_str();
  program.add_option("--folder DIR", options.folder, "folder for the scene and the pictures").capture_default_str();
  program.add_option("--json FILE", options.json, "write the table as JSON to FILE, or - for standard output");
  ParseResult parsed = line.parse({arguments + 1, arguments + argument_count});
  if (!parsed.error.empty()) {
    std::fprintf(stderr, "%s\nRun with --help for more information.\n", parsed.error.c_str());
    return kExitUsage;
  }
  if (!parsed.help.empty()) return std::fputs(parsed.help.c_str(), stdout), kExitDone;
  return run(options);
}
