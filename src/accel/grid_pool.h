// The pool that grids come from, and who may touch it when.
#pragma once
#include "accel/grid.h"

namespace pocketray {

// One query, or one packet of them: grids that it can reach are not given up meanwhile. Queries must not be nested:
// the filter of one must not start another.
class GridVisit {
 public:
  explicit GridVisit(GridHeader* header);
  ~GridVisit() { header_->walks.fetch_sub(1, std::memory_order_release); }
  GridVisit(const GridVisit&) = delete;
  GridVisit& operator=(const GridVisit&) = delete;

 private:
  GridHeader* header_;
};

// One free block from `begin` to `end`, in words.
void make_pool(const Grid& grid, std::uint32_t begin, std::uint32_t end);

// Whether this thread now holds the lock of the pool. Never waits: whoever is turned away does without a grid.
inline bool try_lock(GridHeader* header) { return header->lock.exchange(1, std::memory_order_acquire) == 0; }
inline void unlock(GridHeader* header) { header->lock.store(0, std::memory_order_release); }

// Whether to leave the pool alone, since it had no room lately. To be asked once per request, under the lock.
bool is_resting(GridHeader* header);

// The place of a block of at least that many words, for a grid under `parent`, within a visit and under the lock. If
// the pool is full, first gives up grids that were not entered lately; not `parent` and those above it. 0: no room.
std::uint32_t take_block(const Grid& grid, std::uint32_t parent, std::uint64_t words);

}  // namespace pocketray
