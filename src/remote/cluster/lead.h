// Rank 0 of a server on several ranks. Only it talks to clients; all ranks trace the rows of each request. A helper has
// at most two pieces at a time, so that it has work while its last rows are on their way.
#pragma once
#include <string>

#include "remote/cluster/messages.h"
#include "remote/server/server.h"
#include "remote/server/session.h"

namespace pocketray {

// Frames with less work than this are traced by rank 0 alone. Chosen: four times the cost of sharing one, about half a
// millisecond of messages and waits.
constexpr std::uint64_t kSharedNsMin = 2'000'000;

class ClusterLead {
 public:
  // Allocates all memory that does not depend on scenes. `identity` must equal that of the helpers.
  ClusterLead(const Team& team, const ServerOptions& options, std::string identity,
              std::uint64_t shared_ns_min = kSharedNsMin);
  ClusterLead(const ClusterLead&) = delete;
  ClusterLead& operator=(const ClusterLead&) = delete;

  // For ServerOptions.
  const HelperRanks* helpers() const { return &helpers_table_; }
  // Sends all scenes to the helpers. Returns once all can trace, or at an interrupt; fails if one cannot.
  Status welcome(const SceneStore& store);
  // Call between steps of the server. Fails if a helper has failed; notices their interrupts.
  Status tend();

  std::uint32_t rank_count() const { return team_.size; }
  std::uint32_t thread_count() const;  // of all ranks, after welcome()
  double helped_share() const;         // fraction of the pixels traced so far that helpers traced

 private:
  static constexpr std::uint32_t kAskedMax = 3, kPiecesMax = 2;
  enum class Preparation : std::uint8_t { none, asked, done, refused };
  struct Asked {
    ClusterTrace work;
    bool is_piece, is_abandoned;  // abandoned: others trace it
  };
  struct Rank {
    std::uint32_t threads = 1;
    bool is_ready = false, is_lost = false, is_silent = false;
    Asked asked[kAskedMax];  // oldest first
    std::uint32_t asked_count = 0, piece_count = 0;
    std::uint64_t heard_ns = 0;  // or when it was asked after having nothing to do
    double pixel_ns = 0;         // recent; 0: unknown
  };
  struct Slot {
    Session* session = nullptr;
    std::uint64_t job_number = 0;
    bool is_begun = false, keeps_rows = false;
    bool is_shared = true, was_shared = true;  // this frame, and the one before
    std::uint64_t work_ns = 0;                 // of all ranks, for this frame
    RowShare share;
    std::vector<Preparation> preparations;             // by rank
    std::uint32_t pixels_done = 0, pixels_traced = 0;  // since the last slice
  };

  void begin(Session* session);
  bool is_worth_sharing(const Slot& slot) const;
  Slice trace(Session* session, std::uint64_t slice_ns);
  Slot* slot_of(Session* session);
  bool is_current(const Slot& slot, const ClusterJob& job) const;

  void ask(std::uint32_t rank, const ClusterTrace& work, bool is_piece);
  void prepare(Slot* slot, std::uint32_t rank);
  void give(Slot* slot);
  bool give_piece(Slot* slot, std::uint32_t rank);
  PieceLimits limits_of(const Slot& slot, std::uint32_t rank, std::uint32_t window) const;
  std::uint32_t window_of(const Slot& slot) const;
  bool trace_own(Slot* slot, bool any);
  void end_own_or_other(Slot* slot, std::uint32_t rank, const RowPiece& piece, std::uint32_t traced,
                        std::uint64_t took_ns);

  bool take_answer(double seconds);
  bool answer_fits(std::uint32_t rank, const TeamMessage& message);
  bool take_rows(Slot* slot, std::uint32_t rank, const ClusterTraced& traced, TeamReader* reader);
  void wait_for_answer(Slot* slot, double seconds);
  void take_back(std::uint32_t rank);
  void tell(std::uint32_t rank, const char* what);

  Team team_;
  ServerOptions options_;
  std::string identity_;
  HelperRanks helpers_table_;
  std::vector<Rank> ranks_;
  std::vector<Slot> slots_;
  std::uint32_t slot_count_ = 0;
  std::uint64_t shared_ns_min_;
  Status failed_;
  std::uint64_t pixels_traced_ = 0, pixels_helped_ = 0;
};

}  // namespace pocketray
