// Servers that send wrong pixels with valid checksums are found by spot checks and dropped, and their pixels are not
// shown from then on.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>

#include "engine/frame.h"
#include "platform/entropy.h"
#include "remote/client/parts.h"
#include "remote/client/servers.h"
#include "split_rig.h"
#include "support/effort.h"
#include "support/lying_server.h"
#include "support/test_entropy.h"

using namespace pocketray;

namespace {

constexpr double kHundredth = 0.01;

SplitRigOptions small(std::uint32_t server_count) {
  SplitRigOptions options;
  options.scene = "cube";
  options.width = 32, options.height = 40;
  options.server_count = server_count;
  options.compares = false;
  return options;
}

struct LiarRig {
  SplitRig rig;
  explicit LiarRig(const SplitRigOptions& options) : rig(options) {}
  ~LiarRig() { forget_lies(); }

  RemoteServer& server(std::uint32_t i) { return rig.client.servers[i]; }
  // True if the frame equals that of the device alone.
  bool shows_truth(double seconds) {
    rig.frame(seconds);
    std::vector<std::uint8_t> shown(rig.client.picture.pixels.begin(), rig.client.picture.pixels.end());
    return shown == rig.local_pixels(seconds);
  }
  std::uint32_t rows_of(std::uint32_t i) { return rig.client.share.server_rows[i]; }
  int lines(const std::string& text) {
    int count = 0;
    for (const std::string& line : rig.log) count += line.find(text) != std::string::npos;
    return count;
  }
};

struct Kind {
  const char* name;
  Lie lie;
  int frames_max;  // within which it is found with these seeds
};
const Kind kKinds[] = {
    {"all pixels", [](std::uint32_t, std::uint32_t, std::uint32_t) { return true; }, 3},
    {"one row", [](std::uint32_t, std::uint32_t row, std::uint32_t) { return row == 35; }, 60},
    {"one pixel", [](std::uint32_t, std::uint32_t row, std::uint32_t column) { return row == 36 && column == 7; }, 900},
    {"every third frame", [](std::uint32_t frame, std::uint32_t, std::uint32_t) { return frame % 3 == 0; }, 6},
    {"after the first frames", [](std::uint32_t frame, std::uint32_t, std::uint32_t) { return frame > 9; }, 12},
    {"right in the overture alone", [](std::uint32_t frame, std::uint32_t, std::uint32_t) { return frame > 1; }, 4},
    {"a tenth of the pixels",
     [](std::uint32_t, std::uint32_t row, std::uint32_t column) { return (row + column) % 10 == 0; }, 12},
};

}  // namespace

// Goal: a lying server is found, logged once with proof and never used again, and every frame from then on equals the
// device's own, byte for byte; an honest server stays in use. Method: a liar beside an honest server, both formats, 8
// pixels per frame.
TEST_CASE("verify_drops_a_liar_and_shows_the_truth") {
  for (const Kind& kind : kKinds)
    for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
      if (kEffortDivisor > 1 && (kind.frames_max > 60 || format == WireFormat::rgb888)) continue;
      CAPTURE(kind.name);
      SplitRigOptions options = small(2);
      options.client.format = format;
      options.client.dither = format == WireFormat::rgb565;
      options.client.check_count = 8;
      LiarRig own(options);
      make_liar(&own.rig.world, 1, kind.lie);
      bool all_wrong = kind.frames_max <= 6, truth = true;
      int frame = 0;
      for (; frame < kind.frames_max && !own.server(1).overture.lied; ++frame) {
        truth = own.shows_truth(0.05 * frame);
        CHECK((truth || !all_wrong));
        own.rig.idle(600'000'000);
      }
      REQUIRE(own.server(1).overture.lied);
      CHECK(truth);  // the frame in which it was found
      CHECK(lies_told() > 0);
      CHECK(own.lines("sent wrong pixels and is no longer used: frame") == 1);
      CHECK(own.rig.log.size() == 1);
      for (int i = 0; i < 12; ++i, ++frame) {
        CHECK(own.shows_truth(0.05 * frame));
        CHECK(own.rows_of(1) == 0);
        own.rig.idle(8'000'000'000);  // longer than the first retries after a loss
      }
      CHECK(own.rows_of(0) > 0);
      CHECK(!own.server(0).overture.lied);
      CHECK(own.rig.log.size() == 1);
    }
}

// Goal: the device and other servers replace a liar's rows within the frame. Method: a fast liar and a fast honest
// server; in the frame in which the lie is found, the honest server has replaced the liar's rows.
TEST_CASE("verify_asks_others_anew_within_the_frame") {
  SplitRigOptions options = small(2);
  options.height = 96;
  options.client.check_count = 8;
  LiarRig own(options);
  for (int i = 0; i < 6; ++i) own.rig.frame(0.1 * i);
  std::uint32_t begin = own.rig.client.share.row_begin[1], end = own.rig.client.share.row_end[1];
  REQUIRE(end > begin + 8);
  make_liar(&own.rig.world, 1, kKinds[0].lie);
  CHECK(own.shows_truth(1));
  REQUIRE(own.server(1).overture.lied);
  CHECK(own.rig.client.share.lies == 1);
  CHECK(own.rows_of(1) == 0);
  std::uint32_t taken_over = 0;
  for (std::uint32_t row = begin; row < end; ++row) {
    const MergeRow& merged = own.rig.client.picture.merge.rows[row];
    taken_over += merged.state == RowState::server && merged.server == 0;
  }
  CHECK(taken_over > (end - begin) / 3);
}

// Goal: two liars at once are both found, and without honest servers the device renders alone. Method: all servers lie.
TEST_CASE("verify_does_without_any_server") {
  for (std::uint32_t server_count : {1u, 3u}) {
    SplitRigOptions options = small(server_count);
    options.client.check_count = 8;
    LiarRig own(options);
    for (std::uint32_t i = 0; i < server_count; ++i) make_liar(&own.rig.world, i, kKinds[0].lie);
    for (int i = 0; i < 8; ++i) CHECK(own.shows_truth(0.1 * i));
    for (std::uint32_t i = 0; i < server_count; ++i) CHECK(own.server(i).overture.lied);
    CHECK(own.rig.log.size() == server_count);
    CHECK(own.rig.client.share.device_rows == options.height);
    CHECK(is_settled(own.rig.client));
  }
}

// Goal: a liar is caught as often as the printed probability says. Method: one wrong row in every frame, 3 pixels
// checked; a caught liar is forgiven and reconnected; the count against the sum of catch_probability() over frames,
// within four standard deviations.
TEST_CASE("verify_catches_as_often_as_printed") {
  SplitRigOptions options = small(1);
  options.width = 16, options.height = 24;
  options.client.check_count = 3;
  options.client.retry_ns_min = options.client.retry_ns_max = 1'000'000;
  LiarRig own(options);
  make_liar(&own.rig.world, 0, [](std::uint32_t, std::uint32_t row, std::uint32_t) { return row == 22; });
  double expected = 0, variance = 0;
  int caught = 0;
  for (int i = 0; i < effort(1500); ++i) {
    RemoteServer* s = &own.server(0);
    std::uint32_t* rows = &own.rig.client.verifier.sent_rows[0];
    *rows = 0;
    bool truth = own.shows_truth(0);
    bool found = s->overture.lied;
    if (found) {
      CHECK(truth);
      s->overture.lied = s->overture.told = false;
      own.rig.idle(20'000'000);
    }
    if (*rows == 0) continue;  // or it was caught by a row that both have
    double p = catch_probability({*rows, options.width, 1, 1, 3});
    expected += p, variance += p * (1 - p);
    caught += found;
    if (!found) CHECK(s->checks.caught_row_last == p);
  }
  std::printf("verify: a wrong row in each frame was found %d times, %.1f expected\n", caught, expected);
  CHECK(expected > 10.0 / kEffortDivisor);
  CHECK(std::fabs(caught - expected) <= 4 * std::sqrt(variance) + 1);
}

// Goal: checks take at most a hundredth of the time plus a pixel, and most of that; a device for which one pixel
// exceeds that checks one every few frames. Method: count pixels, each costing what the emulated device takes.
TEST_CASE("verify_costs_a_hundredth_of_the_time") {
  struct Row {
    std::uint32_t width, height;
    int frames;
  };
  for (const Row& row : {Row{64, 96, 60}, Row{16, 12, 400}, Row{20, 12, 400}}) {
    SplitRigOptions options = small(2);
    options.width = row.width, options.height = row.height;
    options.device_ns = 20000, options.server_ns = {4000};
    LiarRig own(options);
    double checked = 0, ns = 0;
    int frames_checked = 0, frames = effort(row.frames);
    for (int i = 0; i < frames; ++i) {
      const FrameShare& share = own.rig.frame(0);
      std::uint32_t pixels = share.checked[0] + share.checked[1];
      checked += pixels, frames_checked += pixels > 0;
      ns += share.measured_ns;
    }
    double share = checked * options.device_ns / ns;
    std::printf("verify: %ux%u: %.2f pixels a frame in %.0f %% of the frames, %.3f %% of the time\n", row.width,
                row.height, checked / frames, 100.0 * frames_checked / frames, 100 * share);
    CHECK(checked * options.device_ns <= kHundredth * ns + options.device_ns);
    CHECK(checked * options.device_ns >= 0.9 * kHundredth * ns - 2 * options.device_ns);
    for (std::uint32_t i = 0; i < 2; ++i) CHECK(!own.server(i).overture.lied);
    CHECK(own.rig.log.empty());
  }
}

// Goal: a slow device that checks a pixel every few frames also finds a liar, and no phase of frames is safe. Method:
// wrong in every third frame, a picture so small that a pixel is more than a hundredth of it.
TEST_CASE("verify_of_a_slow_device_finds_a_liar") {
  SplitRigOptions options = small(1);
  options.width = 16, options.height = 12, options.device_ns = 20000, options.server_ns = {4000};
  LiarRig own(options);
  make_liar(&own.rig.world, 0, kKinds[3].lie);
  int frames = 0;
  while (!own.server(0).overture.lied && frames < 400) own.rig.frame(0), ++frames;
  CHECK(own.server(0).overture.lied);
}

// Goal: checked pixels are unpredictable: they depend only on the system's entropy. Method: the same session with two
// seeds; a system without entropy is refused unless checks are off.
TEST_CASE("verify_pixels_follow_the_entropy") {
  std::vector<Span> picked[3];
  for (int k = 0; k < 3; ++k) {
    SplitRigOptions options = small(1);
    options.client.check_count = 16;
    options.client.entropy = test_random_bytes;
    seed_test_entropy(k == 2 ? 1 : 0);
    LiarRig own(options);
    for (int i = 0; i < 3; ++i) own.rig.frame(0);
    REQUIRE(own.rig.client.share.checked[0] == 16);
    picked[k].assign(own.rig.client.verifier.spans.data, own.rig.client.verifier.spans.data + 16);
  }
  auto equal = [&](int a, int b) {
    int count = 0;
    for (int i = 0; i < 16; ++i)
      count += picked[a][i].row == picked[b][i].row && picked[a][i].column_begin == picked[b][i].column_begin;
    return count;
  };
  CHECK(equal(0, 1) == 16);
  CHECK(equal(0, 2) <= 2);
  Settings settings;
  std::vector<unsigned char> memory(verifier_need(settings) + kArenaAlignment);
  Arena arena = make_arena("verifier", memory.data(), memory.size());
  Verifier verifier;
  Status status = make_verifier(kCheckCountAuto, no_random_bytes, settings, &arena, &verifier);
  CHECK(!status.ok);
  CHECK(std::string(status.message).find("--verify 0") != std::string::npos);
  CHECK(make_verifier(0, no_random_bytes, settings, &arena, &verifier).ok);
}

// Goal: --verify 0 checks nothing and shows what arrives. Method: a liar, every frame.
TEST_CASE("verify_of_no_pixels_checks_nothing") {
  SplitRigOptions options = small(1);
  options.client.check_count = 0;
  LiarRig own(options);
  make_liar(&own.rig.world, 0, kKinds[0].lie);
  bool truth = true;
  for (int i = 0; i < 5; ++i) truth = own.shows_truth(0) && truth;
  CHECK(!truth);
  CHECK(!own.server(0).overture.lied);
  CHECK(own.rig.client.share.checked[0] == 0);
}

// Goal: rows that both have are compared at no cost. Method: rows the device has rendered also come from a server,
// unchanged and with a changed pixel; no pixel check is due.
TEST_CASE("verify_compares_rows_that_both_have") {
  SplitRigOptions options = small(1);
  LiarRig own(options);
  for (int i = 0; i < 3; ++i) own.rig.frame(0);
  Client* c = &own.rig.client;
  RemoteServer* s = &own.server(0);
  std::size_t row_bytes = options.width * pixel_bytes(options.client.format);
  REQUIRE(c->picture.merge.rows[0].state == RowState::device);
  std::memcpy(picture_row(s->decoder->state, 0), merged_row(*c, 0), row_bytes);
  CHECK(agrees_with_device(c, s, 0, 1));
  picture_row(s->decoder->state, 0)[row_bytes - 1] ^= 1;
  CHECK(!agrees_with_device(c, s, 0, 1));
  CHECK(s->overture.lied);
  CHECK(own.lines("row 0, column 31 is") == 1);
}

// Goal: without the scene, two of three servers expose the third as a liar, and frames are correct from then on.
// Method: each of the three in turn; all pixels, one row.
TEST_CASE("verify_without_the_scene_finds_one_liar_of_three") {
  for (std::uint32_t liar : {0u, 1u, 2u})
    for (int kind : {0, 1}) {
      SplitRigOptions options = small(3);
      options.client.has_scene = false;
      options.client.check_count = 1;
      LiarRig own(options);
      make_liar(&own.rig.world, liar, kKinds[kind].lie);
      int frames = 0;
      bool truth = false;
      for (; frames < 400 && !own.server(liar).overture.lied; ++frames) truth = own.shows_truth(0.05 * frames);
      INFO("liar " << liar << ", kind " << kKinds[kind].name << ", frames " << frames << ", rows "
                   << own.rows_of(liar));
      for (const std::string& line : own.rig.log) INFO(line);
      REQUIRE(own.server(liar).overture.lied);
      CHECK(truth);
      CHECK(own.lines("differs from two other servers") == 1);
      CHECK(own.rig.log.size() == 1);
      for (int i = 0; i < 6; ++i) CHECK(own.shows_truth(0.05 * (frames + i)));
      for (std::uint32_t i = 0; i < 3; ++i) CHECK(own.server(i).overture.lied == (i == liar));
      CHECK(!own.rig.client.verifier.disputed);
    }
}

// Goal: with only two servers the liar cannot be told: that is logged once, the picture counts as disputed, and frames
// go on.
TEST_CASE("verify_without_the_scene_tells_of_a_dispute") {
  SplitRigOptions options = small(2);
  options.client.has_scene = false;
  options.client.check_count = 1;
  LiarRig own(options);
  make_liar(&own.rig.world, 1, kKinds[0].lie);
  for (int i = 0; i < 8; ++i) own.rig.frame(0.05 * i);
  CHECK(own.rig.client.verifier.disputed);
  CHECK(own.lines("sent different pixels for row") == 1);
  CHECK(own.rig.log.size() == 1);
  CHECK(!own.server(0).overture.lied);
  CHECK(!own.server(1).overture.lied);
}

// Goal: honest servers are never accused, and comparing them takes at most a hundredth of the time and one answer.
// Method: 60 frames of a moving scene without the scene, two and three servers; the longest answer counts.
TEST_CASE("verify_without_the_scene_trusts_the_honest") {
  for (std::uint32_t server_count : {2u, 3u}) {
    SplitRigOptions options = small(server_count);
    options.client.has_scene = false;
    options.height = 96;
    options.server_ns = {3000};
    LiarRig own(options);
    std::uint64_t checked = 0;
    for (int i = 0; i < effort(60); ++i) {
      CHECK(own.shows_truth(0.05 * i));
      for (std::uint32_t s = 0; s < server_count; ++s) checked += own.rig.client.share.checked[s];
    }
    CHECK(checked > 0);
    CHECK(checked < 60 * server_count);
    CHECK(own.rig.log.empty());
    CHECK(!own.rig.client.verifier.disputed);
  }
}

// Goal: the commands use the system's entropy, refuse an invalid number of pixels, and remember a liar when the scene
// is reopened. Method: clients made by the backend, twice, without a listener.
TEST_CASE("verify_as_the_commands_start_it") {
  ServersOptions options;
  options.addresses = {"127.0.0.1:9", "127.0.0.1:10"};
  Servers* servers = nullptr;
  for (int wrong : {-2, 1025, 1 << 30}) {
    options.verify = wrong;
    Status status = kRenderServers.open(options, nullptr, &servers);
    CHECK(!status.ok);
    CHECK(std::string(status.message).find("--verify is") != std::string::npos);
  }
  options.verify = 5;
  Status status = kRenderServers.open(options, nullptr, &servers);
  REQUIRE_MESSAGE(status.ok, status.message);
  Renderer r;
  r.settings.width = 64, r.settings.height = 48;
  std::vector<unsigned char> memory(kRenderServers.need(*servers, r.settings) + kArenaAlignment);
  std::uint64_t state = 0;
  for (int i = 0; i < 2; ++i) {
    r.memory.frame = make_arena("frame", memory.data(), memory.size());
    REQUIRE(kRenderServers.start(servers, &r, false, false).ok);
    const Client& c = connected(servers)->client;
    CHECK((c.options.entropy == platform::random_bytes));
    CHECK(c.verifier.check_count == 5);
    CHECK(c.verifier.random.state != state);
    state = c.verifier.random.state;
    CHECK(!c.servers[0].overture.lied);
    CHECK(c.servers[1].overture.lied == (i == 1));
    connected(servers)->client.servers[1].overture.lied = true;
  }
  kRenderServers.close(servers);
  options.addresses.clear();
  CHECK(!kRenderServers.open(options, nullptr, &servers).ok);
}
