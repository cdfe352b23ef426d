// The project's targets against Embree, each over every measured scene.
#include <algorithm>
#include <cstdio>
#include <functional>

#include "bench/build_report.h"

namespace pocketray {
namespace {

struct Figures {
  const std::vector<DuelRow>& duels;
  const std::vector<BuildRow>& builds;
};
constexpr double kNotMeasured = -1;

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

// The smallest ratio of the scene for a kind of rays (empty: any), at all sizes and modes with the given prefix.
double least_ratio(const Figures& f, const std::string& scene, const char* isa, const std::string& rays,
                   const char* mode) {
  double least = kNotMeasured;
  for (const DuelRow& row : f.duels)
    if (row.scene == scene && row.isa == isa && (rays.empty() || row.rays == rays) &&
        starts_with(row.embree_mode, mode) && (least == kNotMeasured || row.ratio < least))
      least = row.ratio;
  return least;
}

const BuildRow* find_build(const Figures& f, const std::string& scene, const std::string& builder) {
  for (const BuildRow& row : f.builds)
    if (row.scene == scene && row.builder == builder) return &row;
  return nullptr;
}
// Our default accelerator, and the next, the compact one.
const BuildRow* find_ours(const Figures& f, const std::string& scene, int index) {
  for (const BuildRow& row : f.builds)
    if (row.scene == scene && !starts_with(row.builder, "embree") && index-- == 0) return &row;
  return nullptr;
}
double bytes_per_triangle(const BuildRow* row) {
  return row ? row->accel_bytes_per_triangle + row->mesh_bytes_per_triangle : kNotMeasured;
}

using Measure = std::function<double(const Figures&, const std::string& scene)>;

struct Target {
  const char* text;
  bool at_least;
  double bound;
  Measure measure;
};

Measure ratio(const char* isa, const char* rays, const char* mode) {
  return [=](const Figures& f, const std::string& scene) { return least_ratio(f, scene, isa, rays, mode); };
}

double build_ratio(const Figures& f, const std::string& scene) {
  const BuildRow *ours = find_ours(f, scene, 0), *theirs = find_build(f, scene, "embree robust medium");
  return ours && theirs ? ours->build_ms / theirs->build_ms : kNotMeasured;
}
double refit_share(const Figures& f, const std::string& scene) {
  const BuildRow* ours = find_ours(f, scene, 0);
  return ours && ours->refit_ms >= 0 ? ours->refit_ms / ours->build_ms : kNotMeasured;
}
double thread_ratio(const Figures& f, const std::string& scene) {
  const BuildRow* ours = find_ours(f, scene, 0);
  return ours ? ours->two_threads : kNotMeasured;
}
double compact_speed(const Figures& f, const std::string& scene) {
  const BuildRow* compact = find_ours(f, scene, 1);
  return compact ? *std::min_element(compact->speed, compact->speed + 3) : kNotMeasured;
}

const std::vector<Target>& targets() {
  static const std::vector<Target> list = {
      {"SSE2 primary / fastest mode", true, 1.8, ratio("sse2", "primary", "")},
      {"SSE2 shadow / robust single", true, 1.2, ratio("sse2", "shadow", "single robust medium")},
      {"SSE2 bounce / robust single", true, 1.0, ratio("sse2", "bounce", "single robust medium")},
      {"native primary / fastest mode", true, 0.9, ratio("native", "primary", "")},
      {"native primary / fastest single", true, 1.5, ratio("native", "primary", "single")},
      {"native shadow / robust single", true, 1.0, ratio("native", "shadow", "single robust medium")},
      {"native bounce / robust single", true, 0.9, ratio("native", "bounce", "single robust medium")},
      {"SSE2 any rays / single high", true, 1.0, ratio("sse2", "", "single fast high")},
      {"native any rays / single high", true, 1.0, ratio("native", "", "single fast high")},
      {"bytes per triangle", false, 72,
       [](const Figures& f, const std::string& s) { return bytes_per_triangle(find_ours(f, s, 0)); }},
      {"bytes per triangle, compact", false, 44,
       [](const Figures& f, const std::string& s) { return bytes_per_triangle(find_ours(f, s, 1)); }},
      {"compact / default, any rays", true, 0.85, compact_speed},
      {"build / Embree's medium", false, 2.0, build_ratio},
      {"refit / build", false, 0.1, refit_share},
      {"two threads / one", true, 1.9, thread_ratio}};
  return list;
}

void print_verdict(const Target& target, const Figures& figures, const std::vector<std::string>& scenes) {
  std::printf("%-32s %s %5.2f", target.text, target.at_least ? "≥" : "≤", target.bound);
  int measured = 0, reached = 0;
  for (const std::string& scene : scenes) {
    double value = target.measure(figures, scene);
    if (value < 0) {
      std::printf(" %10s", "-");
      continue;
    }
    std::printf(" %10.2f", value);
    ++measured;
    reached += target.at_least ? value >= target.bound : value <= target.bound;
  }
  if (measured == 0)
    std::printf("  not measured\n");
  else if (reached == measured)
    std::printf("  reached\n");
  else
    std::printf("  missed on %d of %d\n", measured - reached, measured);
}

}  // namespace

void print_verdicts(const std::vector<DuelRow>& duels, const std::vector<BuildRow>& builds) {
  std::vector<std::string> scenes;
  for (const DuelRow& row : duels)
    if (std::find(scenes.begin(), scenes.end(), row.scene) == scenes.end()) scenes.push_back(row.scene);
  std::printf("\ntargets: ours against Embree's, smallest over all picture sizes\n%-40s", "");
  for (const std::string& scene : scenes) std::printf(" %10.10s", scene.c_str());
  std::printf("\n");
  for (const Target& target : targets()) print_verdict(target, {duels, builds}, scenes);
}

}  // namespace pocketray
