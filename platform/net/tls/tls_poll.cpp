// Waiting of an encrypted link.
#include <algorithm>

#include "platform/check.h"
#include "platform/net/tls/tls_link_state.h"

namespace platform {
namespace {

constexpr std::uint64_t kHourNs = 3'600'000'000'000;

// The wait on the link below, whatever the caller waits for; `wait` is the caller's, or null.
LinkWait ask(const TlsSlot& slot, const LinkWait* wait) {
  LinkWait below;
  below.stream = slot.inner;
  switch (slot.phase) {
    case TlsPhase::listening:
      below.want_read = wait && wait->want_read;
      break;
    case TlsPhase::connecting:
      below.want_write = true;
      break;
    case TlsPhase::greeting:
      below.want_write = slot.tls.wants_write;
      below.want_read = !below.want_write;
      break;
    case TlsPhase::connected:
      below.want_read = wait && wait->want_read && !slot.ended;
      below.want_write = tls_keeps_output(slot.tls) || (wait && wait->want_write);
      break;
    case TlsPhase::closing:
      below.want_write = true;
      break;
    case TlsPhase::unused:
    case TlsPhase::broken:
      break;
  }
  return below;
}

// Sets what the stream of a wait can do without waiting; returns true if anything.
bool look(TlsLink* link, LinkWait* wait) {
  wait->can_read = wait->can_write = false;
  if (!wait->want_read && !wait->want_write) return false;
  TlsSlot* slot = tls_slot_of(link, wait->stream);
  if (!slot || slot->phase == TlsPhase::broken) {
    wait->can_read = wait->want_read, wait->can_write = wait->want_write;
  } else if (slot->phase == TlsPhase::connected) {
    wait->can_read = wait->want_read && (slot->ended || tls_has_input(slot->tls));
  }
  return wait->can_read || wait->can_write;
}

// A step of an accepted peer's handshake, then a rest.
void greet_in_turn(TlsLink* link, TlsSlot* slot) {
  Error error;
  const std::uint64_t begin = now_of(link);
  (void)tls_greet(link, slot, &error);
  const std::uint64_t end = now_of(link);
  link->rest = link_timer(end, end > begin ? kTlsRestFactor * (end - begin) : 0);
  link->turn = (static_cast<int>(slot - link->slots) + 1) % link->slot_count;
}

// Moves a stream that is ready below. `*may_greet` is spent by a step of an accepted peer's handshake.
void move(TlsLink* link, TlsSlot* slot, const LinkWait& below, LinkWait* wait, bool* may_greet) {
  Error error;
  switch (slot->phase) {
    case TlsPhase::listening:
      wait->can_read = below.can_read;
      break;
    case TlsPhase::connecting:
      (void)tls_progress(link, slot, &error);
      break;
    case TlsPhase::greeting:
      if (!slot->accepted) {
        (void)tls_greet(link, slot, &error);
      } else if (*may_greet) {
        *may_greet = false;
        greet_in_turn(link, slot);
      }
      break;
    case TlsPhase::connected:
      if (tls_keeps_output(slot->tls) && below.can_write && tls_flush(&slot->tls) == LinkResult::failed)
        (void)tls_fail(link, slot, &error);
      if (!wait || slot->phase == TlsPhase::broken) break;
      wait->can_read = wait->can_read || (wait->want_read && below.can_read);
      wait->can_write = wait->want_write && below.can_write && !tls_keeps_output(slot->tls);
      break;
    case TlsPhase::closing:
      if (tls_farewell(&slot->tls) != LinkResult::later) tls_free_closing(link, slot);
      break;
    case TlsPhase::unused:
    case TlsPhase::broken:
      break;
  }
}

// Gives up streams whose time is up; returns the shortest time left of the others, or `wait_ns`.
std::uint64_t watch_timers(TlsLink* link, std::uint64_t wait_ns) {
  std::uint64_t now = now_of(link);
  for (int i = 0; i < link->slot_count; ++i) {
    TlsSlot* slot = &link->slots[i];
    if (slot->phase != TlsPhase::greeting && slot->phase != TlsPhase::closing) continue;
    std::uint64_t left = link_timer_left(&slot->timer, now);
    Error error;
    if (left == 0 && slot->phase == TlsPhase::greeting) (void)tls_fail_in_time(link, slot, &error);
    if (left == 0 && slot->phase == TlsPhase::closing) tls_free_closing(link, slot);
    if (left > 0 && left < wait_ns) wait_ns = left;
  }
  return wait_ns;
}

// One round of poll(): finds what is ready now or after the inner link has waited for at most `wait_ns`. Adds time
// waited in vain to `waited_ns`.
int poll_once(TlsLink* link, LinkWait* waits, int wait_count, std::uint64_t wait_ns, std::uint64_t* waited_ns) {
  // 1. What needs no wait.
  wait_ns = watch_timers(link, wait_ns);
  for (int i = 0; i < wait_count; ++i)
    if (look(link, &waits[i])) wait_ns = 0;

  // 2. Every stream that may move, each once, beginning with the one whose turn it is; and who waits for it.
  int inner_count = 0;
  const int turn = link->turn;
  const std::uint64_t rest_ns = link_timer_left(&link->rest, now_of(link));
  auto wait_of = [&](const TlsSlot* slot) -> LinkWait* {
    for (int i = 0; i < wait_count; ++i)
      if ((waits[i].want_read || waits[i].want_write) && tls_slot_of(link, waits[i].stream) == slot) return &waits[i];
    return nullptr;
  };
  auto slot_in_turn = [&](int i) { return &link->slots[(turn + i) % link->slot_count]; };
  for (int i = 0; i < link->slot_count; ++i) {
    const TlsSlot* slot = slot_in_turn(i);
    if (slot->phase == TlsPhase::unused || slot->phase == TlsPhase::broken) continue;
    if (slot->phase == TlsPhase::greeting && slot->accepted && rest_ns > 0) {
      wait_ns = std::min(wait_ns, rest_ns);
      continue;
    }
    LinkWait below = ask(*slot, wait_of(slot));
    if (below.want_read || below.want_write) link->waits[inner_count++] = below;
  }
  PLATFORM_CHECK_LE(inner_count, link->slot_count);
  if (net(link).poll(link->inner, link->waits, inner_count, wait_ns) == 0) *waited_ns += wait_ns;

  // 3. Its answers, in the same order.
  bool may_greet = rest_ns == 0;
  for (int i = 0, at = 0; i < link->slot_count && at < inner_count; ++i) {
    TlsSlot* slot = slot_in_turn(i);
    if (slot->inner != link->waits[at].stream) continue;
    const LinkWait below = link->waits[at++];
    if (!below.can_read && !below.can_write) continue;
    move(link, slot, below, wait_of(slot), &may_greet);
  }
  int ready_count = 0;
  for (int i = 0; i < wait_count; ++i)
    if (waits[i].can_read || waits[i].can_write || look(link, &waits[i])) ++ready_count;
  return ready_count;
}

}  // namespace

int tls_poll(Link* base, LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  PLATFORM_CHECK(wait_count == 0 || (wait_count > 0 && waits != nullptr));
  TlsLink* link = tls_of(base);
  if (wait_count > link->slot_count) wait_count = link->slot_count;
  LinkTimer timer = link_timer(now_of(link), timeout_ns < kHourNs ? timeout_ns : kHourNs);
  std::uint64_t waited_ns = 0;  // ends the wait if the clock stands still
  for (;;) {
    std::uint64_t left = link_timer_left(&timer, now_of(link));
    int ready_count = poll_once(link, waits, wait_count, left, &waited_ns);
    if (ready_count > 0 || left == 0 || waited_ns >= timer.timeout_ns) return ready_count;
  }
}

}  // namespace platform
