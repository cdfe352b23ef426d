// A list of blocks, free or in use, that fill the pool without gaps: next fit, joining free neighbours on the way
// [Knuth, The Art of Computer Programming vol. 1, sec. 2.5].
#include "accel/grid_pool.h"

#include <thread>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kGivingUp = 1u << 31;
// The clock advances whenever this part of the pool has been taken; the age of a grid counts these ticks.
constexpr std::uint32_t kTicksPerPool = 16;
constexpr std::uint32_t kAgeMax = kTicksPerPool;
// Part of the pool discarded at once: a quarter, so that waiting for the other threads is rare.
constexpr std::uint32_t kGivenUpPart = 4;
// After a failed search, reject this many requests immediately: about as many as a pool has blocks, so that searching
// takes little of the time.
constexpr std::uint32_t kRestAfterFailure = 4096;

std::uint32_t pool_words(const GridHeader& h) { return h.pool_end - h.pool_begin; }
std::uint32_t words_of(const GridNode& node) { return node.block & ~kBlockInUse; }
bool is_in_use(const GridNode& node) { return node.block & kBlockInUse; }

void tick(GridHeader* h) {
  h->words_since_tick = 0;
  h->clock.store(h->clock.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

std::uint32_t age_of(const GridHeader& h, const GridNode& node) {
  std::uint32_t age = h.clock.load(std::memory_order_relaxed) - node.stamp.load(std::memory_order_relaxed);
  return age < kAgeMax ? age : kAgeMax;
}

// Returns whether the grid or one above it has that age. A ray enters all of them; threads stamp them in any order.
bool has_age(const Grid& grid, const GridNode& node, std::uint32_t age) {
  const GridNode* n = &node;
  for (; n->parent; n = &grid.node(n->parent))
    if (age_of(grid.header(), *n) >= age) return true;
  return false;
}

// Returns the next free block of that many words, or 0. Grids in use are not touched.
std::uint32_t find_block(const Grid& grid, std::uint32_t words) {
  GridHeader& h = grid.header();
  std::uint32_t place = h.next < h.pool_end ? h.next : h.pool_begin;
  for (std::uint64_t seen = 0; seen < pool_words(h);) {
    GridNode& node = grid.node(place);
    CHECK(words_of(node) > 0 && words_of(node) <= h.pool_end - place);
    while (!is_in_use(node) && place + node.block < h.pool_end && !is_in_use(grid.node(place + node.block))) {
      if (place + node.block == h.next) h.next = place;  // no block begins there any more
      node.block += grid.node(place + node.block).block;
    }
    std::uint32_t size = words_of(node);
    if (!is_in_use(node) && size >= words) {
      if (size > words) grid.node(place + words).block = size - words;
      node.block = words | kBlockInUse;
      h.next = place + words;
      return place;
    }
    seen += size;
    place = size < h.pool_end - place ? place + size : h.pool_begin;
  }
  return 0;
}

template <class Visit>
void for_each_grid(const Grid& grid, Visit visit) {
  const GridHeader& h = grid.header();
  for (std::uint32_t place = h.pool_begin; place < h.pool_end; place += words_of(grid.node(place)))
    if (is_in_use(grid.node(place))) visit(grid.node(place));
}

// Returns the least age such that grids of at least this age fill a part of the pool; at least 1. 0 if there are none.
std::uint32_t age_to_give_up(const Grid& grid) {
  std::uint64_t words[kAgeMax + 1] = {};
  for_each_grid(grid, [&](const GridNode& node) { words[age_of(grid.header(), node)] += words_of(node); });
  std::uint64_t sum = 0;
  std::uint32_t oldest = 0;
  for (std::uint32_t age = kAgeMax; age > 0; --age) {
    sum += words[age];
    if (sum > 0) oldest = age;
    if (sum >= pool_words(grid.header()) / kGivenUpPart) break;
  }
  return oldest;
}

// "This entails deleting the voxel's grid structure, and marking the voxel as not subdivided" (sec. 6.1). No other
// thread is within a visit.
bool give_up_inactive(const Grid& grid, std::uint32_t parent) {
  GridHeader& h = grid.header();
  for (std::uint32_t place = parent; place != kRootPlace; place = grid.node(place).parent)
    grid.node(place).stamp.store(h.clock.load(std::memory_order_relaxed), std::memory_order_relaxed);
  std::uint32_t age = age_to_give_up(grid);
  if (age == 0) return false;
  for_each_grid(grid, [&](GridNode& node) {
    if (!has_age(grid, node, age)) return;
    // If the parent has been discarded as well, its cells are still there: nothing overwrites them before the end.
    cells_of(grid.node(node.parent))[node.cell].child.store(kNotSubdivided, std::memory_order_relaxed);
    node.block &= ~kBlockInUse;
    ++h.given_up_count;
  });
  return true;
}

}  // namespace

GridVisit::GridVisit(GridHeader* header) : header_(header) {
  while (header->walks.fetch_add(1, std::memory_order_acquire) & kGivingUp) {
    header->walks.fetch_sub(1, std::memory_order_relaxed);
    while (header->walks.load(std::memory_order_relaxed) & kGivingUp) std::this_thread::yield();
  }
}

void make_pool(const Grid& grid, std::uint32_t begin, std::uint32_t end) {
  GridHeader& h = grid.header();
  CHECK(begin < end && end - begin < kBlockInUse);
  h.pool_begin = h.next = begin, h.pool_end = end;
  h.words_since_tick = h.rest = 0;
  grid.node(begin).block = end - begin;
}

bool is_resting(GridHeader* header) {
  if (header->rest == 0) return false;
  --header->rest;
  return true;
}

std::uint32_t take_block(const Grid& grid, std::uint32_t parent, std::uint64_t words) {
  GridHeader& h = grid.header();
  CHECK_EQ(h.rest, 0u);
  std::uint32_t size = static_cast<std::uint32_t>(words);
  std::uint32_t place = words <= pool_words(h) ? find_block(grid, size) : 0;
  if (!place && words <= pool_words(h)) {
    // Other visits end without waiting for this one, since they only try to lock. Then this thread is alone.
    h.walks.fetch_or(kGivingUp, std::memory_order_acquire);
    while ((h.walks.load(std::memory_order_acquire) & ~kGivingUp) != 1) std::this_thread::yield();
    if (give_up_inactive(grid, parent)) place = find_block(grid, size);
    h.walks.fetch_and(~kGivingUp, std::memory_order_release);
  }
  if (!place) {
    h.rest = kRestAfterFailure;
    tick(&h);  // grids not entered from now on may then be discarded
    return 0;
  }
  h.words_since_tick += size;
  if (h.words_since_tick > pool_words(h) / kTicksPerPool) tick(&h);
  return place;
}

}  // namespace pocketray
