#include "bench/duel.h"

#include <cmath>

#include "bench/statistics.h"

namespace pocketray {
namespace {

bool same_hit(const Hit& a, const Hit& b) {
  if (a.triangle == kNoTriangle || b.triangle == kNoTriangle) return a.triangle == b.triangle;
  return std::fabs(a.t - b.t) <= kSameHit * std::fabs(a.t);
}

double differing_share(const OurTask& ours, const EmbreeTask& task, const RaySet& set) {
  std::size_t differing = 0;
  if (set.kind == RayKindOfBench::shadow) {
    std::vector<bool> occluded = occlusion_of(ours);
    for (std::size_t i = 0; i < set.rays.size(); ++i) differing += occluded[i] != (task.occluded[i] != 0);
  } else {
    std::vector<Hit> theirs = embree_hits(task);
    for (std::size_t i = 0; i < set.rays.size(); ++i) differing += !same_hit(ours.hits[i], theirs[i]);
  }
  return static_cast<double>(differing) / static_cast<double>(set.rays.size());
}

}  // namespace

std::vector<DuelRow> duel(const BenchScene& scene, const std::string& isa, const OurSide& ours, EmbreeSide* embree,
                          const RaySet& set, int rounds) {
  std::vector<DuelRow> rows;
  if (set.rays.empty()) return rows;
  OurTask our_task = make_our_task(ours, set);
  trace_ours(&our_task);
  std::vector<EmbreeTask> tasks;
  std::vector<double> differing;
  for (const EmbreeMode& mode : embree_modes(set.kind, isa)) {
    tasks.push_back(make_embree_task(embree, mode, set));
    trace_embree(&tasks.back());
    differing.push_back(differing_share(our_task, tasks.back(), set));
  }
  std::vector<std::vector<double>> ratios(tasks.size()), theirs(tasks.size());
  std::vector<double> our_seconds;
  for (int round = 0; round < rounds; ++round) {
    our_seconds.push_back(thread_seconds_of([&] { trace_ours(&our_task); }));
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      double before = our_seconds.back();
      theirs[i].push_back(thread_seconds_of([&] { trace_embree(&tasks[i]); }));
      our_seconds.push_back(thread_seconds_of([&] { trace_ours(&our_task); }));
      ratios[i].push_back(theirs[i].back() / ((before + our_seconds.back()) / 2));
    }
  }
  double million = static_cast<double>(set.rays.size()) * 1e-6;
  for (std::size_t i = 0; i < tasks.size(); ++i)
    rows.push_back({scene.name, kBenchRayNames[static_cast<int>(set.kind)], set.size(), isa, mode_name(tasks[i].mode),
                    million / percentile(&our_seconds, 0.5), million / percentile(&theirs[i], 0.5),
                    percentile(&ratios[i], 0.5), percentile(&ratios[i], 0.1), percentile(&ratios[i], 0.9),
                    differing[i]});
  return rows;
}

}  // namespace pocketray
