#include "split/spot_check.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kChecksPaidMax = 1e6;  // per frame; more than are ever made, and exact as a double

bool contains(const std::uint32_t* numbers, std::uint32_t count, std::uint32_t number) {
  for (std::uint32_t i = 0; i < count; ++i)
    if (numbers[i] == number) return true;
  return false;
}

}  // namespace

double catch_probability(const SpotCheck& c) {
  std::uint64_t pixels = std::uint64_t(c.rows) * c.width;
  double wrong_wanted = static_cast<double>(c.wrong_rows) * c.width * c.wrong_share;
  if (c.wrong_rows == 0 || pixels == 0) return 0;
  std::uint64_t wrong = 1;
  if (wrong_wanted >= 1.5)
    wrong = static_cast<std::uint64_t>(std::min(wrong_wanted, static_cast<double>(pixels)) + 0.5);
  double caught = 0;
  for (std::uint64_t i = 0; i < c.pixels; ++i) {
    if (wrong >= pixels - i) return 1;
    caught = either_probability(caught, static_cast<double>(wrong) / static_cast<double>(pixels - i));
  }
  return caught;
}

double catch_probability(const SpotCheck& check, std::uint32_t frames) {
  double result = 0, power = catch_probability(check);
  for (; frames > 0; frames >>= 1) {
    if (frames & 1) result = either_probability(result, power);
    power = either_probability(power, power);
  }
  return result;
}

std::uint32_t random_below(Rng* random, std::uint32_t n) {
  CHECK_GT(n, 0u);
  // The high half of a product, rejecting the few products that would favour some numbers [Lemire 2019, algorithm 5].
  std::uint64_t product = std::uint64_t(next_u32(random)) * n;
  if (static_cast<std::uint32_t>(product) < n) {
    std::uint32_t least = (0u - n) % n;
    while (static_cast<std::uint32_t>(product) < least) product = std::uint64_t(next_u32(random)) * n;
  }
  return static_cast<std::uint32_t>(product >> 32);
}

void draw_distinct(Rng* random, std::uint32_t n, std::uint32_t count, std::uint32_t* numbers) {
  CHECK_LE(count, n);
  // Floyd's sampling without replacement [Bentley & Floyd 1987].
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t last = n - count + i, drawn = random_below(random, last + 1);
    numbers[i] = contains(numbers, i, drawn) ? last : drawn;
  }
}

void allot_checks(Rng* random, std::uint32_t count, const std::uint32_t* pixels, std::uint32_t server_count,
                  std::uint32_t* counts) {
  CHECK_LE(server_count, kServerCountMax);
  std::uint32_t senders[kServerCountMax], sender_count = 0, total = 0;
  for (std::uint32_t i = 0; i < server_count; ++i) {
    counts[i] = 0;
    if (pixels[i] > 0) senders[sender_count++] = i, total += pixels[i];
  }
  if (count < sender_count) {
    std::uint32_t chosen[kServerCountMax];
    draw_distinct(random, sender_count, count, chosen);
    for (std::uint32_t k = 0; k < count; ++k) counts[senders[chosen[k]]] = 1;
    return;
  }
  for (std::uint32_t k = 0; k < sender_count; ++k) counts[senders[k]] = 1;
  for (std::uint32_t left = total > 0 ? count - sender_count : 0; left > 0; --left) {
    std::uint32_t at = random_below(random, total), i = 0;
    while (at >= pixels[i]) at -= pixels[i++];
    if (counts[i] < pixels[i]) ++counts[i];
  }
}

CheckSchedule make_check_schedule(Rng* random) {
  CheckSchedule schedule;
  schedule.due = next_double(random);
  return schedule;
}

std::uint32_t due_checks(CheckSchedule* s, double checks, Rng* random) {
  if (!(checks > 0)) return 0;
  s->paid += checks < kChecksPaidMax ? checks : kChecksPaidMax;
  std::uint32_t count = 0;
  for (; s->due < s->paid && count < kSpotChecksMax; ++count) s->due = ++s->interval + next_double(random);
  if (s->due < s->paid) s->paid = s->interval;  // excess over the maximum per frame is dropped
  // Only the difference matters; kept small, it stays exact.
  s->paid -= s->interval, s->due -= s->interval, s->interval = 0;
  return count;
}

}  // namespace pocketray
