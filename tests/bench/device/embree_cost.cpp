// embree_cost SCENE SIZE KIND SIDE ROUNDS: traces the rays of a kind ROUNDS times through the accelerator (SIDE "ours")
// or through a mode of Embree ("single fast medium"), and prints how many rays that is each time. Without SIDE and
// ROUNDS, it prints the modes for the kind. embree_cost.py counts the instructions.
#include <cstdio>
#include <cstdlib>

#include "accel/accel_list.h"
#include "bench/embree_side.h"
#include "bench/ray_sets.h"

namespace pocketray {
namespace {

int fail(const char* what) {
  std::fprintf(stderr, "embree_cost: %s\n", what);
  return 1;
}

int find_kind(const std::string& name) {
  for (int kind = 0; kind < 3; ++kind)
    if (name == kBenchRayNames[kind]) return kind;
  return -1;
}

int trace(const std::vector<std::string>& arguments) {
  const int kind = find_kind(arguments[2]);
  if (kind < 0) return fail("the kind is primary, shadow or bounce");
  const std::vector<EmbreeMode> modes = embree_modes(static_cast<RayKindOfBench>(kind), "sse2");
  if (arguments.size() < 5) {
    for (const EmbreeMode& mode : modes) std::printf("%s\n", mode_name(mode).c_str());
    return 0;
  }
  BenchScene scene;
  bool found;
  std::vector<RaySet> sets;
  Status status = load_bench_scene(arguments[0], "", "", &scene, &found);
  if (!status.ok) return fail(status.message);
  const OurSide ours = build_ours(scene, kAccelList[0]);
  status = make_ray_sets(scene, arguments[1], {arguments[2]}, ours, &sets);
  if (!status.ok) return fail(status.message);
  const int rounds = std::atoi(arguments[4].c_str());
  std::printf("%zu\n", sets[0].rays.size());
  if (arguments[3] == "ours") {
    OurTask task = make_our_task(ours, sets[0]);
    for (int i = 0; i < rounds; ++i) trace_ours(&task);
    return 0;
  }
  EmbreeSide embree(scene, "native");
  for (const EmbreeMode& mode : modes)
    if (mode_name(mode) == arguments[3]) {
      EmbreeTask task = make_embree_task(&embree, mode, sets[0]);
      for (int i = 0; i < rounds; ++i) trace_embree(&task);
      return 0;
    }
  return fail("no such side");
}

}  // namespace
}  // namespace pocketray

int main(int argument_count, char** arguments) {
  if (argument_count != 4 && argument_count != 6) return 2;
  return pocketray::trace({arguments + 1, arguments + argument_count});
}
