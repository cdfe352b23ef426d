#include "simulate_frames.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <deque>

#include "engine/frame.h"
#include "session/picture.h"
#include "session/scene_options.h"
#include "session/sequence_share.h"
#include "session/servers.h"

namespace pocketray {
namespace {

constexpr std::size_t kFramesAheadMax = 16, kShareOfLeft = 8;  // as render_team.cpp has them
constexpr double kLatencySeconds = 100e-6, kWaitSeconds = 0.05;

// Seconds of CPU time.
struct Costs {
  std::vector<double> next, jump;  // of a frame with its file: after the one before it, and after a distant one
  double open = 0;
};

double now_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Status measure_frame(double seconds, const char* file, Renderer* renderer, double* cost) {
  PictureOptions picture;
  picture.kind = file;
  bool complete;
  const double start = now_seconds();
  RETURN_IF_ERROR(render_frame(renderer, changes_at(seconds), &complete));
  RETURN_IF_ERROR(write_picture(file, picture, renderer));
  *cost = now_seconds() - start;
  return success();
}

Status measure_costs(const std::string& scene, std::uint32_t count, const char* file, Costs* costs) {
  CommonOptions options;
  options.scene = scene, options.threads = 1, options.coherence = "on";
  OpenScene opened;
  const double start = now_seconds();
  RETURN_IF_ERROR(open_scene_with(
      nullptr, options, [](const Settings& settings) { return picture_bytes(settings); }, &opened));
  costs->open = now_seconds() - start;
  Renderer* renderer = &opened.renderer;
  const double rate = static_cast<double>(renderer->scene.info.frames_per_second);
  costs->next.resize(count), costs->jump.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) RETURN_IF_ERROR(measure_frame(i / rate, file, renderer, &costs->next[i]));
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t distant = i / 2 + (i % 2) * (count / 2);
    RETURN_IF_ERROR(measure_frame(distant / rate, file, renderer, &costs->jump[distant % count]));
  }
  std::remove(file);
  return success();
}

struct Rank {
  std::deque<double> ends;  // of the frames that it has; the leader hears of each a little later
  std::uint32_t last = 0;
  bool began = false;
};

double cost_of(const Costs& costs, std::uint32_t frame, Rank* rank) {
  const bool is_next = rank->began && frame == rank->last + 1;
  rank->began = true, rank->last = frame;
  return is_next ? costs.next[frame] : std::max(costs.next[frame], costs.jump[frame]);
}

double seconds_of(const Costs& costs, std::uint32_t rank_count) {
  std::vector<std::uint32_t> frames;
  for (std::uint32_t i = 0; i < costs.next.size(); ++i) frames.push_back(i);
  SequenceShare share(frames, rank_count);
  std::vector<Rank> ranks(rank_count);
  double now = costs.open;
  for (;;) {
    double first = now + kWaitSeconds;
    bool is_busy = false;
    for (std::uint32_t rank = 1; rank < rank_count; ++rank) {
      std::deque<double>& ends = ranks[rank].ends;
      const double free = std::max(ends.empty() ? now : ends.back(), now);
      while (!ends.empty() && ends.front() + kLatencySeconds <= now) ends.pop_front();
      const std::size_t ahead = std::min(kFramesAheadMax, share.left() / (kShareOfLeft * rank_count) + 1);
      double end = free + kLatencySeconds;
      if (ends.size() <= ahead)
        for (std::uint32_t frame : share.take(rank, static_cast<std::uint32_t>(ahead + 1 - ends.size())))
          ends.push_back(end += cost_of(costs, frame, &ranks[rank]));
      is_busy = is_busy || !ends.empty();
      if (!ends.empty()) first = std::min(first, ends.front() + kLatencySeconds);
    }
    const std::vector<std::uint32_t> own = share.take(0, 1);
    if (own.empty() && !is_busy) return now;
    now = own.empty() ? std::max(now, first) : now + cost_of(costs, own[0], &ranks[0]);
  }
}

}  // namespace

Status simulate_frames(const std::string& scene, std::uint32_t frame_count, const std::string& file) {
  Costs costs;
  RETURN_IF_ERROR(measure_costs(scene, frame_count, file.c_str(), &costs));
  double next = 0, jump = 0;
  for (std::uint32_t i = 0; i < frame_count; ++i)
    next += costs.next[i] / frame_count, jump += costs.jump[i] / frame_count;
  const double alone = seconds_of(costs, 1);
  std::printf("%s: opening %.2f s, a frame and its file %.1f ms after the one before, %.1f ms after another\n",
              scene.c_str(), costs.open, 1e3 * next, 1e3 * jump);
  std::printf("%u frames: %.1f s alone\n ", frame_count, alone);
  for (std::uint32_t ranks : {2u, 4u, 8u, 16u, 32u, 64u})
    std::printf(" %u ranks %.1f×", ranks, alone / seconds_of(costs, ranks));
  std::printf("\n");
  return success();
}

}  // namespace pocketray
