#include "bench/build_bench.h"

#include <functional>
#include <thread>

#include "accel/accel_list.h"
#include "bench/statistics.h"
#include "engine/frame.h"

namespace pocketray {
namespace {

constexpr EmbreeMode kBuilds[] = {
    {1, true, EmbreeBuild::medium}, {1, true, EmbreeBuild::compact}, {1, false, EmbreeBuild::high}};

double per_triangle(const Scene& scene, std::size_t bytes) {
  return static_cast<double>(bytes) / static_cast<double>(scene.triangles.count);
}

// Measures one build; the structures are not kept.
BuildRow our_row(const BenchScene& scene, const AccelInfo* info) {
  BuildRow row;
  row.scene = scene.name, row.builder = info->name, row.triangles = scene.scene().triangles.count;
  OurSide ours = build_ours(scene, info);
  row.accel_bytes_per_triangle = per_triangle(scene.scene(), ours.accel.data.bytes());
  row.mesh_bytes_per_triangle =
      per_triangle(scene.scene(), scene.scene().positions.bytes() + scene.scene().triangles.bytes());
  return row;
}

BuildRow embree_row(const BenchScene& scene, EmbreeSide* embree, const EmbreeMode& mode) {
  BuildRow row;
  row.scene = scene.name, row.triangles = scene.scene().triangles.count;
  row.builder =
      std::string("embree ") + (mode.robust ? "robust " : "fast ") + kEmbreeBuildNames[static_cast<int>(mode.build)];
  std::size_t before = embree->bytes();
  RTCScene built = embree->build(mode);
  row.accel_bytes_per_triangle = per_triangle(scene.scene(), embree->bytes() - before);
  rtcReleaseScene(built);
  row.mesh_bytes_per_triangle =
      per_triangle(scene.scene(), sizeof(Vec3) * scene.scene().positions.count) + 3 * sizeof(std::uint32_t);
  return row;
}

double refit_ms(const BenchScene& scene, const AccelInfo* info, int rounds) {
  if (!info->refit) return -1;
  OurSide ours = build_ours(scene, info);
  Array<std::uint8_t> data = {const_cast<std::uint8_t*>(ours.accel.data.data), ours.accel.data.count};  // our block
  std::vector<double> seconds;
  for (int round = 0; round <= rounds; ++round)
    seconds.push_back(thread_seconds_of([&] { info->refit(&ours.accel, data); }));
  return median(&seconds) * 1e3;
}

// Each thread takes every other row of tiles. Counts half the CPU time of both: the wall-clock time if both cores are
// free and rows go to whichever thread is free, as in the renderer. Compares the fastest rounds.
double two_threads(const OurSide& ours, const RaySet& primary, int rounds) {
  constexpr int kRoundsMore = 4;  // the rounds are short
  OurTask task = make_our_task(ours, primary);
  std::size_t row_size = primary.width / kRayTileSide, row_count = primary.height / kRayTileSide;
  auto trace_rows = [&](std::size_t first, std::size_t step) {
    auto trace = [&] {
      for (std::size_t row = first; row < row_count; row += step) trace_tiles_ours(&task, row * row_size, row_size);
    };
    trace();  // warm-up frame for this core's caches
    return thread_seconds_of(trace);
  };
  double one = __builtin_inf(), two = __builtin_inf();
  for (int round = 0; round < rounds * kRoundsMore; ++round) {
    one = std::min(one, trace_rows(0, 1));
    double second = 0;
    std::thread other([&] { second = trace_rows(1, 2); });
    double first = trace_rows(0, 2);
    other.join();
    two = std::min(two, (first + second) / 2);
  }
  return one / two;
}

double speed_against(const OurSide& reference, const OurSide& ours, const RaySet& set, int rounds) {
  OurTask reference_task = make_our_task(reference, set), task = make_our_task(ours, set);
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round) {
    double theirs = thread_seconds_of([&] { trace_ours(&reference_task); });
    ratios.push_back(theirs / thread_seconds_of([&] { trace_ours(&task); }));
  }
  return median(&ratios);
}

double frame_ns_per_pixel(BenchScene* scene, int rounds) {
  Renderer* renderer = scene->renderer.get();
  if (!build_renderer(renderer).ok) return -1;
  std::vector<double> ns;
  for (int round = 0; round < rounds; ++round) {
    bool ok = false;
    double seconds = thread_seconds_of([&] { ok = render_frame(renderer, 0).ok; });
    if (!ok) return -1;
    ns.push_back(seconds * 1e9 / (static_cast<double>(renderer->settings.width) * renderer->settings.height));
  }
  return median(&ns);
}

void time_builds(std::vector<BuildRow>* rows, const std::vector<std::function<void()>>& builds, int rounds) {
  std::vector<std::vector<double>> seconds(builds.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < builds.size(); ++i)
      seconds[i].push_back(seconds_of(CLOCK_PROCESS_CPUTIME_ID, builds[i]));
  for (std::size_t i = 0; i < builds.size(); ++i) (*rows)[i].build_ms = median(&seconds[i]) * 1e3;
}

}  // namespace

std::vector<BuildRow> bench_builds(BenchScene* scene, EmbreeSide* embree, const std::vector<RaySet>& sets, int rounds) {
  std::vector<BuildRow> rows;
  std::vector<std::function<void()>> builds;
  OurSide reference = build_ours(*scene, kAccelList[0]);
  for (const AccelInfo* info : kAccelList) {
    if (info == &kBruteAccel) continue;
    BuildRow row = our_row(*scene, info);
    row.refit_ms = refit_ms(*scene, info, rounds);
    OurSide ours = build_ours(*scene, info);
    for (const RaySet& set : sets) {
      if (set.kind == RayKindOfBench::primary) row.two_threads = two_threads(ours, set, rounds);
      if (!set.rays.empty() && info != kAccelList[0])
        row.speed[static_cast<int>(set.kind)] = speed_against(reference, ours, set, rounds);
    }
    rows.push_back(row);
    builds.push_back([scene, info] { build_ours(*scene, info); });
  }
  for (const EmbreeMode& mode : kBuilds) {
    rows.push_back(embree_row(*scene, embree, mode));
    builds.push_back([embree, mode] { rtcReleaseScene(embree->build(mode)); });
  }
  time_builds(&rows, builds, rounds);
  rows[0].frame_ns_per_pixel = frame_ns_per_pixel(scene, rounds);
  return rows;
}

}  // namespace pocketray
