#include "remote/server/share.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "base/limit_list.h"

namespace pocketray {

void note(Lanes* lanes, Account* account, bool waits) {
  bool heavy = is_heavy(*account);
  std::uint64_t floor = lanes->floor_ns[heavy], credit = account->known ? std::min(floor, kCreditNs) : 0;
  if (heavy != account->heavy) account->used_ns = floor;
  if (waits && !account->waits) account->used_ns = std::max(account->used_ns, floor - credit);
  account->heavy = heavy;
  account->waits = waits;
  account->known = account->known || waits;
}

int choose_lane(Lanes* lanes, bool light_waits, bool heavy_waits) {
  const bool waits[2] = {light_waits, heavy_waits};
  for (int lane = 0; lane < 2; ++lane) {
    // A lane is not compensated for the time it was empty.
    if (waits[lane] && !lanes->waits[lane]) lanes->used_ns[lane] = std::max(lanes->used_ns[0], lanes->used_ns[1]);
    lanes->waits[lane] = waits[lane];
  }
  if (!light_waits || !heavy_waits) return heavy_waits ? 1 : 0;
  return lanes->used_ns[1] < lanes->used_ns[0] ? 1 : 0;
}

void charge(Lanes* lanes, Account* account, std::uint64_t took_ns) {
  int lane = account->heavy ? 1 : 0;
  lanes->floor_ns[lane] = std::max(lanes->floor_ns[lane], account->used_ns);
  lanes->used_ns[lane] += took_ns * (lane == 1 ? kHeavyPart - 1 : 1);
  account->used_ns += took_ns;
}

void owe(Account* account, std::uint64_t took_ns) {
  account->owed_ns = std::min(account->owed_ns + took_ns, kOwedNsMax);
}

void end_frame(Account* account, std::uint64_t took_ns, std::uint64_t sent_ns) {
  account->job_ns -= std::min(account->job_ns, took_ns);
  bool light = took_ns <= kLightNs;
  if (light) account->owed_ns -= std::min(account->owed_ns, sent_ns);
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
  const int lane = account.heavy ? 1 : 0;
  const double others = std::max(0.0, lanes.demand[lane] - account.demand);
  // The turns that the other lane takes while it has work.
  constexpr double kHeavyTurns = 1.0 / kHeavyPart;
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
