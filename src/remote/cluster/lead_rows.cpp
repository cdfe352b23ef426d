#include <algorithm>

#include "base/check.h"
#include "base/seal.h"
#include "engine/workers.h"
#include "remote/cluster/lead.h"
#include "remote/cluster/pieces.h"

namespace pocketray {
namespace {

// As without helpers (server/session.cpp).
constexpr std::uint32_t kFirstPixels = 8;
// A helper has two pieces: together they last a slice at most.
constexpr std::uint64_t kPieceNs = kSliceNs / 2;
// Pixels below which overhead dominates the time of a piece. Chosen: a row of a small screen.
constexpr std::uint32_t kTimedPixels = 64;

}  // namespace

ClusterLead::Slot* ClusterLead::slot_of(Session* session) {
  for (std::uint32_t i = 0; i < slot_count_; ++i)
    if (slots_[i].session == session) return &slots_[i];
  CHECK_LT(slot_count_, slots_.size());
  slots_[slot_count_].session = session;
  return &slots_[slot_count_++];
}

void ClusterLead::ask(std::uint32_t index, const ClusterTrace& work, bool is_piece) {
  Rank* rank = &ranks_[index];
  CHECK_LT(rank->asked_count, kAskedMax);
  if (rank->asked_count == 0) rank->heard_ns = clock_ns();
  rank->asked[rank->asked_count++] = {work, is_piece, false};
  rank->piece_count += is_piece;
}

void ClusterLead::prepare(Slot* slot, std::uint32_t rank) {
  CHECK(slot->preparations[rank] == Preparation::none);
  SealPause pause;  // a message is sent from the heap
  const Session& session = *slot->session;
  ClusterPrepare message = {};
  message.job.number = slot->job_number;
  message.job.session = static_cast<std::uint32_t>(slot - slots_.data());
  message.request = session.job.request;
  message.own_exposure = session.own_exposure;
  ask(rank, {message.job, {}}, false);
  send_plain(team_, rank, kPrepare, message);
  slot->preparations[rank] = Preparation::asked;
}

// Judges by the last frame if it was complete. The first one after a change costs more, since ranks then trace whole
// rows that others had.
bool ClusterLead::is_worth_sharing(const Slot& slot) const {
  const RowShare& share = slot.share;
  if (!slot.is_begun || share.front < share.count || slot.is_shared != slot.was_shared) return slot.is_shared;
  const FrameRequest& request = slot.session->job.request;
  const std::uint64_t row_ns = slot.work_ns / share.count, rows = request.row_end - request.row_begin;
  return row_ns * rows >= (slot.is_shared ? shared_ns_min_ : 2 * shared_ns_min_);
}

void ClusterLead::begin(Session* session) {
  CHECK(has_job(*session) && !session->job.is_view_query && session->own_exposure > 0);
  Slot* slot = slot_of(session);
  const bool is_shared = is_worth_sharing(*slot);
  slot->was_shared = slot->is_shared, slot->is_shared = is_shared;
  slot->job_number = session->job_number;
  slot->is_begun = false;
  slot->work_ns = 0;
  slot->pixels_done = slot->pixels_traced = 0;
  std::fill(slot->preparations.begin(), slot->preparations.end(), Preparation::none);
  session->job.row_pixels = slot->share.row_pixels.data();
  // At most one helper per row besides the first.
  const std::uint32_t rows = session->job.request.row_end - session->job.request.row_begin;
  for (std::uint32_t rank = 1; rank < team_.size; ++rank) {
    const bool helps = is_shared && rank < rows;
    if (!helps) slot->preparations[rank] = Preparation::refused;
    if (!helps || ranks_[rank].is_lost || ranks_[rank].is_silent) continue;
    if (ranks_[rank].asked_count < kAskedMax) prepare(slot, rank);
  }
}

std::uint32_t ClusterLead::window_of(const Slot& slot) const {
  const FrameJob& job = slot.session->job;
  const std::uint32_t unsent = slot.share.front - job.rows_sent, chunk = next_chunk_rows(job.request, job.sent);
  return window_rows(chunk > unsent ? chunk - unsent : 0, job.request.chunk_rows, thread_count());
}

PieceLimits ClusterLead::limits_of(const Slot& slot, std::uint32_t index, std::uint32_t window) const {
  const Rank& rank = ranks_[index];
  const Session& session = *slot.session;
  PieceLimits limits;
  limits.window = window;
  limits.pixels = kFirstPixels * rank.threads;
  if (session.trace_ns > 0)
    limits.pixels = slice_pixels(session.renderer.settings, session.renderer.lights.points.count, session.trace_ns,
                                 kPieceNs * rank.threads);
  double speed = 0;
  for (const Rank& other : ranks_)
    if (other.pixel_ns > 0 && !other.is_lost && !other.is_silent) speed += 1 / other.pixel_ns;
  const double part = rank.pixel_ns > 0 ? 1 / rank.pixel_ns / speed : 0;
  limits.rows = piece_rows(free_rows(slot.share, slot.share.count), std::min(part, 1.0), rank.threads);
  limits.any = !slot.keeps_rows;
  return limits;
}

bool ClusterLead::give_piece(Slot* slot, std::uint32_t rank) {
  ClusterTrace work;
  work.job.number = slot->job_number;
  work.job.session = static_cast<std::uint32_t>(slot - slots_.data());
  const PieceLimits limits = limits_of(*slot, rank, window_of(*slot));
  if (!take_piece(&slot->share, static_cast<std::uint16_t>(rank), limits, &work.piece)) return false;
  SealPause pause;  // a message is sent from the heap
  ask(rank, work, true);
  send_plain(team_, rank, kTrace, work);
  return true;
}

// Serves ranks without a piece first.
void ClusterLead::give(Slot* slot) {
  for (std::uint32_t pieces = 0; pieces < kPiecesMax; ++pieces)
    for (std::uint32_t rank = 1; rank < team_.size; ++rank) {
      Rank* r = &ranks_[rank];
      if (r->is_lost || r->is_silent || r->asked_count == kAskedMax || r->piece_count != pieces) continue;
      if (slot->preparations[rank] == Preparation::none) prepare(slot, rank);
      if (slot->preparations[rank] == Preparation::done && r->asked_count < kAskedMax) give_piece(slot, rank);
    }
}

void ClusterLead::end_own_or_other(Slot* slot, std::uint32_t index, const RowPiece& piece, std::uint32_t traced,
                                   std::uint64_t took_ns) {
  Rank* rank = &ranks_[index];
  Session* session = slot->session;
  end_piece(&slot->share, static_cast<std::uint16_t>(index), piece);
  slot->pixels_done += pixel_count(piece);
  slot->pixels_traced += traced;
  slot->work_ns += took_ns;
  pixels_traced_ += traced;
  if (index > 0) pixels_helped_ += traced;
  const double ns = static_cast<double>(took_ns + 1) / std::max(traced, 1u);
  if (traced >= kTimedPixels || (traced > 0 && session->trace_ns == 0))
    session->trace_ns = dear_pixel_ns(session->trace_ns, ns * rank->threads);
  if (traced >= kTimedPixels) rank->pixel_ns = rank->pixel_ns > 0 ? 0.875 * rank->pixel_ns + 0.125 * ns : ns;
}

bool ClusterLead::trace_own(Slot* slot, bool any) {
  PieceLimits limits = limits_of(*slot, 0, window_of(*slot));
  limits.any = any;
  RowPiece piece;
  if (!take_piece(&slot->share, 0, limits, &piece)) return false;
  const std::uint64_t start = clock_ns();
  const std::uint32_t traced = trace_piece(slot->session, piece, slot->share.row_pixels.data() + piece.row_begin);
  end_own_or_other(slot, 0, piece, traced, clock_ns() - start);
  return true;
}

Slice ClusterLead::trace(Session* session, std::uint64_t slice_ns) {
  Slot* slot = slot_of(session);
  const FrameJob& job = session->job;
  CHECK_EQ(slot->job_number, session->job_number);
  RowShare* share = &slot->share;
  if (!slot->is_begun) {
    slot->keeps_rows = session->renderer.history.records;
    begin_row_share(job.request, slot->keeps_rows, share);
    slot->is_begun = true;
  }
  const std::uint32_t rest = next_chunk_rows(job.request, job.sent) - (job.rows_traced - job.rows_sent);
  const std::uint64_t start = clock_ns();
  // Rows that others had in the last frame, and that would have to be traced whole, are reserved for them this long.
  const double whole_ns = session->trace_ns * share->width / ranks_[0].threads;
  const bool leaves_rows = slot->keeps_rows && slot->is_shared;
  for (bool any = !leaves_rows;; any = !leaves_rows) {
    while (take_answer(0)) {
    }
    give(slot);
    const std::uint64_t passed = clock_ns() - start;
    if (share->front - job.rows_traced >= rest || passed >= slice_ns) break;
    const bool is_first = session->trace_ns == 0;
    if (!trace_own(slot, any)) {
      const double left = static_cast<double>(slice_ns - passed);
      const std::uint32_t done = slot->pixels_done;
      wait_for_answer(slot, 1e-9 * (any ? left : std::min(left, whole_ns)));
      if (!any && done == slot->pixels_done) trace_own(slot, true);
    }
    if (is_first) break;
  }
  Slice slice = {};
  slice.row_count = share->front - job.rows_traced;
  slice.pixel_count = slot->pixels_done, slice.traced_count = slot->pixels_traced;
  slot->pixels_done = slot->pixels_traced = 0;
  return slice;
}

}  // namespace pocketray
