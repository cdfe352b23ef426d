#include "bench/duel.h"

#include <time.h>

#include <algorithm>
#include <cmath>

namespace pocketray {
namespace {

struct Answers {
  std::vector<Hit> hits;
  std::vector<unsigned char> occluded;
};

void trace_ours(const OurSide& ours, const RaySet& set, Answers* answers) {
  switch (set.kind) {
    case RayKindOfBench::primary:
      return trace_primary_ours(ours, set, &answers->hits);
    case RayKindOfBench::bounce:
      return trace_bounce_ours(ours, set, &answers->hits);
    case RayKindOfBench::shadow:
      return trace_shadow_ours(ours, set, &answers->occluded);
  }
}

bool same_hit(const Hit& a, const Hit& b) {
  if (a.triangle == kNoTriangle || b.triangle == kNoTriangle) return a.triangle == b.triangle;
  return std::fabs(a.t - b.t) <= kSameHit * std::fabs(a.t);
}

double differing_share(const Answers& ours, const EmbreeTask& task, const RaySet& set) {
  std::size_t differing = 0;
  if (set.kind == RayKindOfBench::shadow) {
    for (std::size_t i = 0; i < set.rays.size(); ++i) differing += ours.occluded[i] != task.occluded[i];
  } else {
    std::vector<Hit> theirs = embree_hits(task);
    for (std::size_t i = 0; i < set.rays.size(); ++i) differing += !same_hit(ours.hits[i], theirs[i]);
  }
  return static_cast<double>(differing) / static_cast<double>(set.rays.size());
}

template <class Function>
double seconds_of(Function function) {
  double start = thread_seconds();
  function();
  return thread_seconds() - start;
}

}  // namespace

double thread_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

double percentile(std::vector<double>* values, double share) {
  std::sort(values->begin(), values->end());
  double place = share * static_cast<double>(values->size() - 1);
  std::size_t below = static_cast<std::size_t>(place), above = std::min(below + 1, values->size() - 1);
  return (*values)[below] + ((*values)[above] - (*values)[below]) * (place - static_cast<double>(below));
}

std::vector<DuelRow> duel(const BenchScene& scene, const std::string& isa, const OurSide& ours, EmbreeSide* embree,
                          const RaySet& set, int rounds) {
  std::vector<DuelRow> rows;
  if (set.rays.empty()) return rows;
  Answers answers;
  answers.hits.resize(set.rays.size());
  answers.occluded.resize(set.rays.size());
  trace_ours(ours, set, &answers);
  std::vector<EmbreeTask> tasks;
  std::vector<double> differing;
  for (const EmbreeMode& mode : embree_modes(set.kind, isa)) {
    tasks.push_back(make_embree_task(embree, mode, set));
    trace_embree(&tasks.back());
    differing.push_back(differing_share(answers, tasks.back(), set));
  }
  std::vector<std::vector<double>> ratios(tasks.size()), theirs(tasks.size());
  std::vector<double> our_seconds;
  for (int round = 0; round < rounds; ++round) {
    our_seconds.push_back(seconds_of([&] { trace_ours(ours, set, &answers); }));
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      double before = our_seconds.back();
      theirs[i].push_back(seconds_of([&] { trace_embree(&tasks[i]); }));
      our_seconds.push_back(seconds_of([&] { trace_ours(ours, set, &answers); }));
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
