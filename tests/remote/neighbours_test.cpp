// The effect of other clients on one with light frames, in virtual time: with an emulated CPU and counted pixels and
// messages, the load of this machine does not matter.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "crowd_rig.h"
#include "effect/setting_list.h"
#include "remote/server/state.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

struct FrameTimes {
  double median_ms = 0, longest_ms = 0;
};

// Times of the good client's frames from the first second of the attack on. It comes before the attackers, or after
// they have begun.
FrameTimes frame_times(Attack kind, int attacker_count, Origin origin, bool comes_first = true) {
  ServerRig rig(crowd_options(24));
  AddressBook book(&rig);
  std::unique_ptr<ScriptedClient> good;
  auto come = [&] { good = book.connect(kGoodAddress); };
  if (comes_first) come(), good->wait_for(MessageType::hello);
  AttackCrowd crowd = {&rig, &book, kind, origin};
  crowd.connect(attacker_count);
  FrameRequest request = frame_request("cornell", 0, kGoodWidth, kGoodHeight);
  std::vector<double> times;
  const std::uint64_t start = rig.now(), settled = start + (attacker_count > 0 ? 1000 * kMs : 0);
  std::uint64_t begin = 0;
  const std::size_t wanted = 15;
  rig.run_until(
      [&] {
        crowd.act();
        if (!good && rig.now() - start > 200 * kMs) come();
        if (!good) return false;
        good->poll();
        if (good->closed) FAIL("the good client was closed");
        if (request.frame > 0 && good->rows_come < kGoodHeight) return false;
        std::uint64_t now = rig.now();
        if (request.frame > 0 && begin >= settled) times.push_back(static_cast<double>(now - begin) * 1e-6);
        ++request.frame;
        good->request(request);
        begin = now;
        return times.size() >= wanted;
      },
      200'000 * kMs);
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times.back()};
}

}  // namespace

// Goal: whatever twenty others do, from wherever they come and however often, light frames of a client take at most 1.5
// times as long as alone in the median, and never more than twice, from the first second on. Method: successive frames
// relative to those of the client alone, which comes first or while the attack lasts.
TEST_CASE("neighbours_cost_a_light_client_a_third_of_its_frames_at_most") {
  const double alone = frame_times(Attack::none, 0, Origin::own).median_ms;
  CHECK(alone == doctest::Approx(kGoodWidth * kGoodHeight * kPixelNs * 1e-6).epsilon(0.05));
  struct Case {
    Attack kind;
    const char* name;
    std::vector<Origin> origins;
    bool quick;
  };
  const Case cases[] = {
      {Attack::heavy_frames, "heavy frames", {Origin::own, Origin::the_clients}, true},
      {Attack::given_up, "frames given up", {Origin::own, Origin::the_clients}, false},
      {Attack::given_up_late, "frames given up after some rows", {Origin::own, Origin::the_clients}, true},
      {Attack::views, "view queries", {Origin::own}, true},
      {Attack::pings, "pings", {Origin::own, Origin::the_clients}, true},
      {Attack::fetches, "fetches of a scene", {Origin::own}, false},
      {Attack::small_messages, "small messages", {Origin::own}, false},
      {Attack::silence, "silence", {Origin::own}, false},
      {Attack::views_again, "view queries", {Origin::own, Origin::new_one, Origin::one, Origin::the_clients}, true},
      {Attack::pings_again, "pings", {Origin::own, Origin::new_one, Origin::the_clients}, false},
      {Attack::given_up_again, "frames given up", {Origin::own, Origin::new_one, Origin::the_clients}, true},
  };
  for (const Case& c : cases) {
    if (!c.quick && kEffortDivisor > 1) continue;
    for (const Origin origin : c.origins)
      for (const bool comes_first : {true, false}) {
        const FrameTimes times = frame_times(c.kind, 20, origin, comes_first);
        const std::string name = std::string(c.name) + (is_repeated(c.kind) ? ", each anew" : "") + ", from " +
                                 kOriginNames[static_cast<int>(origin)] + (comes_first ? "" : ", already there");
        MESSAGE("20 neighbours, " << name << ": " << times.median_ms / alone << " times as long, at most "
                                  << times.longest_ms / alone);
        CHECK_MESSAGE(times.median_ms <= 1.5 * alone, name);
        CHECK_MESSAGE(times.longest_ms <= 2 * alone, name);
      }
  }
}

// Goal: twenty others with frames as light as the client's, from one address, have half of the time. Method: as above.
TEST_CASE("neighbours_with_light_frames_share_by_address") {
  const double alone = frame_times(Attack::none, 0, Origin::own).median_ms;
  CHECK(frame_times(Attack::light_frames, 20, Origin::one).median_ms <= 2.1 * alone);
}

// Goal: light without rows makes a client light. Method: the standing of one that asks for a light map alone, before
// and after.
TEST_CASE("server_trusts_who_was_sent_light_alone") {
  ServerRig rig(crowd_options(8));
  ScriptedClient client(&rig);
  client.wait_for(MessageType::hello);
  FrameRequest request = frame_request("cornell", 1, kGoodWidth, kGoodHeight);
  request.settings.indirect = indirect_choice(Effect::instant_radiosity);
  request.light_pitch = 4;
  request.row_begin = request.row_end = 0;
  CHECK_FALSE(is_proven(rig.server->sessions[0].account));
  client.request(request);
  client.wait_for(MessageType::light_map);
  rig.run_until([&] { return is_proven(rig.server->sessions[0].account); }, 100 * kMs);
  CHECK(lane_of(rig.server->sessions[0].account) == Lane::light);
}

// Goal: a view_query measures exposure in slices, so that nobody waits for all of it. Method: the longest busy time of
// the emulated CPU for an exposure of 125 s; a ping answered meanwhile.
TEST_CASE("server_measures_exposures_in_slices") {
  ServerOptions options;
  options.pace.ns_per_pixel = 25e6;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  client.wait_for(MessageType::hello);
  Message query, ping;
  query.type = MessageType::view_query;
  query.view_query.scene = builtin_hash("cube");
  query.view_query.measure_exposure = true;
  query.view_query.settings.width = 999;
  query.view_query.settings.height = 500;
  client.send(query);
  ping.type = MessageType::ping;
  std::uint64_t longest_ns = 0;
  rig.run_until(
      [&] {
        const Work& work = rig.server->work;
        if (work.session >= 0) longest_ns = std::max(longest_ns, work.end_ns - work.begin_ns);
        client.poll();
        return client.has(MessageType::view_entry);
      },
      200'000 * kMs);
  CHECK(longest_ns <= 8 * 25'000'000ull);  // the first ones, with unknown cost
  client.send(ping);
  client.wait_for(MessageType::pong);
}

// Goal: after a failed accept() the listener rests for a while. Method: a link whose accept() fails, with a waiting
// peer; calls in ten seconds, and the log.
TEST_CASE("server_rests_where_it_cannot_accept") {
  static int calls = 0;
  calls = 0;
  ServerRig rig;
  platform::LinkBackend net = platform::kNullLink;
  net.accept = [](platform::Link*, int, int*, platform::Error* error) {
    std::snprintf(error->text, sizeof error->text, "too many files are open");
    ++calls;
    return platform::LinkResult::failed;
  };
  rig.server->net = &net;
  ScriptedClient waiting(&rig);
  std::uint64_t later = rig.now() + 10'000 * kMs;
  rig.run_until([&] { return rig.now() >= later; });
  CHECK(calls >= 9);
  CHECK(calls <= 12);
  CHECK(rig.log.size() <= 12);
  rig.server->net = &platform::kNullLink;
  waiting.wait_for(MessageType::hello);
}

// Goal: frame 0, which means none in an error, cannot be requested. Method: request it.
TEST_CASE("server_refuses_frame_zero") {
  ServerRig rig;
  ScriptedClient client(&rig);
  client.request(frame_request("cube", 0, 16, 12));
  CHECK(client.wait_for(MessageType::error)->message.error.code == WireError::bad_request);
}

// Goal: suddenly expensive pixels do not make a slice long, since cheap pixels before them say little. Method: slice
// time in a room behind a background a thousand times cheaper, with expensive settings; with cheap settings slices have
// their normal length.
TEST_CASE("server_slices_expect_dear_pixels_behind_cheap_ones") {
  CHECK(kSliceNs == 20 * kMs);
  constexpr double kRoomNs = 650'000, kBackgroundNs = 650;
  Settings dear, cheap;
  dear.samples_per_pixel = 16;
  CHECK(slice_pixels(dear, 512, kBackgroundNs, kSliceNs) * kRoomNs < 2.0 * kSliceNs);
  CHECK(slice_pixels(dear, 512, 10 * kRoomNs, kSliceNs) * 10 * kRoomNs <= kSliceNs);
  CHECK(slice_pixels(dear, 512, 1e12, kSliceNs) == 1);
  CHECK(slice_pixels(cheap, 8, 2'000, kSliceNs) == kSliceNs / 2'000);
  double known = kRoomNs;
  for (int i = 0; i < 3; ++i) known = dear_pixel_ns(known, kBackgroundNs);  // left and right of the room
  CHECK(known > 0.6 * kRoomNs);
  CHECK(dear_pixel_ns(known, kRoomNs) == kRoomNs);
}
