// Who gets a place on a server, and who makes way.
#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "client_count.h"
#include "crowd_rig.h"

using namespace pocketray;

// Goal: silent clients give way to others. Method: eight that only say hello, from eight addresses; a ninth is told
// that the server is busy, and admitted once they have been silent for ten seconds.
TEST_CASE("server_gives_the_place_of_who_is_silent_to_who_comes") {
  ServerRig rig;
  AddressBook book(&rig);
  std::vector<std::unique_ptr<ScriptedClient>> silent;
  for (int i = 0; i < 8; ++i) silent.push_back(book.connect(1 + i));
  rig.run_until([&] { return client_count(*rig.server) == 8; });
  CHECK(book.connect(9)->wait_for(MessageType::error)->message.error.code == WireError::busy);
  std::uint64_t later = rig.now() + 10'000 * kMs;
  rig.run_until([&] { return rig.now() >= later; });
  const std::unique_ptr<ScriptedClient> ninth = book.connect(9);
  ninth->request(frame_request("cube", 1, 16, 12));
  ninth->wait_for_rows(12);
  CHECK(client_count(*rig.server) == 8);
  rig.run_until([&] { return silent[0]->poll(), silent[0]->closed; });
  CHECK(silent[0]->has_error(WireError::busy));
}

// Goal: one address cannot keep others out, however busy its clients are. Method: eight from one address with frames in
// progress; two from other addresses get in, a ninth from the first does not.
TEST_CASE("server_gives_no_address_all_places_for_long") {
  ServerOptions options;
  options.pace.ns_per_pixel = 100'000;
  ServerRig rig(options);
  AddressBook book(&rig);
  std::vector<std::unique_ptr<ScriptedClient>> many;
  for (int i = 0; i < 8; ++i) {
    many.push_back(book.connect(1));
    many.back()->request(frame_request("cube", 1, 320, 240));
  }
  rig.run_until([&] { return client_count(*rig.server) == 8; });
  for (int i = 0; i < 2; ++i) {
    many.push_back(book.connect(2 + i));
    many.back()->request(frame_request("cube", 1, 16, 12));
    many.back()->wait_for_rows(12);
  }
  CHECK(book.connect(1)->wait_for(MessageType::error)->message.error.code == WireError::busy);
  CHECK(client_count(*rig.server) == 8);
}

// Goal: whoever opens connections without a hello has half of the guests' places at most, so that a client from
// elsewhere gets in at once, and its own oldest ones make way. Method: a flood from one address, then a client.
TEST_CASE("server_keeps_guests_places_for_other_addresses") {
  ServerRig rig;
  const int half = ServerOptions().guest_count_max / 2;
  std::vector<int> flood;
  auto is_open = [&](int stream) {
    char byte[64];
    std::size_t count = 0;
    platform::Error error;
    platform::LinkResult result = platform::LinkResult::done;
    while (result == platform::LinkResult::done)
      result = rig.net->read(rig.link, stream, byte, sizeof byte, &count, &error);
    return result == platform::LinkResult::later;
  };
  for (int i = 0; i < 3 * half; ++i) {
    platform::Error error;
    int stream = platform::null_link_connect_from(rig.link, "10.0.0.7", rig.address, 1000 * kMs, &error);
    REQUIRE_MESSAGE(stream >= 0, error.text);
    flood.push_back(stream);
    rig.step();
    rig.step();
  }
  for (int i = 0; i < 3 * half; ++i) {
    CAPTURE(i);
    CHECK_EQ(is_open(flood[static_cast<std::size_t>(i)]), i >= 2 * half);
  }
  ScriptedClient client(&rig);
  client.wait_for(MessageType::hello, 100 * kMs);
  for (int i = 2 * half; i < 3 * half; ++i) CHECK(is_open(flood[static_cast<std::size_t>(i)]));
  for (int stream : flood) rig.net->close(rig.link, stream);
}
