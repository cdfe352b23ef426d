// Frames in a simulated world: how soon the split settles after a change, whether it then rests, and how far from the
// best it is. Prints a table.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>
#include <vector>

#include "base/rng.h"
#include "split/merge.h"
#include "split/own_model.h"
#include "split/split_oracle.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kRows = 240, kWidth = 320, kChunkRows = 8;

struct World {
  std::vector<double> device_ns = std::vector<double>(kRows, 3e5);  // per row
  std::vector<double> bytes = std::vector<double>(kRows, 200);      // per row, compressed
  double speed[3] = {0.2, 0.2, 0.2};                                // server's time over the device's
  double ns_per_byte = 100, latency_ns = 2e6;

  double bytes_of(std::uint32_t begin, std::uint32_t end) const {
    return std::accumulate(bytes.begin() + begin, bytes.begin() + end, 0.0);
  }
  bool operator==(const World& w) const {
    return device_ns == w.device_ns && bytes == w.bytes && std::equal(speed, speed + 3, w.speed) &&
           ns_per_byte == w.ns_per_byte;
  }
};

// A frame of the world: the device from the top, every server its band from the bottom in chunks, all into a merge.
// Returns the time of the last row; reports to the model, if given, with measurements off by up to `noise`.
double play(const World& world, const Split& split, CostModel* model, double noise, Rng* rng) {
  struct Arrival {
    double ns, render_ns;
    std::uint32_t server, begin, end;
  };
  auto measured = [&](double x) { return x * (1 + noise * (2 * next_double(rng) - 1)); };
  std::vector<Arrival> arrivals;
  for (std::uint32_t s = 0; s < split.server_count; ++s) {
    double rendered = world.latency_ns, sent = 0;
    for (std::uint32_t end = split.boundary[s + 1]; end > split.boundary[s];) {
      std::uint32_t begin = std::max(split.boundary[s], end > kChunkRows ? end - kChunkRows : 0);
      double render_ns = 0;
      for (std::uint32_t r = begin; r < end; ++r) render_ns += world.device_ns[r] * world.speed[s];
      rendered += render_ns;
      sent = std::max(sent, rendered) + world.bytes_of(begin, end) * world.ns_per_byte;
      arrivals.push_back({sent, render_ns, s, begin, end});
      end = begin;
    }
  }
  std::sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) { return a.ns < b.ns; });
  std::vector<std::uint8_t> block(merge_need(kRows) + kArenaAlignment);
  Arena arena = make_arena("merge", block.data(), block.size());
  Merge merge = make_merge(kRows, &arena);
  double now = 0;
  std::size_t next = 0;
  auto receive_until = [&](double ns) {
    for (; next < arrivals.size() && arrivals[next].ns <= ns; ++next) {
      const Arrival& a = arrivals[next];
      accept_rows(&merge, 0, a.begin, a.end, a.server);
      if (is_complete(merge)) now = std::min(now, a.ns);
      if (!model) continue;
      double bytes = world.bytes_of(a.begin, a.end);
      observe_server_rows(model, a.server, a.begin, a.end, measured(a.render_ns), bytes);
      observe_transfer(model, a.server, bytes, measured(bytes * world.ns_per_byte));
    }
  };
  std::uint32_t begin, end;
  while (take_rows(&merge, 1, &begin, &end)) {
    now += world.device_ns[begin];
    if (model) observe_device_row(model, begin, measured(world.device_ns[begin]));
    receive_until(now);
    finish_rows(&merge, begin, end);
  }
  if (!is_complete(merge)) {
    now = 1e300;
    receive_until(1e300);
  }
  if (model) {
    for (std::uint32_t s = 0; s < split.server_count; ++s) observe_start(model, s, measured(world.latency_ns));
    end_frame(model);
  }
  CHECK(is_complete(merge));
  return now;
}

// The time of the best split of this world, whose true costs are known; with one server, over all splits.
double best_time(const World& world, std::uint32_t servers) {
  GeneratedProblem g;
  SplitProblem* p = &g.problem;
  p->row_count = kRows, p->server_count = servers;
  auto table = [&](double per_row, double share_of_device, double ns_per_byte = 0) {
    return make_table(&g, [&](std::uint32_t r) {
      return static_cast<std::uint64_t>(per_row + share_of_device * world.device_ns[r] + ns_per_byte * world.bytes[r]);
    });
  };
  p->device_ns = table(0, 1);
  p->unpack_ns = p->link_ns = p->device_cost = table(0, 0);
  for (std::uint32_t s = 0; s < servers; ++s) {
    ServerTables* t = &p->servers[s];
    t->usable = true, t->cost = table(1, 0);
    t->render_ns = table(0, world.speed[s]), t->transfer_ns = table(0, 0, world.ns_per_byte);
    t->start_ns = static_cast<std::uint64_t>(world.latency_ns), t->chunk_rows = kChunkRows;
  }
  OwnWorkspace own(kRows, servers);
  Rng rng = make_rng(0);
  Split split = find_split(*p, &own.workspace);
  double best = play(world, split, nullptr, 0, &rng);
  for (std::uint32_t own_rows = 0; servers == 1 && own_rows <= kRows; ++own_rows) {
    split.boundary[0] = own_rows;
    best = std::min(best, play(world, split, nullptr, 0, &rng));
  }
  return best;
}

constexpr int kChangeFrame = 40, kFrameCount = 120, kRestFrames = 60;  // kRestFrames: the last ones

struct Outcome {
  int settle_frames = 0;         // from the change until frames stay near the best
  int late_run = 0;              // longest run of frames that were not, in the last 60
  int moves_after = 0;           // changes of the split in the last 60 frames
  double worst_after = 0;        // time over the best in these frames
  double mean_ns_after = 0;      // per frame in these
  double mean_best_after = 0;    // for the best split of each
  std::uint32_t rows_moved = 0;  // largest move of a boundary in these
};

// Plays 120 frames of world(frame), the first 40 of which are in the old world.
Outcome simulate(std::uint32_t servers, double noise, const std::function<World(int)>& world_of, double near = 1.05) {
  OwnModel own(kWidth, kRows, servers);
  Rng rng = make_rng(7);
  World first = world_of(0);
  double mean = 0;
  for (double ns : first.device_ns) mean += ns / (kRows * kWidth);
  for (std::uint32_t s = 0; s < servers; ++s) {
    own.model.servers[s].connected = true;
    own.model.servers[s].chunk_rows = kChunkRows;
    double bytes_per_pixel = first.bytes_of(0, kRows) / (kRows * kWidth);
    observe_overture(&own.model, s, {mean, mean * first.speed[s], bytes_per_pixel * first.ns_per_byte}, bytes_per_pixel,
                     first.latency_ns);
  }
  Split split = own.plan();
  Outcome outcome;
  std::vector<double> excess;
  std::vector<std::pair<World, double>> best;  // the worlds met so far
  for (int frame = 0; frame < kFrameCount; ++frame) {
    World world = world_of(frame);
    Split now = next_split(make_problem(&own.model, SplitWish()), split, &own.workspace);
    bool rests = frame >= kFrameCount - kRestFrames;
    outcome.moves_after += rests && !std::equal(now.boundary, now.boundary + servers + 1, split.boundary);
    for (std::uint32_t s = 0; rests && s < servers; ++s) {
      std::uint32_t low = std::min(now.boundary[s], split.boundary[s]);
      outcome.rows_moved = std::max(outcome.rows_moved, std::max(now.boundary[s], split.boundary[s]) - low);
    }
    split = now;
    auto known = std::find_if(best.begin(), best.end(), [&](const auto& entry) { return entry.first == world; });
    if (known == best.end()) known = best.insert(best.end(), {world, best_time(world, servers)});
    double ns = play(world, split, &own.model, noise, &rng);
    excess.push_back(ns / known->second);
    if (rests) outcome.mean_ns_after += ns / kRestFrames, outcome.mean_best_after += known->second / kRestFrames;
  }
  for (int frame = kChangeFrame; frame < kFrameCount; ++frame)
    if (excess[static_cast<std::size_t>(frame)] > near) outcome.settle_frames = frame + 1 - kChangeFrame;
  int run = 0;
  for (int frame = kFrameCount - kRestFrames; frame < kFrameCount; ++frame) {
    double over = excess[static_cast<std::size_t>(frame)];
    outcome.worst_after = std::max(outcome.worst_after, over);
    run = over > near ? run + 1 : 0;
    outcome.late_run = std::max(outcome.late_run, run);
  }
  return outcome;
}

void print(const char* name, std::uint32_t servers, const Outcome& outcome) {
  std::printf("%-44s %u servers: settles in %2d frames, then %2d moves in 60 frames, at most %.1f %% over the best\n",
              name, servers, outcome.settle_frames, outcome.moves_after, 100 * (outcome.worst_after - 1));
}

// 0: equal rows. 1, 2: more expensive and longer towards the bottom or the top. 3: outdoors, a cheap sky that
// compresses to nothing, a horizon full of detail, a ground whose texture compresses badly. 4: indoors, expensive
// smooth rows and cheap ragged ones, alternating.
constexpr int kSceneKinds = 5;
constexpr int kKindStep = kEffortDivisor > 1 ? 4 : 1;  // only the first and the last
World scene_world(int kind) {
  World world;
  for (std::uint32_t r = 0; r < kRows; ++r) {
    double down = static_cast<double>(r) / kRows, ns = 3e5, bytes = 200;
    if (kind == 1) ns = 1e5 + 8e5 * down, bytes = 40 + 320 * down;
    if (kind == 2) ns = 9e5 * (1 - down) + 1e5, bytes = 360 - 320 * down;
    if (kind == 3) {
      bool sky = down < 0.4, horizon = !sky && down < 0.5;
      ns = sky ? 5e4 : horizon ? 9e5 : 2e5 + 6e5 * down;
      bytes = sky ? 8 : horizon ? 420 : 300 + 10 * (r % 7);
    }
    if (kind == 4) ns = r * 7 % 11 < 4 ? 8e5 : 1.2e5, bytes = r * 7 % 11 < 4 ? 90 : 380;
    world.device_ns[r] = ns, world.bytes[r] = bytes;
  }
  return world;
}

// The smallest mean frame time of a constant split in the last 60 frames, over the best of each frame.
double best_constant(const std::function<World(int)>& world_of) {
  Rng rng = make_rng(0);
  Split split;
  split.server_count = 1, split.boundary[1] = kRows;
  double best = 1e300;
  for (split.boundary[0] = 0; split.boundary[0] <= kRows; ++split.boundary[0]) {
    double sum = 0;
    for (int frame = kFrameCount - kRestFrames; frame < kFrameCount; ++frame)
      sum += play(world_of(frame), split, nullptr, 0, &rng);
    best = std::min(best, sum / kRestFrames);
  }
  return best;
}

}  // namespace

// Goal: in an unchanging world the split rests within 5 % of the best, with measurements 10 % off.
TEST_CASE("simulation_steady_world_split_rests") {
  for (std::uint32_t servers = 1; servers <= 3; ++servers)
    for (int kind = 0; kind < kSceneKinds; kind += kKindStep) {
      Outcome outcome = simulate(servers, 0.1, [=](int) { return scene_world(kind); });
      print("steady, measurements 10 % off", servers, outcome);
      CHECK(outcome.settle_frames == 0);
      CHECK(outcome.moves_after <= 2);
    }
}

// Goal: when a server becomes five times slower, or recovers, the split follows within 4 frames.
TEST_CASE("simulation_server_slows_fivefold_split_follows") {
  for (std::uint32_t servers = 1; servers <= 3; ++servers)
    for (double factor : {5.0, 0.2}) {
      Outcome outcome = simulate(servers, 0.05, [=](int frame) {
        World world;
        if (frame >= kChangeFrame)
          for (double& speed : world.speed) speed *= factor;
        return world;
      });
      print(factor > 1 ? "servers slow fivefold" : "servers quicken fivefold", servers, outcome);
      CHECK(outcome.settle_frames <= 4);
      CHECK(outcome.moves_after <= 2);
      CHECK(outcome.worst_after < 1.05);
    }
}

// Goal: the split follows a change of scene, with its expensive rows elsewhere, within 12 frames: to 5 % of the best,
// to 10 % with three servers, whose common boundaries cannot tell expensive rows from a slow server until they have
// moved over them.
TEST_CASE("simulation_scene_change_split_follows") {
  for (std::uint32_t servers = 1; servers <= 3; ++servers)
    for (int from = 0; from < kSceneKinds; from += kKindStep)
      for (int to = 0; to < kSceneKinds; ++to) {
        if (from == to) continue;
        double near = servers < 3 ? 1.05 : 1.1;
        Outcome outcome = simulate(
            servers, 0.05, [=](int f) { return scene_world(f < kChangeFrame ? from : to); }, near);
        if (to == 3) print("scene changes", servers, outcome);
        CHECK(outcome.settle_frames <= 12);
        CHECK(outcome.moves_after <= 3);
        CHECK(outcome.worst_after < near);
      }
}

// Hard case 61. Goal: alternating bandwidth makes the split neither oscillate nor lose much time. Method: against the
// best split of each single frame, of all 241, and against the best constant one. If bandwidth changes every frame or
// every second one, no boundary moves and frames take on average at most 5 % longer than with advance knowledge. If it
// stays for ten frames, the split follows after at most four.
TEST_CASE("hard_61_alternating_bandwidth_does_not_oscillate") {
  for (int kind = 0; kind < kSceneKinds; kind += kKindStep)
    for (int period : {1, 2, 10})
      for (double factor : {1.5, 4.0, 16.0}) {
        auto world_of = [=](int frame) {
          World world = scene_world(kind);
          world.ns_per_byte = frame / period % 2 ? 200 * factor : 200;
          return world;
        };
        Outcome o = simulate(1, 0.02, world_of);
        double constant = best_constant(world_of) / o.mean_best_after, ours = o.mean_ns_after / o.mean_best_after;
        if (factor > 4)
          std::printf(
              "rows of kind %d, bandwidth changes %4.1f-fold every %2d frames: %2d moves in 60 frames, by %3u rows at "
              "most; "
              "time %.3f of the best of each frame, the best constant split %.3f; %d late frames in a row\n",
              kind, factor, period, o.moves_after, o.rows_moved, ours, constant, o.late_run);
        INFO(kind, " ", period, " ", factor);
        CHECK(o.late_run <= 4);
        if (period > 2) continue;
        CHECK(ours <= 1.05);
        CHECK(ours <= 1.02 * constant);
        CHECK(o.moves_after <= 2);
        CHECK(o.rows_moved <= 5);
      }
}

// Goal: the split follows bandwidth that permanently falls to a tenth, or rises tenfold, whether or not it limits the
// servers: within 4 frames, within 8 if it rises and the boundary moves into rows that no server has sent yet.
TEST_CASE("simulation_bandwidth_changes_tenfold_split_follows") {
  for (std::uint32_t servers = 1; servers <= 3; ++servers)
    for (int kind = 0; kind < kSceneKinds; kind += kKindStep)
      for (double factor : {10.0, 0.1})
        for (double ns_per_byte : {100.0, 1000.0}) {
          Outcome outcome = simulate(servers, 0.05, [=](int frame) {
            World world = scene_world(kind);
            world.ns_per_byte = frame < kChangeFrame ? ns_per_byte : ns_per_byte * factor;
            return world;
          });
          if (kind == 3) print(factor > 1 ? "bandwidth falls to a tenth" : "bandwidth rises tenfold", servers, outcome);
          INFO(kind, " ", ns_per_byte);
          CHECK(outcome.settle_frames <= (factor > 1 ? 4 : 8));
          CHECK(outcome.moves_after <= 2);
          CHECK(outcome.worst_after < 1.05);
        }
}
