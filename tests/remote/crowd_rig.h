// A server of the simulated world among attackers from many addresses, with an emulated CPU and counted pixels and
// messages, so that the load of this machine does not matter.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "support/scripted_client.h"

namespace pocketray {

constexpr std::uint64_t kPixelNs = 50'000;
// Frames of the client beside the attackers.
constexpr std::uint32_t kGoodWidth = 40, kGoodHeight = 30;

enum class Attack {
  none,
  heavy_frames,   // of 8 s each
  given_up,       // replaced after a while
  given_up_late,  // and after some rows have come
  views,          // with measured exposure
  pings,          // with the largest answers
  fetches,        // of a scene
  small_messages,
  silence,       // holds a place and nothing else
  light_frames,  // as light as the good client's
  // On a connection of its own each:
  views_again,
  pings_again,
  given_up_again,
};
// Returns whether each attack comes on a new connection.
inline bool is_repeated(Attack kind) { return kind >= Attack::views_again; }

// Where each attacker's connections come from.
enum class Origin { own, new_one, one, the_clients };
extern const char* const kOriginNames[];

// Gives connections addresses, as the simulated link has only one. One at a time.
class AddressBook {
 public:
  explicit AddressBook(ServerRig* rig);
  ~AddressBook();
  AddressBook(const AddressBook&) = delete;
  AddressBook& operator=(const AddressBook&) = delete;
  // Connects from 10.0.0.`address`.
  std::unique_ptr<ScriptedClient> connect(int address);
  int connection_count() const { return static_cast<int>(addresses_.size()); }

 private:
  static const char* name(const platform::Link* link, int stream);
  ServerRig* rig_;
  platform::LinkBackend net_ = platform::kNullLink;
  std::vector<int> addresses_;  // of connections in order of creation
};

struct Attacker {
  std::unique_ptr<ScriptedClient> client;
  std::uint32_t frame = 0;
  std::uint64_t asked_ns = 0, begun_ns = 0;
  std::size_t waiting = 0;
};

// Options of a server whose pixels and messages take counted time.
ServerOptions crowd_options(int client_count_max);

struct AttackCrowd {
  ServerRig* rig;
  AddressBook* book;
  Attack kind;
  Origin origin;
  bool comes_back = false;  // whoever is refused connects again; false: refusals fail the test
  std::vector<Attacker> attackers;

  void connect(int attacker_count);
  // Each attacker does what comes next.
  void act();
};
// The client's address, which attackers may share.
constexpr int kGoodAddress = 1;

}  // namespace pocketray
