// simulate_serve [SCENE [SAMPLES]] : how much sooner a client has its frames from a server on 2 … 64 ranks. Measures on
// this machine what strips of 320 × 240 pixels, the preparation of a frame and the coding of rows cost, and plays rank
// 0 and its helpers on a virtual clock; rows are given out by the code that gives them out in earnest. Each rank has
// one thread. Rank 0 is reached by 1 Gbit/s Ethernet, on which rows queue up; the client takes rows as they come.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <string>

#include "base/check.h"
#include "remote/cluster/pieces.h"
#include "session/report.h"
#include "session/source.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 320, kHeight = 240, kStrip = 8, kHalfStrip = 4;
constexpr double kBytesPerSecond = 125e6, kLatencySeconds = 100e-6;
// Of rank 0 for each answer and for each message to a helper; measured with Open MPI on one machine.
constexpr double kTakeSeconds = 15e-6, kGiveSeconds = 5e-6;
constexpr double kLookSeconds = 100e-6;  // until a helper that waits sees a message

struct Costs {
  std::vector<double> strip, half_strip;  // with packing
  double prepare = 0, encode_row = 0;
};

double now_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// The least of five measurements.
template <class Work>
double least_seconds(Work&& work) {
  double least = 1e30;
  for (int i = 0; i < 5; ++i) {
    const double start = now_seconds();
    work();
    least = std::min(least, now_seconds() - start);
  }
  return least;
}

Status prepare(Session* session, const StoredScene& scene, const FrameRequest& request) {
  session->job = FrameJob();
  session->job.request = request;
  session->job.scene = &scene;
  session->shape = {kWidth, kHeight, 1, request.format};
  const JobTools tools = {1, nullptr, CoherenceMode::off};
  while (session->job.stage != JobStage::rows) {
    Slice slice;
    WireError code;
    RETURN_IF_ERROR(step_job(session, tools, kSliceNs, &slice, &code));
  }
  return success();
}

Status measure_costs(const StoredScene& scene, std::uint32_t samples, Costs* costs) {
  constexpr std::size_t kBytes = 64u << 20;
  void* block = take_block(kBytes);
  if (!block) return failure("not enough memory");
  Session session;
  make_session(block, kBytes, &session);
  session.message_bytes_max = kMessageBytesMax;
  FrameRequest request;
  request.scene = scene.hash, request.format = WireFormat::rgb888;
  request.row_end = kHeight, request.chunk_rows = kStrip;
  request.settings.width = kWidth, request.settings.height = kHeight, request.settings.samples_per_pixel = samples;
  RETURN_IF_ERROR(prepare(&session, scene, request));
  std::vector<std::uint32_t> row_pixels(kHeight);
  auto trace = [&](std::uint32_t row, std::uint32_t rows) {
    return least_seconds([&] { trace_piece(&session, {row, row + rows, 0, kWidth}, row_pixels.data()); });
  };
  for (std::uint32_t row = 0; row < kHeight; row += kStrip) costs->strip.push_back(trace(row, kStrip));
  for (std::uint32_t row = 0; row < kHeight; row += kHalfStrip) costs->half_strip.push_back(trace(row, kHalfStrip));
  costs->prepare = least_seconds([&] { CHECK(prepare(&session, scene, request).ok); });
  // Two pictures in turn, as when the camera moves.
  trace(0, kHeight);
  std::vector<std::uint8_t> pictures[2], bytes(encoded_bytes_max(session.shape, kStrip));
  pictures[0].assign(session.pixels.begin(), session.pixels.end());
  request.camera_stated = true;
  request.camera = session.own_camera;
  request.camera.node = kNone;
  request.camera.eye.x += 0.02f * length(request.camera.target - request.camera.eye);
  RETURN_IF_ERROR(prepare(&session, scene, request));
  trace(0, kHeight);
  pictures[1].assign(session.pixels.begin(), session.pixels.end());
  costs->encode_row = least_seconds([&] {
    for (const std::vector<std::uint8_t>& picture : pictures)
      for (std::uint32_t row = 0; row < kHeight; row += kStrip) {
        std::uint8_t encoding;
        encode_rows(session.encoder, request.frame, row, kStrip,
                    picture.data() + std::size_t(row) * line_bytes(session), request.coding, bytes.data(), &encoding);
      }
  });
  costs->encode_row /= 2 * kHeight;
  give_block_back(block);
  return success();
}

struct Answer {
  double seconds;
  RowPiece piece;
};
struct Helper {
  double free = 0;
  std::deque<Answer> answers;
};

class Simulation {
 public:
  Simulation(const Costs& costs, std::uint32_t ranks, std::uint32_t chunk_rows)
      : costs_(costs), chunk_rows_(chunk_rows), helpers_(ranks) {
    make_row_share(kHeight, &share_);
    FrameRequest request;
    request.settings.width = kWidth, request.settings.height = kHeight, request.row_end = kHeight;
    begin_row_share(request, false, &share_);
  }

  double run() {
    for (std::size_t rank = 1; rank < helpers_.size(); ++rank)
      now_ += kGiveSeconds, helpers_[rank].free = now_ + kLatencySeconds + kLookSeconds + costs_.prepare;
    now_ += costs_.prepare;
    while (sent_ < kHeight) {
      take();
      give();
      const std::uint32_t chunk = std::min(chunk_rows_, kHeight - sent_);
      if (share_.front - sent_ >= chunk) {
        now_ += chunk * costs_.encode_row, sent_ += chunk;
        continue;
      }
      RowPiece piece;
      if (take_piece(&share_, 0, limits(), &piece)) {
        now_ += work(piece);
        end_piece(&share_, 0, piece);
      } else {
        now_ = std::max(now_, next_answer());
      }
    }
    return now_;
  }

 private:
  PieceLimits limits() const {
    const std::uint32_t unsent = share_.front - sent_, ranks = static_cast<std::uint32_t>(helpers_.size());
    PieceLimits limits;
    limits.window = window_rows(chunk_rows_ > unsent ? chunk_rows_ - unsent : 0, chunk_rows_, ranks);
    limits.rows = piece_rows(free_rows(share_, kHeight), 1.0 / ranks, 1);
    limits.pixels = 1u << 20;
    return limits;
  }
  double work(const RowPiece& piece) const {
    double seconds = 0;
    for (std::uint32_t row = piece.row_begin; row < piece.row_end;)
      if (row % kStrip == 0 && row + kStrip <= piece.row_end)
        seconds += costs_.strip[row / kStrip], row += kStrip;
      else
        seconds += costs_.half_strip[row / kHalfStrip], row += kHalfStrip;
    return seconds;
  }
  double next_answer() const {
    double first = 1e30;
    for (const Helper& helper : helpers_)
      if (!helper.answers.empty()) first = std::min(first, helper.answers.front().seconds);
    return first;
  }
  void take() {
    for (std::size_t rank = 1; rank < helpers_.size(); ++rank)
      while (!helpers_[rank].answers.empty() && helpers_[rank].answers.front().seconds <= now_) {
        end_piece(&share_, static_cast<std::uint16_t>(rank), helpers_[rank].answers.front().piece);
        helpers_[rank].answers.pop_front();
        now_ += kTakeSeconds;
      }
  }
  void give() {
    for (std::size_t pieces = 0; pieces < 2; ++pieces)
      for (std::size_t rank = 1; rank < helpers_.size(); ++rank) {
        Helper* helper = &helpers_[rank];
        RowPiece piece;
        if (helper->answers.size() != pieces) continue;
        if (!take_piece(&share_, static_cast<std::uint16_t>(rank), limits(), &piece)) return;
        now_ += kGiveSeconds;
        helper->free = std::max(helper->free, now_ + kLatencySeconds) + work(piece);
        link_free_ = std::max(link_free_, helper->free) + pixel_count(piece) * 3 / kBytesPerSecond;
        helper->answers.push_back({link_free_ + kLatencySeconds, piece});
      }
  }

  const Costs& costs_;
  std::uint32_t chunk_rows_, sent_ = 0;
  RowShare share_;
  std::vector<Helper> helpers_;  // by rank; the first is idle
  double now_ = 0, link_free_ = 0;
};

}  // namespace

int main(int argument_count, char** arguments) {
  SceneStore store;
  const std::string name = argument_count > 1 ? arguments[1] : "cornell";
  const int samples = argument_count > 2 ? std::atoi(arguments[2]) : 1;
  Status status = store_scene(name, name, false, 1u << 30, &store);
  Costs costs;
  if (status.ok) status = measure_costs(store.scenes[0], static_cast<std::uint32_t>(samples > 0 ? samples : 1), &costs);
  if (!status.ok) return report(status);
  double strips = 0, half_strips = 0;
  for (double seconds : costs.strip) strips += seconds;
  for (double seconds : costs.half_strip) half_strips += seconds;
  std::printf(
      "%s: preparing %.2f ms, tracing by strips of eight rows %.1f ms, of four %.1f ms (the dearest %.1f ms), coding "
      "%.2f ms\n",
      name.c_str(), 1e3 * costs.prepare, 1e3 * strips, 1e3 * half_strips,
      1e3 * *std::max_element(costs.half_strip.begin(), costs.half_strip.end()), 1e3 * kHeight * costs.encode_row);
  for (std::uint32_t chunk_rows : {8u, 32u}) {
    const double alone = Simulation(costs, 1, chunk_rows).run();
    std::printf("chunks of %u rows: %.2f ms alone\n ", chunk_rows, 1e3 * alone);
    for (std::uint32_t ranks : {2u, 4u, 8u, 16u, 32u, 64u}) {
      const double seconds = Simulation(costs, ranks, chunk_rows).run();
      std::printf(" %u ranks %.2f ms (%.1f×)", ranks, 1e3 * seconds, alone / seconds);
    }
    std::printf("\n");
  }
  return 0;
}
