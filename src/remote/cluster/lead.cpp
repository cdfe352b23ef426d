// Scenes and answers; lead_rows.cpp assigns rows.
#include "remote/cluster/lead.h"

#include <algorithm>
#include <cinttypes>
#include <cstring>

#include "base/check.h"
#include "base/seal.h"
#include "engine/workers.h"
#include "remote/cluster/pieces.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

constexpr double kWaitSeconds = 0.05;
// Bytes of a scene sent at once. Chosen: 64 helpers that start together make rank 0 hold 64 MiB for a moment.
constexpr std::uint64_t kSceneBytes = 1 << 20;
// Chosen: pieces take milliseconds.
constexpr std::uint64_t kPatienceNs = 2'000'000'000;

bool has_part(const SceneStore& store, const ClusterWant& want) {
  return want.scene < store.scenes.size() &&
         want.offset < store.scenes[static_cast<std::size_t>(want.scene)].byte_count;
}

void send_scene(const Team& team, std::uint32_t rank, const SceneStore& store, const ClusterWant& want) {
  const StoredScene& stored = store.scenes[static_cast<std::size_t>(want.scene)];
  ClusterScene scene = {want, store.scenes.size(), stored.byte_count, stored.hash, {}};
  std::memcpy(scene.name, stored.name, sizeof scene.name);
  TeamWriter text;
  write_plain(scene, &text);
  text.append(stored.bytes + want.offset,
              static_cast<std::size_t>(std::min(kSceneBytes, stored.byte_count - want.offset)));
  send_to(team, rank, kScene, text.bytes().data(), text.bytes().size());
}

bool same_work(const ClusterTrace& a, const ClusterTrace& b) {
  return a.job.number == b.job.number && a.job.session == b.job.session && a.piece == b.piece;
}

}  // namespace

ClusterLead::ClusterLead(const Team& team, const ServerOptions& options, std::string identity,
                         std::uint64_t shared_ns_min)
    : team_(team),
      options_(options),
      identity_(std::move(identity)),
      ranks_(team.size),
      slots_(static_cast<std::size_t>(options.client_count_max)),
      shared_ns_min_(shared_ns_min) {
  CHECK(leads(team));
  CHECK_LT(team.size, std::uint32_t(kNoRank));
  helpers_table_.context = this;
  helpers_table_.begin = [](void* lead, Session* session) { static_cast<ClusterLead*>(lead)->begin(session); };
  helpers_table_.trace = [](void* lead, Session* session, std::uint64_t slice_ns) {
    return static_cast<ClusterLead*>(lead)->trace(session, slice_ns);
  };
  ranks_[0].threads = options.thread_count;
  for (Slot& slot : slots_) {
    make_row_share(options.image_side_max, &slot.share);
    slot.preparations.resize(team.size);
  }
}

Status ClusterLead::welcome(const SceneStore& store) {
  for (std::uint32_t ready_count = 1; ready_count < team_.size && !interrupted;) {
    TeamMessage message;
    bool there;
    RETURN_IF_ERROR(receive_from_helpers(team_, kWaitSeconds, &message, &there));
    if (!there) continue;
    Rank* rank = &ranks_[message.from];
    TeamReader reader(message);
    if (message.bytes[0] == kWantScene) {
      ClusterWant want;
      if (!read_plain(&reader, &want) || !has_part(store, want))
        return failure("rank %u: its program differs from rank 0's", message.from);
      send_scene(team_, message.from, store, want);
      continue;
    }
    const std::string identity = reader.text();
    rank->threads = static_cast<std::uint32_t>(reader.number());
    const bool is_first = message.bytes[0] == kReady && !rank->is_ready;
    if (!is_first || !reader.ok() || identity != identity_ || rank->threads == 0)
      return failure("rank %u: its program or options differ from rank 0's: start all ranks with the same command",
                     message.from);
    rank->is_ready = true;
    ++ready_count;
  }
  return success();
}

Status ClusterLead::tend() {
  while (failed_.ok && take_answer(0)) {
  }
  return failed_;
}

std::uint32_t ClusterLead::thread_count() const {
  std::uint32_t count = 0;
  for (const Rank& rank : ranks_) count += rank.threads;
  return count;
}

double ClusterLead::helped_share() const {
  return pixels_traced_ > 0 ? static_cast<double>(pixels_helped_) / static_cast<double>(pixels_traced_) : 0;
}

bool ClusterLead::is_current(const Slot& slot, const ClusterJob& job) const {
  return slot.session && has_job(*slot.session) && !slot.session->job.is_view_query &&
         slot.session->job_number == job.number && slot.job_number == job.number;
}

void ClusterLead::tell(std::uint32_t rank, const char* what) {
  if (!options_.log) return;
  char line[160];
  std::snprintf(line, sizeof line, "rank %u %s", rank, what);
  options_.log(options_.log_context, line);
}

void ClusterLead::take_back(std::uint32_t rank) {
  CHECK(rank > 0 && rank < team_.size);
  Rank* r = &ranks_[rank];
  for (std::uint32_t i = 0; i < r->asked_count; ++i) r->asked[i].is_abandoned = true;
  for (Slot& slot : slots_)
    if (slot.is_begun) take_back_rows(&slot.share, static_cast<std::uint16_t>(rank));
}

// Takes one answer; returns false if none came in time.
bool ClusterLead::take_answer(double seconds) {
  SealPause pause;  // a message is received on the heap
  TeamMessage message;
  bool there;
  Status status = receive_from_helpers(team_, seconds, &message, &there);
  if (!status.ok) failed_ = status;
  if (!there) return false;
  Rank* rank = &ranks_[message.from];
  if (rank->is_lost) return true;
  rank->heard_ns = clock_ns();
  if (!answer_fits(message.from, message)) {
    tell(message.from, "sent an unrequested answer: it gets no more rows, and the others trace its rows");
    rank->is_lost = true;
    take_back(message.from);
  }
  if (rank->is_silent && rank->asked_count == 0) rank->is_silent = false, tell(message.from, "answers again");
  return true;
}

// Returns false unless it answers the rank's oldest question.
bool ClusterLead::answer_fits(std::uint32_t from, const TeamMessage& message) {
  Rank* rank = &ranks_[from];
  if (rank->asked_count == 0) return false;
  const Asked asked = rank->asked[0];
  TeamReader reader(message);
  ClusterTraced traced = {};
  if (asked.is_piece ? !read_plain(&reader, &traced) : !read_plain(&reader, &traced.asked.job)) return false;
  const std::uint8_t kind = message.bytes[0];
  if (asked.is_piece ? kind != kTraced : kind != kPrepared && kind != kRefused) return false;
  if (!same_work(traced.asked, asked.work)) return false;
  CHECK_LT(asked.work.job.session, slot_count_);
  Slot* slot = &slots_[asked.work.job.session];
  const bool counts = !asked.is_abandoned && is_current(*slot, asked.work.job);
  if (asked.is_piece && counts && !take_rows(slot, from, traced, &reader)) return false;
  std::copy(rank->asked + 1, rank->asked + rank->asked_count, rank->asked);
  --rank->asked_count;
  if (asked.is_piece) --rank->piece_count;
  if (!asked.is_piece && counts) {
    slot->preparations[from] = kind == kPrepared ? Preparation::done : Preparation::refused;
    if (kind == kRefused) tell(from, ("cannot help with a frame: " + reader.text()).c_str());
  }
  return true;
}

// Takes the rows of a piece, if they are complete.
bool ClusterLead::take_rows(Slot* slot, std::uint32_t rank, const ClusterTraced& traced, TeamReader* reader) {
  const RowPiece& piece = traced.asked.piece;
  Session* session = slot->session;
  CHECK(session->encoder != nullptr && piece.row_end <= session->shape.height);
  if (piece.column_end == slot->share.width) {
    const std::size_t rows = piece.row_end - piece.row_begin, bytes = rows * line_bytes(*session);
    std::uint32_t* row_pixels = slot->share.row_pixels.data() + piece.row_begin;
    if (reader->left() != rows * sizeof *row_pixels + bytes) return false;
    CHECK(reader->take(row_pixels, rows * sizeof *row_pixels));
    CHECK(reader->take(packed_rows(*session, piece.row_begin), bytes));
  } else if (reader->left() != 0) {
    return false;
  }
  end_own_or_other(slot, rank, piece, std::min(traced.pixels_traced, pixel_count(piece)), traced.took_ns);
  return true;
}

void ClusterLead::wait_for_answer(Slot* slot, double seconds) {
  if (take_answer(seconds)) return;
  const RowShare& share = slot->share;
  if (share.front == share.count) return;
  const std::uint32_t rank = share.rows[share.front].rank;
  if (rank == 0 || rank == kNoRank || clock_ns() - ranks_[rank].heard_ns < kPatienceNs) return;
  tell(rank, "does not answer: the others trace its rows until it does");
  ranks_[rank].is_silent = true;
  take_back(rank);
}

}  // namespace pocketray
