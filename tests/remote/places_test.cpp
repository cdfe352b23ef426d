// Who gets a place on a server, and who makes way.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "client_count.h"
#include "crowd_rig.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

struct Visit {
  double first_ms = 0;              // from its arrival to the last row of its first frame
  double longest_ms = 0;            // of later frames
  int refusal_count = 0, lost = 0;  // times that it was turned away before it had a place, and that it lost one
};

// A client comes to a server whose eight places twenty attackers have held for a second, and comes again every 50 ms
// until it has one.
Visit visit(Attack kind, Origin origin, int attacker_count = 20) {
  ServerRig rig(crowd_options(8));
  AddressBook book(&rig);
  AttackCrowd crowd = {&rig, &book, kind, origin, true};
  crowd.connect(attacker_count);
  std::unique_ptr<ScriptedClient> good;
  FrameRequest request = frame_request("cornell", 0, kGoodWidth, kGoodHeight);
  Visit result;
  const std::uint64_t arrival = rig.now() + 1000 * kMs;
  std::uint64_t begin = arrival, next_try = arrival;
  int frame_count = 0;
  auto ask = [&] {
    begin = rig.now();
    ++request.frame;
    good->request(request);
  };
  rig.run_until(
      [&] {
        crowd.act();
        if (rig.now() < next_try) return false;
        if (!good) good = book.connect(kGoodAddress), ask();
        good->poll();
        if (good->closed || good->has(MessageType::error)) {
          ++(frame_count > 0 ? result.lost : result.refusal_count);
          good = nullptr;
          next_try = rig.now() + 50 * kMs;
          return rig.now() > arrival + 30'000 * kMs;
        }
        if (good->rows_come < kGoodHeight) return false;
        const double took = static_cast<double>(rig.now() - (frame_count == 0 ? arrival : begin)) * 1e-6;
        double* longest = frame_count++ == 0 ? &result.first_ms : &result.longest_ms;
        *longest = std::max(*longest, took);
        ask();
        return frame_count == 31;
      },
      100'000 * kMs);
  if (frame_count == 0) result.first_ms = 1e9;
  return result;
}

}  // namespace

// Goal: whoever misbehaves makes way for a client that comes later, which keeps its place. Method: attackers of each
// kind hold all places and come back when they are refused; the time to the client's first frame, and of thirty more.
TEST_CASE("server_gives_the_places_of_who_misbehaves_to_who_comes") {
  struct Case {
    Attack kind;
    const char* name;
    std::vector<Origin> origins;
    double first_ms;  // at most
  };
  const std::vector<Origin> others = {Origin::own, Origin::new_one, Origin::one};
  std::vector<Origin> all = others;
  all.push_back(Origin::the_clients);
  const Case cases[] = {
      {Attack::heavy_frames, "heavy frames", all, 1000},
      {Attack::given_up, "frames given up", all, 1000},
      {Attack::given_up_late, "frames given up after some rows", all, 1000},
      {Attack::views, "view queries", all, 1000},
      {Attack::pings, "pings", all, 1000},
      {Attack::fetches, "fetches", all, 1000},
      {Attack::silence, "silence", {Origin::own}, 2500},
      {Attack::views_again, "view queries, each anew", others, 1000},
      {Attack::given_up_again, "frames given up, each anew", others, 1000},
  };
  const double alone = visit(Attack::none, Origin::own, 0).longest_ms;
  for (const Case& c : cases)
    for (const Origin origin : c.origins) {
      if (kEffortDivisor > 1 && origin != Origin::own) continue;
      const Visit v = visit(c.kind, origin);
      const std::string name = std::string(c.name) + ", from " + kOriginNames[static_cast<int>(origin)];
      MESSAGE(name << ": first frame after " << v.first_ms << " ms, " << v.refusal_count << " refusals; then at most "
                   << v.longest_ms / alone << " times as long, " << v.lost << " places lost");
      CHECK_MESSAGE(v.first_ms <= c.first_ms, name);
      CHECK_MESSAGE(v.longest_ms <= 3 * alone, name);
      CHECK_MESSAGE(v.lost == 0, name);
    }
}

// Goal: silent clients give way to others. Method: eight that have had a frame, from eight addresses; a ninth is told
// that the server is busy, and admitted once they have been silent for ten seconds.
TEST_CASE("server_gives_the_place_of_who_is_silent_to_who_comes") {
  ServerRig rig;
  AddressBook book(&rig);
  std::vector<std::unique_ptr<ScriptedClient>> silent;
  for (int i = 0; i < 8; ++i) {
    silent.push_back(book.connect(1 + i));
    silent.back()->request(frame_request("cube", 1, 16, 12));
    silent.back()->wait_for_rows(12);
  }
  CHECK(book.connect(9)->wait_for(MessageType::error)->message.error.code == WireError::busy);
  std::uint64_t later = rig.now() + 10'000 * kMs;
  rig.run_until([&] { return rig.now() >= later; });
  const std::unique_ptr<ScriptedClient> ninth = book.connect(9);
  ninth->request(frame_request("cube", 1, 16, 12));
  ninth->wait_for_rows(12);
  CHECK(client_count(*rig.server) == 8);
  rig.run_until([&] {
    for (auto& client : silent) client->poll();
    return std::any_of(silent.begin(), silent.end(), [](auto& client) { return client->closed; });
  });
  for (auto& client : silent) CHECK(client->closed == client->has_error(WireError::busy));
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
