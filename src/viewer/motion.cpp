#include "viewer/motion.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kPressNs = 1'000'000;  // minimum duration that a press counts as

std::uint32_t index_of(std::uint64_t ns) {
  std::uint32_t octave = 0;
  while (octave < kLatencyOctaves && ns >> (kLatencyOctaveMin + octave + 1) != 0) ++octave;
  if (octave == kLatencyOctaves) return kLatencyCount - 1;
  const std::uint64_t base = std::uint64_t(1) << (kLatencyOctaveMin + octave);
  return octave * kLatencyParts + (ns < base ? 0 : static_cast<std::uint32_t>((ns - base) * kLatencyParts / base));
}

std::uint64_t least_of(std::uint32_t index) {
  const std::uint64_t base = std::uint64_t(1) << (kLatencyOctaveMin + index / kLatencyParts);
  return index == 0 ? 0 : base + base / kLatencyParts * (index % kLatencyParts);
}

// Adds motion whose latencies are spread evenly.
void add_latencies(Motion* motion, std::uint64_t shortest_ns, std::uint64_t longest_ns) {
  CHECK_LE(shortest_ns, longest_ns);
  for (std::uint64_t at = shortest_ns; at < longest_ns;) {
    const std::uint32_t index = index_of(at);
    const std::uint64_t end = index + 1 < kLatencyCount ? std::min(longest_ns, least_of(index + 1)) : longest_ns;
    motion->ns_by_latency[index] += end - at;
    at = end;
  }
  motion->total_ns += longest_ns - shortest_ns;
}

}  // namespace

void note_motion(Motion* motion, std::uint64_t begin_ns, std::uint64_t end_ns) {
  CHECK_LE(begin_ns, end_ns);
  if (begin_ns != motion->noted_ns) begin_ns = std::min(begin_ns, end_ns - std::min(end_ns, kPressNs));
  motion->noted_ns = end_ns;
  const bool any = motion->span_count > motion->taken_count;
  MotionSpan* last = any ? &motion->spans[motion->span_count - 1] : nullptr;
  if (last) begin_ns = std::max(begin_ns, last->begin_ns);
  if (last && begin_ns <= last->end_ns) {
    last->end_ns = std::max(last->end_ns, end_ns);
  } else if (motion->span_count < kMotionSpansMax) {
    motion->spans[motion->span_count++] = {begin_ns, end_ns};
  } else {
    motion->spans[kMotionSpansMax - 1].end_ns = end_ns;
  }
}

void take_motion(Motion* motion) {
  // Makes room for the next note.
  if (motion->span_count == kMotionSpansMax) {
    motion->spans[kMotionSpansMax - 2].end_ns = motion->spans[kMotionSpansMax - 1].end_ns;
    --motion->span_count;
  }
  motion->taken_count = motion->span_count;
}

void show_motion(Motion* motion, std::uint64_t now_ns) {
  CHECK_LE(motion->taken_count, motion->span_count);
  for (std::uint32_t i = 0; i < motion->taken_count; ++i) {
    const MotionSpan& span = motion->spans[i];
    now_ns = std::max(now_ns, span.end_ns);
    add_latencies(motion, now_ns - span.end_ns, now_ns - span.begin_ns);
  }
  std::copy(motion->spans + motion->taken_count, motion->spans + motion->span_count, motion->spans);
  motion->span_count -= motion->taken_count;
  motion->taken_count = 0;
}

void drop_motion(Motion* motion) { motion->span_count = motion->taken_count = 0; }

double latency_ns(const Motion& motion, double part) {
  CHECK(part >= 0 && part <= 1);
  if (motion.total_ns == 0) return 0;
  double left = part * static_cast<double>(motion.total_ns);
  for (std::uint32_t i = 0; i + 1 < kLatencyCount; ++i) {
    const double ns = static_cast<double>(motion.ns_by_latency[i]), begin = static_cast<double>(least_of(i));
    if (left <= ns && ns > 0) return begin + left / ns * (static_cast<double>(least_of(i + 1)) - begin);
    left -= ns;
  }
  return static_cast<double>(least_of(kLatencyCount - 1));
}

}  // namespace pocketray
