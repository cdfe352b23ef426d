// Front and price files, which have the same format, with arbitrary content.
#include <cmath>
#include <cstring>

#include "base/check.h"
#include "fuzz/fuzz.h"
#include "plan/front.h"
#include "plan/plan_effects.h"

POCKETRAY_FUZZ_TARGET(fuzz_front)

namespace pocketray {
namespace {

bool is_same(const Front& a, const Front& b) {
  if (a.count != b.count) return false;
  for (std::uint32_t i = 0; i < a.count; ++i) {
    const Candidate &x = a.candidates[i], &y = b.candidates[i];
    bool same_flip = x.flip == y.flip || (std::isnan(x.flip) && std::isnan(y.flip));
    if (!same_quality(x, y) || !same_flip || x.ns_per_pixel != y.ns_per_pixel) return false;
  }
  return true;
}

// Checks that a front that was read can be used, and reads back the same.
void check(const Front& front) {
  CHECK_GT(front.count, 0u);
  for (std::uint32_t i = 0; i < front.count; ++i) {
    const Candidate& c = front.candidates[i];
    CHECK(validate_settings(with_candidate(Settings(), c)).ok);
    CHECK(c.ns_per_pixel >= kPriceNsMin && c.ns_per_pixel <= kPriceNsMax);
    CHECK(find_candidate(front, c) != nullptr);
  }
  std::vector<char> text(kFrontTextMax);
  std::size_t length = format_front(front, text.data(), text.size());
  Front again;
  CHECK(parse_front(text.data(), length, &again).ok);
  CHECK(is_same(front, again));
}

void use(Front front, const Front& prices) {
  if (adopt_prices(&front, prices)) check(front);
  Front sorted = front;
  sort_by_price(&sorted);
  CHECK_EQ(sorted.count, front.count);
  for (std::uint32_t i = 1; i < sorted.count; ++i)
    CHECK(sorted.candidates[i - 1].ns_per_pixel <= sorted.candidates[i].ns_per_pixel);
  sort_front(&front);
  check(front);
  for (EffectMask effects : {EffectMask(0), EffectMask(kAllEffects)}) {
    Front less = front;
    drop_what_scene_ignores(&less, effects);
    check(less);
    CHECK_LE(less.count, front.count);
  }
}

}  // namespace

void fuzz_front(const std::uint8_t* bytes, std::size_t byte_count) {
  const void* end = byte_count > 0 ? std::memchr(bytes, 0, byte_count) : nullptr;
  std::size_t first = end ? static_cast<std::size_t>(static_cast<const std::uint8_t*>(end) - bytes) : byte_count;
  std::size_t second = end ? byte_count - first - 1 : 0;
  // Copies of the right size, so that a sanitizer notices overreads.
  std::vector<std::uint8_t> text(bytes, bytes + first), more(bytes + byte_count - second, bytes + byte_count);
  Front front, prices;
  bool is_front = parse_front(text.data(), text.size(), &front).ok;
  bool has_prices = parse_front(more.data(), more.size(), &prices).ok;
  if (!is_front) CHECK_EQ(front.count, 0u);
  if (is_front) check(front), use(front, has_prices ? prices : builtin_front(0));
  if (has_prices) check(prices), use(builtin_front(0), prices);
  fuzz_counts.fronts += is_front + has_prices;
}

}  // namespace pocketray
