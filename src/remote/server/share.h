// Schedules the server's CPU: first among addresses, then among the connections of one. Pure; times are work by the
// link's clock.
//
// There are two lanes. The light lane serves accounts with frames of at most kLightNs. The heavy lane serves the rest:
// longer frames, rendered but unsent rows, and floods of other requests. While both have work, the light lane gets
// kHeavyPart - 1 of kHeavyPart turns, measured in time. Within a lane the account that has used the least CPU goes
// first [Goyal et al. 1996, start-time fair queueing]; one that was away is credited at most kCreditNs, a new one
// nothing.
#pragma once
#include <cstdint>

namespace pocketray {

// Chosen as stated; tests/remote/neighbours_test.cpp measures the result: a light client loses at most half its frame
// rate to twenty heavy ones.
constexpr std::uint64_t kLightNs = 250'000'000;  // later pictures are too late for interactive steering
constexpr std::uint64_t kSliceNs = 20'000'000;   // of CPU time before another client may have its turn: with eight busy
                                                 // ones each has it within kLightNs
constexpr std::uint64_t kCreditNs = 100'000'000;  // one frame at ten per second
constexpr std::uint64_t kHeavyPart = 4;           // the heavy lane gets one of this many parts under contention
// So at most 4 s times the connections until an account is light again.
constexpr std::uint64_t kOwedNsMax = 2 * kLightNs;
// Debt is forgiven over this many times the time it took, times the number of connections, so all of them together can
// use at most one part in this many without becoming heavy.
constexpr std::uint64_t kForgiveFactor = 16;

struct Account {
  std::uint64_t used_ns = 0;          // CPU time, as charged in its lane
  std::uint64_t owed_ns = 0;          // used for anything but sent rows and not yet forgiven
  std::uint64_t job_ns = 0;           // used for the current frame, which may never be sent
  bool heavy = false, waits = false;  // as of the last choice
  bool known = false;                 // has had work before
  double demand = 0;                  // part of the recent time in which it had work
};

// The lanes of a group of accounts.
struct Lanes {
  std::uint64_t floor_ns[2] = {0, 0};  // used_ns of the account chosen last; [1]: the heavy lane
  std::uint64_t used_ns[2] = {0, 0};   // weighted use of each lane
  bool waits[2] = {false, false};
  double demand[2] = {0, 0};  // of the accounts of each lane
};

inline bool is_heavy(const Account& account) { return account.owed_ns + account.job_ns > kLightNs; }

// Updates an account before a choice; `waits`: it has work.
void note(Lanes* lanes, Account* account, bool waits);
// True if the first of two waiting accounts in the same lane goes first.
inline bool goes_before(const Account& a, const Account& b) { return a.used_ns < b.used_ns; }
// Chooses among the lanes with work.
int choose_lane(Lanes* lanes, bool light_waits, bool heavy_waits);
// Charges CPU time to the account.
void charge(Lanes* lanes, Account* account, std::uint64_t took_ns);

// Adds to the debt: work on messages, or on rows that were never sent.
void owe(Account* account, std::uint64_t took_ns);
// Ends a frame: `sent_ns` of its time went into sent rows. Those of a light frame repay debt.
void end_frame(Account* account, std::uint64_t took_ns, std::uint64_t sent_ns);
// Forgives debt for `passed_ns`, for one of `account_count` accounts.
void forgive(Account* account, std::uint64_t passed_ns, std::uint64_t account_count);

// Prices. A server tells each client how long work takes it now, over how long it takes without other clients, and the
// client's split counts with it: a busy server is dear. The price follows the moving average of the others' demand over
// kDemandNs. An average is needed because the price acts against itself: clients that see it fall ask for more, and
// that raises it. Answering the last frame's price, each would miss its mark by as much as before, on the other side.
constexpr std::uint64_t kDemandNs = 500'000'000;  // chosen: some frames of clients that steer interactively
// tests/split_report/crowd_test.cpp fails without it.

// Takes account of `passed_ns` since the last call, during which the account had work if account->waits.
void observe_demand(Account* account, std::uint64_t passed_ns);
// Starts the sum of a group's demand over; add_demand() of each account completes it.
inline void clear_demand(Lanes* lanes) { lanes->demand[0] = lanes->demand[1] = 0; }
inline void add_demand(Lanes* lanes, const Account& account) { lanes->demand[account.heavy] += account.demand; }
// How long work of the account takes over how long it would take if it were the only one of its group; at least 1.
double crowding(const Lanes& lanes, const Account& account);
// The price of a client as messages have it: its address among the others times its connection among those of its
// address.
std::uint16_t price_of(double address_crowding, double connection_crowding);

// Key of a peer's address from a name like "HOST:PORT": the whole IPv4 address, or the 64-bit network of an IPv6
// address, all of which belongs to one owner [RFC 6177].
std::uint64_t address_key(const char* stream_name);

}  // namespace pocketray
