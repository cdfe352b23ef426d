// Schedules the server's CPU: first among addresses, then among the connections of one. Pure; times are work by the
// link's clock.
//
// There are three lanes. The light lane serves accounts that have been sent light frames, of at most kLightNs, and owe
// little; of frames abandoned midway, only the sent part counts. The newcomers' lane serves accounts that have not,
// until they have used kNewcomerNs. The heavy lane serves the rest: longer frames, rendered but unsent rows, and floods
// of other requests. While both have work, the light lane gets kBehindPart - 1 of kBehindPart turns, measured in time,
// and the other two share the rest in equal proportion. The longest-seated newcomer goes first, so newcomers that keep
// returning only wait for each other. In the other lanes the account that has used the least CPU goes first [Goyal et
// al. 1996, start-time fair queueing]; one that was away is credited at most kCreditNs, a new one nothing.
#pragma once
#include <cstdint>

namespace pocketray {

// Chosen as stated; tests/remote/neighbours_test.cpp measures the result: a light client loses at most a third of its
// frame rate to twenty others, whatever they request and however often they come.
constexpr std::uint64_t kLightNs = 250'000'000;  // later pictures are too late for interactive steering
constexpr std::uint64_t kSliceNs = 20'000'000;   // of CPU time before another client may have its turn: with eight busy
                                                 // ones each has it within kLightNs
constexpr std::uint64_t kShortSliceNs = 4'000'000;  // where an account of a better lane may be about to request: of a
                                                    // frame of 4 ms, half is waited for on average
constexpr std::uint64_t kCreditNs = 100'000'000;    // one frame at ten per second
constexpr std::uint64_t kBehindPart = 4;            // the lanes behind get one of this many parts under contention
// Chosen: the first frame of a small screen with its preparation. Of twenty newcomers, the last waits one second.
constexpr std::uint64_t kNewcomerNs = 50'000'000;
// Factor on the time of a newcomer's messages in its debt. It sends few before its first frame, so that floods are
// recognised sooner than frames.
constexpr std::uint64_t kNewcomerMessages = 4;
// An account may owe this many times the time of its light frames and still be light. Chosen: a light client abandons
// frames while it steers; a tiny frame buys no flood.
constexpr std::uint64_t kTrustFactor = 4;
// Thus at most 4 s times the number of connections until an account is light again.
constexpr std::uint64_t kOwedNsMax = 2 * kLightNs;
// Debt is forgiven over this many times the time it took, times the number of connections, so that all of them together
// can use at most one part in this many without becoming heavy.
constexpr std::uint64_t kForgiveFactor = 16;

enum class Lane : std::uint8_t { light, newcomer, heavy };
constexpr int kLaneCount = 3;

struct Account {
  std::uint64_t used_ns = 0;    // CPU time, as charged in its lane
  std::uint64_t owed_ns = 0;    // spent on anything but sent rows and not yet forgiven
  std::uint64_t job_ns = 0;     // spent on the current frame, which may never be sent
  std::uint64_t earned_ns = 0;  // spent on light frames that were sent; counted up to kLightNs
  std::uint64_t seat = 0;       // smaller: seated earlier
  Lane lane = Lane::newcomer;   // as of the last choice
  bool waits = false;           // as of the last choice
  bool known = false;           // has had work before
  double demand = 0;            // fraction of the recent time in which it had work
};

// Turns of two sides: of every kBehindPart, the second gets one while both wait.
struct Turns {
  std::uint64_t used_ns[2] = {0, 0};  // weighted
  bool waits[2] = {false, false};
};

// Lanes of a group of accounts.
struct Lanes {
  std::uint64_t floor_ns[kLaneCount] = {0, 0, 0};  // used_ns of the account chosen last
  Turns light;                                     // the light lane before the others
  Turns behind;                                    // newcomers before heavy accounts
  double demand[2] = {0, 0};                       // of the accounts that are not heavy; of the heavy ones
};

inline bool is_heavy(const Account& account) { return account.lane == Lane::heavy; }
// True if the account has been sent light frames.
inline bool is_proven(const Account& account) { return account.earned_ns > 0; }
// Lane of an account with its present debt.
Lane lane_of(const Account& account);
// Its debt with `more_ns`, if above its lane's limit; 0: it behaves. A frame in progress may yet be light.
std::uint64_t offence_ns(const Account& account, std::uint64_t more_ns);

// Updates an account before a choice; `waits`: it has work.
void note(Lanes* lanes, Account* account, bool waits);

// First waiting account of each lane. Filled by consider().
struct Choice {
  int first[kLaneCount] = {-1, -1, -1};  // -1: none
  const Account* accounts[kLaneCount] = {nullptr, nullptr, nullptr};
};
void consider(Choice* choice, int index, const Account& account);
// Returns the account whose turn it is; -1: nobody waits.
int choose(Lanes* lanes, const Choice& choice);
// Charges CPU time to the account.
void charge(Lanes* lanes, Account* account, std::uint64_t took_ns);

// Adds to the debt the time of messages, or of rows that were never sent.
void owe_messages(Account* account, std::uint64_t took_ns);
void owe(Account* account, std::uint64_t took_ns);
// Ends a frame: `sent_ns` of its time went into sent rows. Those of a light frame repay debt. `build_ns` of it prepared
// more than this frame; it adds to the debt, but makes no frame heavy.
void end_frame(Account* account, std::uint64_t took_ns, std::uint64_t sent_ns, std::uint64_t build_ns = 0);
// Forgives debt for `passed_ns`, for one of `account_count` accounts.
void forgive(Account* account, std::uint64_t passed_ns, std::uint64_t account_count);

// Prices. A server tells each client how much longer work takes now than without other clients, and the client's split
// accounts for it: a busy server is expensive. The price follows the moving average of the others' demand over
// kDemandNs. An average is needed because the price acts against itself: clients that see it fall request more, which
// raises it. Reacting to the last frame's price, each would miss its mark by as much as before, on the other side.
constexpr std::uint64_t kDemandNs = 500'000'000;  // chosen: some frames of clients that steer interactively
// tests/split_report/crowd_test.cpp fails without it.

// Accounts for `passed_ns` since the last call, during which the account had work if account->waits.
void observe_demand(Account* account, std::uint64_t passed_ns);
// Resets the sum of a group's demand; add_demand() of each account completes it.
inline void clear_demand(Lanes* lanes) { lanes->demand[0] = lanes->demand[1] = 0; }
inline void add_demand(Lanes* lanes, const Account& account) { lanes->demand[is_heavy(account)] += account.demand; }
// Time of the account's work relative to its time alone in its group; at least 1.
double crowding(const Lanes& lanes, const Account& account);
// A client's price as in messages: its address among the others times its connection among those of its
// address.
std::uint16_t price_of(double address_crowding, double connection_crowding);

// Key of a peer's address from a name like "HOST:PORT": the whole IPv4 address, or the 64-bit network of an IPv6
// address, all of which belongs to one owner [RFC 6177].
std::uint64_t address_key(const char* stream_name);

}  // namespace pocketray
