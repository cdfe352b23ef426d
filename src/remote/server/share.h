// Whose turn it is on the server's CPU: first among addresses, then among the connections of one. Pure; times are what
// work took by the link's clock.
//
// Work is in two lanes. The light lane has whoever is done soon: frames of no more than kLightNs. The heavy lane has
// the rest: longer frames, what was rendered and then not sent, and whoever asks and asks for other things. While both
// have something to do, the light lane gets kHeavyPart - 1 of kHeavyPart turns, counted in time. Within a lane the one
// goes first that has used the CPU least [Goyal et al. 1996, start-time fair queueing]; who has been away is owed the
// turns of kCreditNs at most, who is new none.
#pragma once
#include <cstdint>

namespace pocketray {

constexpr std::uint64_t kLightNs = 250'000'000;   // a picture that comes later is no longer one that a person steers by
constexpr std::uint64_t kCreditNs = 100'000'000;  // a frame of ten a second
constexpr std::uint64_t kHeavyPart = 4;           // the heavy lane's is one of so many parts, if it comes to that
constexpr std::uint64_t kOwedNsMax = 2 * kLightNs;
// What is owed is forgiven in so many times as long as it took, times the number of connections: what all of them
// together can use without being heavy is one part of so many, too.
constexpr std::uint64_t kForgiveFactor = 16;

struct Account {
  std::uint64_t used_ns = 0;          // of the CPU, by the reckoning of its lane
  std::uint64_t owed_ns = 0;          // used for other things than rows that were sent, and not forgiven yet
  std::uint64_t job_ns = 0;           // used for the frame under way: not sent yet, perhaps never
  bool heavy = false, waits = false;  // at the last choice
  bool known = false;                 // has had something to do before
};

// The lanes that some accounts share.
struct Lanes {
  std::uint64_t floor_ns[2] = {0, 0};  // what the one had used that was chosen last; [1]: the heavy lane
  std::uint64_t used_ns[2] = {0, 0};   // by the lane, weighted
  bool waits[2] = {false, false};
};

inline bool is_heavy(const Account& account) { return account.owed_ns + account.job_ns > kLightNs; }

// Looks at an account before a choice: whether it has something to do now.
void note(Lanes* lanes, Account* account, bool waits);
// Of two accounts that were noted and have something to do, whether the first goes before the second in the same lane.
inline bool goes_before(const Account& a, const Account& b) { return a.used_ns < b.used_ns; }
// The lane that goes first of those that have something to do.
int choose_lane(Lanes* lanes, bool light_waits, bool heavy_waits);
// The account has had the CPU for so long.
void charge(Lanes* lanes, Account* account, std::uint64_t took_ns);

// What work counts as: for messages or in vain, or for the frame under way.
void owe(Account* account, std::uint64_t took_ns);
// The frame is at its end: `sent_ns` of what it took went into rows that were sent. Those of a light frame pay for what
// was owed.
void end_frame(Account* account, std::uint64_t took_ns, std::uint64_t sent_ns);
// So much time has passed for one of `account_count` accounts.
void forgive(Account* account, std::uint64_t passed_ns, std::uint64_t account_count);

// What stands for a peer's address in a name like "HOST:PORT": all of an IPv4 address, of an IPv6 one the network of 64
// bits that whoever has one has as a whole [RFC 6177].
std::uint64_t address_key(const char* stream_name);

}  // namespace pocketray
