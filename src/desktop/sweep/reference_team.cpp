#include "desktop/sweep/reference_team.h"

#include <algorithm>
#include <mutex>

#include "base/check.h"
#include "desktop/sweep/reference_share.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

enum : std::uint8_t {
  kBegin = kTeamFirstOwn,  // to helpers: run, transport, key
  kReady,                  // from helpers: run, threads
  kPieces,                 // to helpers: run, then pieces
  kRows                    // from helpers: run, then rows' samples
};

// Pieces that a helper holds at a time: while it works on one, the next has already arrived.
constexpr std::uint32_t kPortionsAhead = 2;
constexpr double kWaitSeconds = 0.05;
// Chosen: mpirun kills ranks a second after telling them to end, and saving takes part of it.
constexpr double kInterruptSeconds = 0.4;
// Interval of measurements that only report progress.
constexpr double kTellSeconds = 10;

// Takes pieces of different rows with the rig's threads; after an interrupt, only those that were begun.
std::vector<RowSamples> take_rows(const Rig& rig, Transport transport, const std::vector<ReferencePiece>& pieces) {
  struct Job {
    const Rig& rig;
    Transport transport;
    const std::vector<ReferencePiece>& pieces;
    std::mutex mutex;
    std::vector<RowSamples> taken;
  } job = {rig, transport, pieces, {}, {}};
  auto take = [](void* context, std::uint32_t, std::uint32_t i) {
    Job* j = static_cast<Job*>(context);
    RowSamples row = take_row(j->rig.reference, j->transport, j->pieces[i].row, j->pieces[i].samples);
    std::lock_guard<std::mutex> lock(j->mutex);
    j->taken.push_back(std::move(row));
    return !interrupted.load();
  };
  share_items(rig.opened.renderer.workers, 0, static_cast<std::uint32_t>(pieces.size()), take, &job);
  return std::move(job.taken);
}

std::uint32_t thread_count(const Rig& rig) { return std::max(1u, worker_thread_count(rig.opened.renderer.workers)); }

struct Helper {
  bool is_ready = false;
  std::uint32_t threads = 0, portions = 0;  // outstanding portions
};

struct Lead {
  const ReferenceGoal& goal;
  const Rig& rig;
  ReferenceShare share;
  ReferenceGauge* gauge;
  std::vector<Helper> helpers;  // by rank; the leader's own is idle
  std::uint64_t run;            // number of this reference, to tell apart late messages of others
  bool drops = false;           // further samples are no longer wanted
};

Status add_rows(std::vector<RowSamples> rows, Lead* lead) {
  for (RowSamples& row : rows) {
    lead->gauge->done += (row.samples.end - row.samples.begin + kReferenceBatch - 1) / kReferenceBatch;
    const std::uint32_t number = row.row;
    RETURN_IF_ERROR(lead->share.add(std::move(row)));
    if (lead->goal.row_done) lead->goal.row_done(number);
  }
  show_progress(&lead->gauge->progress, lead->gauge->done);
  return success();
}

Status read_rows(TeamReader* reader, std::vector<RowSamples>* rows) {
  const std::size_t width = reader->number();
  CHECK_LE(width, std::size_t(kReferenceSampleMax));
  while (reader->ok() && reader->left() > 0) {
    RowSamples row = {};
    row.row = static_cast<std::uint32_t>(reader->number());
    row.samples.begin = static_cast<std::uint32_t>(reader->number());
    row.samples.end = static_cast<std::uint32_t>(reader->number());
    row.sums.resize(kReferenceHalfCount * 3 * width);
    reader->take(row.sums.data(), row.sums.size() * sizeof row.sums[0]);
    rows->push_back(std::move(row));
  }
  return reader->ok() ? success() : failure("a message of samples is truncated");
}

// Gives out pieces until each ready helper has as many as it may.
void give_pieces(Lead* lead) {
  std::uint32_t threads = thread_count(lead->rig);
  for (const Helper& helper : lead->helpers) threads += helper.threads;
  for (std::uint32_t portions = 0; portions < kPortionsAhead; ++portions)
    for (std::uint32_t rank = 1; rank < lead->helpers.size(); ++rank) {
      Helper& helper = lead->helpers[rank];
      if (!helper.is_ready || helper.portions != portions) continue;
      TeamWriter text;
      text.number(lead->run);
      std::vector<ReferencePiece> pieces = lead->share.take_portion(helper.threads, threads);
      if (pieces.empty()) return;
      for (const ReferencePiece& piece : pieces)
        text.number(piece.row), text.number(piece.samples.begin), text.number(piece.samples.end);
      send_to(lead->goal.team, rank, kPieces, text.bytes().data(), text.bytes().size());
      ++helper.portions;
    }
}

// Handles a message of a helper, waiting at most `seconds` for it.
Status serve_one(double seconds, Lead* lead, bool* there) {
  TeamMessage message;
  RETURN_IF_ERROR(receive_from_helpers(lead->goal.team, seconds, &message, there));
  if (!*there) return success();
  TeamReader reader(message);
  if (reader.number() != lead->run) return success();
  Helper& helper = lead->helpers[message.from];
  if (message.bytes[0] == kReady) {
    helper.is_ready = true;
    helper.threads = static_cast<std::uint32_t>(reader.number());
    return success();
  }
  CHECK_EQ(static_cast<int>(message.bytes[0]), static_cast<int>(kRows));
  CHECK_GT(helper.portions, 0u);
  --helper.portions;
  if (lead->drops) return success();
  std::vector<RowSamples> rows;
  RETURN_IF_ERROR(read_rows(&reader, &rows));
  return add_rows(std::move(rows), lead);
}

Status serve(double seconds, Lead* lead) {
  for (bool there = true; there && !interrupted; seconds = 0) RETURN_IF_ERROR(serve_one(seconds, lead, &there));
  return success();
}

// Ends rounds whose samples are complete. *enough: the error is small enough.
Status end_rounds(std::uint64_t* told_ns, Lead* lead, bool* enough) {
  while (lead->share.is_first_round_done() && !interrupted) {
    const bool tells = static_cast<double>(clock_ns() - *told_ns) > kTellSeconds * 1e9;
    if (lead->share.is_measured() && (lead->goal.until > 0 || tells)) {
      *enough = is_good_enough(lead->share.batches(), lead->gauge);
      *told_ns = clock_ns();
      if (*enough) return success();
    }
    RETURN_IF_ERROR(lead->share.end_round());
  }
  return success();
}

// Waits until every helper is ready and idle or, after an interrupt, for a limited time.
Status wait_for_helpers(Lead* lead) {
  auto is_busy = [](const Helper& h) { return !h.is_ready || h.portions > 0; };
  const std::uint64_t start = clock_ns();
  while (std::any_of(lead->helpers.begin() + 1, lead->helpers.end(), is_busy)) {
    bool there;
    RETURN_IF_ERROR(serve_one(kWaitSeconds, lead, &there));
    if (interrupted && static_cast<double>(clock_ns() - start) > kInterruptSeconds * 1e9) break;
  }
  return success();
}

Status lead_team(Lead* lead) {
  bool enough = is_good_enough_already(lead->gauge);
  std::uint64_t told_ns = clock_ns();
  while (!enough && !interrupted && !lead->share.is_done()) {
    RETURN_IF_ERROR(serve(0, lead));
    give_pieces(lead);
    RETURN_IF_ERROR(end_rounds(&told_ns, lead, &enough));
    if (enough || interrupted || lead->share.is_done()) break;
    give_pieces(lead);
    const std::vector<ReferencePiece> own = lead->share.take(thread_count(lead->rig));
    if (own.empty())
      RETURN_IF_ERROR(serve(kWaitSeconds, lead));
    else
      RETURN_IF_ERROR(add_rows(take_rows(lead->rig, lead->goal.transport, own), lead));
    if (must_save(*lead->gauge)) save_meanwhile(lead->gauge);
  }
  lead->drops = enough;
  RETURN_IF_ERROR(wait_for_helpers(lead));
  return interrupted ? lead->share.add_held() : success();
}

}  // namespace

Status take_with_team(const ReferenceGoal& goal, Rig* rig, Accumulation* accumulation, ReferenceGauge* gauge) {
  CHECK(rig != nullptr && accumulation != nullptr && gauge != nullptr);
  CHECK(leads(goal.team) && goal.team.size > 1);
  Lead lead = {goal,
               *rig,
               {half_samples(goal), goal.part, goal.part_count, goal.until > 0, accumulation},
               gauge,
               std::vector<Helper>(goal.team.size),
               clock_ns()};
  TeamWriter text;
  text.number(lead.run), text.number(static_cast<std::uint64_t>(goal.transport)), text.text(accumulation->key);
  for (std::uint32_t rank = 1; rank < goal.team.size; ++rank)
    send_to(goal.team, rank, kBegin, text.bytes().data(), text.bytes().size());
  return lead_team(&lead);
}

Status ReferenceHelper::begin(const TeamMessage& message) {
  TeamReader reader(message);
  run_ = reader.number();
  transport_ = reader.number() == static_cast<std::uint64_t>(Transport::model) ? Transport::model : Transport::physical;
  const std::string key = reader.text();
  if (!rig_) RETURN_IF_ERROR(find_rig_(&rig_));
  CHECK(rig_ != nullptr);
  if (reference_key(*rig_, options_, transport_) != key)
    return failure("its scene or program differs from rank 0's: give all machines the same files");
  make_rig_reference(rig_);
  TeamWriter text;
  text.number(run_), text.number(thread_count(*rig_));
  send_to(team_, 0, kReady, text.bytes().data(), text.bytes().size());
  return success();
}

Status ReferenceHelper::take_pieces(const TeamMessage& message) {
  TeamReader reader(message);
  CHECK_EQ(reader.number(), run_);
  std::vector<ReferencePiece> pieces;
  while (reader.ok() && reader.left() > 0) {
    ReferencePiece piece = {};
    piece.row = static_cast<std::uint32_t>(reader.number());
    piece.samples.begin = static_cast<std::uint32_t>(reader.number());
    piece.samples.end = static_cast<std::uint32_t>(reader.number());
    pieces.push_back(piece);
  }
  TeamWriter text;
  text.number(run_), text.number(rig_->opened.renderer.settings.width);
  for (const RowSamples& row : take_rows(*rig_, transport_, pieces)) {
    text.number(row.row), text.number(row.samples.begin), text.number(row.samples.end);
    text.append(row.sums.data(), row.sums.size() * sizeof row.sums[0]);
  }
  send_to(team_, 0, kRows, text.bytes().data(), text.bytes().size());
  return success();
}

Status ReferenceHelper::work(const TeamMessage& message) {
  CHECK(!message.bytes.empty());
  return message.bytes[0] == kBegin ? begin(message) : take_pieces(message);
}

}  // namespace pocketray
