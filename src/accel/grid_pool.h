// The pool from which grids are allocated, and the rules of access to it.
#pragma once
#include "accel/grid.h"

namespace pocketray {

// One query or one packet of queries: grids within its reach are not discarded meanwhile. Queries must not be nested:
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

// Makes a pool of one free block from `begin` to `end`, in words.
void make_pool(const Grid& grid, std::uint32_t begin, std::uint32_t end);

// Returns whether this thread now holds the pool's lock. Never waits: a thread that fails continues without a grid.
inline bool try_lock(GridHeader* header) { return header->lock.exchange(1, std::memory_order_acquire) == 0; }
inline void unlock(GridHeader* header) { header->lock.store(0, std::memory_order_release); }

// Returns whether to leave the pool alone because it had no room lately. Call once per request, under the lock.
bool is_resting(GridHeader* header);

// Returns the position of a block of at least that many words for a grid under `parent`; called in a visit, under the
// lock. If the pool is full, first discards grids not entered lately, except `parent` and its ancestors. 0: no room.
std::uint32_t take_block(const Grid& grid, std::uint32_t parent, std::uint64_t words);

}  // namespace pocketray
