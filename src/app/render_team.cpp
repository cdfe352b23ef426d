#include "app/render_team.h"

#include <algorithm>

#include "base/check.h"
#include "engine/workers.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

enum : std::uint8_t {
  kReady = kTeamFirstOwn,  // from helpers: identity
  kFrames,                 // to helpers: frames to render
  kFrame                   // from helpers: a frame that is written
};

constexpr double kWaitSeconds = 0.05;
constexpr double kInterruptSeconds = 0.4;  // as for references: mpirun soon kills what does not end
// Chosen: the leader answers once per frame of its own, which may take as long as many frames that change little; but
// no other rank can take over what a helper holds.
constexpr std::size_t kFramesAheadMax = 16, kShareOfLeft = 8;

}  // namespace

FrameLead::FrameLead(const Team& team, std::string identity, std::vector<std::uint32_t> frames,
                     std::function<void(const SharedFrame&)> finished)
    : team_(team),
      identity_(std::move(identity)),
      share_(std::move(frames), team.size),
      finished_(std::move(finished)),
      helpers_(team.size) {
  CHECK(leads(team));
}

bool FrameLead::is_any_busy() const {
  return std::any_of(helpers_.begin(), helpers_.end(), [](const Helper& h) { return h.frames > 0; });
}

Status FrameLead::serve_one(double seconds, bool* there) {
  TeamMessage message;
  RETURN_IF_ERROR(receive_from_helpers(team_, seconds, &message, there));
  if (!*there) return success();
  TeamReader reader(message);
  Helper& helper = helpers_[message.from];
  if (message.bytes[0] == kReady) {
    helper.is_ready = true;
    if (reader.text() == identity_) return success();
    return failure("rank %u: its scene or program differs from rank 0's: give all machines the same files",
                   message.from);
  }
  CHECK_EQ(static_cast<int>(message.bytes[0]), static_cast<int>(kFrame));
  SharedFrame frame;
  frame.frame = static_cast<std::uint32_t>(reader.number()), frame.trace_ms = reader.real();
  CoherentSequence& c = frame.coherent;
  for (std::uint64_t* count : {&c.frames, &c.whole_frames, &c.pixels, &c.pixels_traced}) *count = reader.number();
  CHECK(reader.ok() && helper.frames > 0);
  --helper.frames;
  finished_(frame);
  return success();
}

void FrameLead::give_frames() {
  for (std::uint32_t rank = 1; rank < team_.size; ++rank) {
    Helper& helper = helpers_[rank];
    const std::size_t ahead = std::min(kFramesAheadMax, share_.left() / (kShareOfLeft * team_.size) + 1);
    if (!helper.is_ready || helper.frames > ahead) continue;  // one being rendered and `ahead` waiting
    TeamWriter text;
    const std::vector<std::uint32_t> frames = share_.take(rank, static_cast<std::uint32_t>(ahead + 1 - helper.frames));
    if (frames.empty()) return;
    for (std::uint32_t frame : frames) text.number(frame);
    send_to(team_, rank, kFrames, text.bytes().data(), text.bytes().size());
    helper.frames += frames.size();
  }
}

Status FrameLead::next(std::uint32_t* frame, bool* there) {
  CHECK(frame != nullptr && there != nullptr);
  const std::uint64_t start = clock_ns();
  for (double wait = 0;; wait = kWaitSeconds) {
    do RETURN_IF_ERROR(serve_one(wait, there));
    while (*there && wait == 0);
    if (interrupted && (!is_any_busy() || static_cast<double>(clock_ns() - start) > kInterruptSeconds * 1e9)) break;
    if (interrupted) continue;
    give_frames();
    const std::vector<std::uint32_t> own = share_.take(0, 1);
    if (!own.empty()) return *frame = own[0], *there = true, success();
    if (!is_any_busy()) break;
  }
  *there = false;
  return success();
}

void tell_ready_for_frames(const Team& team, const std::string& identity) {
  TeamWriter text;
  text.text(identity);
  send_to(team, 0, kReady, text.bytes().data(), text.bytes().size());
}

Status render_given_frames(const Team& team, const TeamMessage& message,
                           const std::function<Status(SharedFrame*, bool* complete)>& render) {
  CHECK_EQ(static_cast<int>(message.bytes[0]), static_cast<int>(kFrames));
  for (TeamReader reader(message); reader.left() > 0;) {
    SharedFrame frame;
    frame.frame = static_cast<std::uint32_t>(reader.number());
    bool complete = false;
    if (!interrupted) RETURN_IF_ERROR(render(&frame, &complete));
    if (!complete) return success();
    const CoherentSequence& c = frame.coherent;
    TeamWriter text;
    text.number(frame.frame), text.real(frame.trace_ms);
    for (std::uint64_t count : {c.frames, c.whole_frames, c.pixels, c.pixels_traced}) text.number(count);
    send_to(team, 0, kFrame, text.bytes().data(), text.bytes().size());
  }
  return success();
}

}  // namespace pocketray
