// Loops over the threads of a renderer.
#include <doctest/doctest.h>

#include <atomic>
#include <string>
#include <vector>

#include "base/rng.h"
#include "engine/workers.h"
#include "scene/baked.h"
#include "scene/baked_file.h"

using namespace pocketray;

// Goal: every item is taken once, with any number of threads. Method: counters, for few and many items.
TEST_CASE("parallel_loop_takes_every_item_once") {
  for (std::uint32_t thread_count : {1u, 2u, 5u}) {
    Workers* workers = start_workers(thread_count);
    for (std::uint32_t count : {0u, 1u, 2u, 3u, 100u, 5000u}) {
      std::vector<std::atomic<int>> taken(count + 1);
      auto take = [&](std::uint32_t item) { ++taken[item]; };
      run_loop(loop_over(workers), count, take);
      for (std::uint32_t i = 0; i < count; ++i) CHECK(taken[i] == 1);
      CHECK(taken[count] == 0);
    }
    stop_workers(workers);
  }
}

// Goal: a file is opened or refused alike with any number of threads. Method: a scene of many blocks, sound and with
// one byte changed in a block at the beginning, in the middle and at the end.
TEST_CASE("parallel_loop_opens_and_refuses_files_alike") {
  Rng rng = make_rng(801);
  std::vector<Vec3> positions(100000);
  for (Vec3& p : positions) p = {next_float(&rng), next_float(&rng), next_float(&rng)};
  Scene scene;
  scene.positions = {positions.data(), static_cast<std::uint32_t>(positions.size())};
  const BakedFile file = bake(scene);
  for (std::uint32_t thread_count : {1u, 3u}) {
    Workers* workers = start_workers(thread_count);
    Scene opened;
    CHECK(baked_open(file.data(), file.size(), &opened, loop_over(workers)).ok);
    CHECK(opened.positions.count == positions.size());
    for (std::size_t at : {std::size_t(5000), file.size() / 2, file.size() - 100}) {
      file.data()[at] ^= 4;
      const Status status = baked_open(file.data(), file.size(), &opened, loop_over(workers));
      CHECK(std::string(status.message) == "damaged, its checksum does not match: copy or bake it again");
      file.data()[at] ^= 4;
    }
    stop_workers(workers);
  }
}
