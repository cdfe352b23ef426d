// An event simulation of a shared frame, independent of the split's model: a server traces chunks of rows of unequal
// cost and puts each on the link once it is traced, the link carries one after the other, the device traces its own
// rows. Tracing and sending form a two-machine flow shop [Johnson 1954].
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace pocketray {

struct ShopJob {
  std::uint32_t row_begin, row_end;
  double trace_ns, send_ns;
};

// When the last of the jobs has come, in the order given.
inline double shop_ns(const std::vector<ShopJob>& jobs, double start_ns) {
  double traced = start_ns, sent = start_ns;
  for (const ShopJob& job : jobs) {
    traced += job.trace_ns;
    sent = std::max(sent, traced) + job.send_ns;
  }
  return sent;
}

// Sorts into the order that ends first [Johnson 1954]: jobs that the link takes longer for than the server, the quickly
// traced first; then the others, the quickly sent last.
inline void sort_jobs(std::vector<ShopJob>* jobs) {
  std::stable_sort(jobs->begin(), jobs->end(), [](const ShopJob& a, const ShopJob& b) {
    const bool a_first = a.trace_ns < a.send_ns, b_first = b.trace_ns < b.send_ns;
    if (a_first != b_first) return a_first;
    return a_first ? a.trace_ns < b.trace_ns : a.send_ns > b.send_ns;
  });
}

// The least end of all orders, by trying them.
inline double least_shop_ns(std::vector<ShopJob> jobs, double start_ns) {
  auto less = [](const ShopJob& a, const ShopJob& b) { return a.row_begin < b.row_begin; };
  std::sort(jobs.begin(), jobs.end(), less);
  double least = shop_ns(jobs, start_ns);
  while (std::next_permutation(jobs.begin(), jobs.end(), less)) least = std::min(least, shop_ns(jobs, start_ns));
  return least;
}

}  // namespace pocketray
