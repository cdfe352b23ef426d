#include "session/progress.h"

#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "engine/workers.h"
#include "platform/file.h"

namespace pocketray {

Progress start_progress(const char* what, std::uint64_t total) {
  CHECK(what != nullptr);
  Progress p;
  p.what = what;
  p.total = total;
  p.start_ns = p.shown_ns = clock_ns();
  p.terminal = platform::stderr_is_terminal();
  return p;
}

void show_progress(Progress* p, std::uint64_t done) {
  constexpr std::uint64_t kSecond = 1000000000;
  // Chosen: ten times a second looks continuous, a line every 10 s keeps logs short, and what takes less than a second
  // needs none.
  std::uint64_t now = clock_ns(), interval = p->terminal ? kSecond / 10 : 10 * kSecond;
  if (now - p->start_ns < kSecond || (p->shown && now - p->shown_ns < interval) || done == 0 || p->total == 0) return;
  p->shown_ns = now;
  p->shown = true;
  double share =
      done < p->total ? static_cast<double>(done) / static_cast<double>(p->total) : 1;  // totals are estimates
  double left = static_cast<double>(now - p->start_ns) * 1e-9 * (1 - share) / share;
  if (p->terminal) {
    char bar[31];
    int filled = static_cast<int>(share * 30);
    std::memset(bar, '.', 30);
    std::memset(bar, '#', static_cast<std::size_t>(filled < 0 ? 0 : filled > 30 ? 30 : filled));
    bar[30] = 0;
    std::fprintf(stderr, "\r%s [%s] %3.0f %%, %.0f s left \033[K", p->what, bar, share * 100, left);
  } else {
    std::fprintf(stderr, "%s: %.0f %%, %.0f s left\n", p->what, share * 100, left);
  }
}

void end_progress(Progress* p) {
  if (p->shown && p->terminal) std::fprintf(stderr, "\r\033[K");
}

}  // namespace pocketray
