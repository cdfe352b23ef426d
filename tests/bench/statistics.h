// Clocks and order statistics.
#pragma once
#include <time.h>

#include <algorithm>
#include <vector>

namespace pocketray {

inline double seconds_by(clockid_t clock) {
  timespec now;
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

template <class Function>
double seconds_of(clockid_t clock, Function function) {
  double start = seconds_by(clock);
  function();
  return seconds_by(clock) - start;
}
// CPU time of the calling thread: other programs have little effect.
template <class Function>
double thread_seconds_of(Function function) {
  return seconds_of(CLOCK_THREAD_CPUTIME_ID, function);
}

// The interpolated value below which this share of the values lies. Sorts them.
inline double percentile(std::vector<double>* values, double share) {
  std::sort(values->begin(), values->end());
  double place = share * static_cast<double>(values->size() - 1);
  std::size_t below = static_cast<std::size_t>(place), above = std::min(below + 1, values->size() - 1);
  return (*values)[below] + ((*values)[above] - (*values)[below]) * (place - static_cast<double>(below));
}
inline double median(std::vector<double>* values) { return percentile(values, 0.5); }

}  // namespace pocketray
