#include "remote/server/share.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "base/limit_list.h"

namespace pocketray {

namespace {

// Returns the side whose turn it is; at least one must wait.
int choose_side(Turns* turns, bool first_waits, bool second_waits) {
  const bool waits[2] = {first_waits, second_waits};
  for (int side = 0; side < 2; ++side) {
    // A side that was away is credited only a little of that time.
    const std::uint64_t other = turns->used_ns[1 - side], credit = std::min(other, kCreditNs);
    if (waits[side] && !turns->waits[side]) turns->used_ns[side] = std::max(turns->used_ns[side], other - credit);
    turns->waits[side] = waits[side];
  }
  if (!first_waits || !second_waits) return second_waits ? 1 : 0;
  return turns->used_ns[1] < turns->used_ns[0] ? 1 : 0;
}

void take_turn(Turns* turns, int side, std::uint64_t took_ns) {
  turns->used_ns[side] += took_ns * (side == 1 ? kBehindPart - 1 : 1);
}

}  // namespace

Lane lane_of(const Account& account) {
  const std::uint64_t debt = account.owed_ns + account.job_ns;
  if (is_proven(account) && debt <= std::min(kLightNs, kTrustFactor * account.earned_ns)) return Lane::light;
  return debt <= kNewcomerNs ? Lane::newcomer : Lane::heavy;
}

std::uint64_t offence_ns(const Account& account, std::uint64_t more_ns) {
  const std::uint64_t debt = account.owed_ns + more_ns;
  const std::uint64_t trusted = std::min(kLightNs, kTrustFactor * account.earned_ns);
  return debt > std::max(kNewcomerNs, trusted) ? debt : 0;
}

void note(Lanes* lanes, Account* account, bool waits) {
  const Lane lane = lane_of(*account);
  std::uint64_t floor = lanes->floor_ns[static_cast<int>(lane)];
  std::uint64_t credit = account->known ? std::min(floor, kCreditNs) : 0;
  if (lane != account->lane) account->used_ns = floor;
  if (waits && !account->waits) account->used_ns = std::max(account->used_ns, floor - credit);
  account->lane = lane;
  account->waits = waits;
  account->known = account->known || waits;
}

void consider(Choice* choice, int index, const Account& account) {
  if (!account.waits) return;
  const int lane = static_cast<int>(account.lane);
  const Account* first = choice->accounts[lane];
  const bool by_seat = account.lane == Lane::newcomer;
  if (first && (by_seat ? account.seat >= first->seat : account.used_ns >= first->used_ns)) return;
  choice->first[lane] = index;
  choice->accounts[lane] = &account;
}

int choose(Lanes* lanes, const Choice& choice) {
  const auto waits = [&](Lane lane) { return choice.first[static_cast<int>(lane)] >= 0; };
  const bool behind = waits(Lane::newcomer) || waits(Lane::heavy);
  if (!waits(Lane::light) && !behind) return -1;
  Lane lane = Lane::light;
  if (choose_side(&lanes->light, waits(Lane::light), behind) == 1)
    lane = choose_side(&lanes->behind, waits(Lane::newcomer), waits(Lane::heavy)) == 1 ? Lane::heavy : Lane::newcomer;
  return choice.first[static_cast<int>(lane)];
}

void charge(Lanes* lanes, Account* account, std::uint64_t took_ns) {
  const int lane = static_cast<int>(account->lane);
  lanes->floor_ns[lane] = std::max(lanes->floor_ns[lane], account->used_ns);
  take_turn(&lanes->light, account->lane == Lane::light ? 0 : 1, took_ns);
  if (account->lane != Lane::light) take_turn(&lanes->behind, is_heavy(*account) ? 1 : 0, took_ns);
  account->used_ns += took_ns;
}

void owe(Account* account, std::uint64_t took_ns) {
  account->owed_ns = std::min(account->owed_ns + took_ns, kOwedNsMax);
}

void owe_messages(Account* account, std::uint64_t took_ns) {
  owe(account, is_proven(*account) ? took_ns : kNewcomerMessages * took_ns);
}

void end_frame(Account* account, std::uint64_t took_ns, std::uint64_t sent_ns, std::uint64_t build_ns) {
  account->job_ns -= std::min(account->job_ns, took_ns);
  bool light = took_ns <= kLightNs + build_ns;
  if (light) account->owed_ns -= std::min(account->owed_ns, sent_ns);
  if (light) account->earned_ns = std::min(account->earned_ns + std::min(took_ns, sent_ns), kLightNs);
  owe(account, light ? took_ns - std::min(took_ns, sent_ns) : took_ns);
}

void forgive(Account* account, std::uint64_t passed_ns, std::uint64_t account_count) {
  CHECK_GT(account_count, 0u);
  if (account->owed_ns == 0) return;
  account->owed_ns -= std::min(account->owed_ns, passed_ns / (kForgiveFactor * account_count));
}

void observe_demand(Account* account, std::uint64_t passed_ns) {
  const double passed = static_cast<double>(passed_ns), part = passed / (passed + static_cast<double>(kDemandNs));
  account->demand += part * ((account->waits ? 1 : 0) - account->demand);
}

double crowding(const Lanes& lanes, const Account& account) {
  const int lane = is_heavy(account) ? 1 : 0;
  const double others = std::max(0.0, lanes.demand[lane] - account.demand);
  // Fraction of the turns that the other lane takes while it has work.
  constexpr double kHeavyTurns = 1.0 / kBehindPart;
  const double lost = std::min(1.0, lanes.demand[1 - lane]) * (lane == 1 ? 1 - kHeavyTurns : kHeavyTurns);
  return (1 + others) / (1 - lost);
}

std::uint16_t price_of(double address_crowding, double connection_crowding) {
  CHECK(address_crowding >= 1 && connection_crowding >= 1);
  const double price = kPriceUnit * address_crowding * connection_crowding;
  return static_cast<std::uint16_t>(price < limit_of(Quantity::price).high ? price + 0.5 : UINT16_MAX);
}

std::uint64_t address_key(const char* name) {
  CHECK(name != nullptr);
  // FNV-1a over the significant part of the address.
  std::uint64_t key = 0xcbf29ce484222325;
  auto add = [&](unsigned value) { key = (key ^ value) * 0x100000001b3; };
  if (name[0] != '[') {
    for (const char* end = std::strrchr(name, ':'); *name && name != end; ++name)
      add(static_cast<unsigned char>(*name));
    return key;
  }
  // Hexadecimal groups of 16 bits; "::" stands for the zero groups missing from eight.
  unsigned groups[8] = {0}, behind = 0, count = 0, gap = 8;
  for (const char* at = name + 1; *at && *at != ']' && count < 8;) {
    if (at[0] == ':' && at[1] == ':') {
      gap = count;
      at += 2;
      continue;
    }
    if (*at == ':') ++at;
    char* end;
    groups[count++] = static_cast<unsigned>(std::strtoul(at, &end, 16)) & 0xffff;
    if (end == at) break;
    at = end;
  }
  behind = gap < count ? count - gap : 0;
  for (unsigned i = 0; i < 4; ++i) {
    bool is_behind = i >= 8 - behind;
    add(i < gap ? groups[i] : is_behind ? groups[gap + i - (8 - behind)] : 0);
  }
  return key;
}

}  // namespace pocketray
