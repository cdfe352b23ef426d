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

double seconds_left(TimeEstimate* e, double elapsed, double share) {
  CHECK(e != nullptr && share > 0 && share <= 1 && elapsed >= 0);
  // Chosen: speeds that grow or fall with the square root of time, whose estimates are off by a factor of two or more,
  // do not count as steady.
  constexpr double kWindow = 1.5, kSteady = 1.2;
  constexpr double kShareMin = 1.0 / 32;  // chosen: less of the work is not representative
  if (elapsed >= kWindow * e->since_seconds && elapsed > e->since_seconds && share >= e->since_share) {
    const double speed = (share - e->since_share) / (elapsed - e->since_seconds), before = e->speed;
    e->is_steady = speed > 0 && speed <= kSteady * before && before <= kSteady * speed;
    e->since_seconds = elapsed, e->since_share = share, e->speed = speed;
  }
  return e->is_steady && share >= kShareMin ? (1 - share) / e->speed : -1;
}

void format_left(double elapsed, double left, const LaterWork& later, char (&text)[kLeftTextMax]) {
  CHECK(elapsed >= 0 && later.seconds >= 0 && later.share >= 0);
  text[0] = 0;
  if (!(left >= 0)) return;
  const double all = left + later.seconds + later.share * (elapsed + left);
  if (later.seconds == 0 && later.share == 0)
    std::snprintf(text, sizeof text, ", %.0f s left", left);
  else if (all < 90)
    std::snprintf(text, sizeof text, ", %.0f s left, about %.0f s in all", left, all);
  else
    std::snprintf(text, sizeof text, ", %.0f s left, about %.0f min in all", left, all / 60);
}

void show_progress(Progress* p, std::uint64_t done) {
  constexpr std::uint64_t kSecond = 1000000000;
  // Chosen: ten times per second looks continuous, a line every 10 s keeps logs short, and work of less than a second
  // needs none.
  std::uint64_t now = clock_ns(), interval = p->terminal ? kSecond / 10 : 10 * kSecond;
  if (done == 0 || p->total == 0) return;
  const double share = done < p->total ? static_cast<double>(done) / static_cast<double>(p->total) : 1;
  const double elapsed = static_cast<double>(now - p->start_ns) * 1e-9;
  const double left = seconds_left(&p->estimate, elapsed, share);
  if (now - p->start_ns < kSecond || (p->shown && now - p->shown_ns < interval)) return;
  p->shown_ns = now;
  p->shown = true;
  char left_text[kLeftTextMax];
  format_left(elapsed, left, p->later, left_text);
  if (p->terminal) {
    char bar[31];
    int filled = static_cast<int>(share * 30);
    std::memset(bar, '.', 30);
    std::memset(bar, '#', static_cast<std::size_t>(filled < 0 ? 0 : filled > 30 ? 30 : filled));
    bar[30] = 0;
    std::fprintf(stderr, "\r%s [%s] %3.0f %%%s \033[K", p->what, bar, share * 100, left_text);
  } else {
    std::fprintf(stderr, "%s: %.0f %%%s\n", p->what, share * 100, left_text);
  }
}

void end_progress(Progress* p) {
  if (p->shown && p->terminal) std::fprintf(stderr, "\r\033[K");
}

}  // namespace pocketray
