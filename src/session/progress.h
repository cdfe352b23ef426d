// Progress on stderr for work longer than a second: a bar with an estimate on a terminal, otherwise an occasional line.
// Allocates nothing.
#pragma once
#include <atomic>
#include <cstdint>

namespace pocketray {

struct Progress {
  const char* what = "";
  std::uint64_t total = 0;
  std::uint64_t start_ns = 0, shown_ns = 0;
  bool terminal = false, shown = false;
};

Progress start_progress(const char* what, std::uint64_t total);
// Call as often as you like; prints at most ten times a second (terminal) or every ten seconds.
void show_progress(Progress* progress, std::uint64_t done);
// Clears the bar.
void end_progress(Progress* progress);

}  // namespace pocketray
