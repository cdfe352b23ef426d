// A server on several ranks: pixels, order, cancelled frames, and ranks that fail or lie.
#include <algorithm>
#include <cstring>

#include "base/rng.h"
#include "support/effort.h"
#include "virtual_ranks.h"

using namespace pocketray;

namespace {

ServerOptions small_options(CoherenceMode mode = CoherenceMode::off) {
  ServerOptions options;
  options.client_count_max = 2, options.guest_count_max = 2;
  options.client_memory_bytes = 8u << 20;
  options.image_side_max = 256;
  options.coherence = mode;
  return options;
}

// Unequal speeds: some answer at once, others after many looks.
void set_speeds(Rng* rng, VirtualRanks* ranks) {
  for (auto& seat : ranks->seats) seat->looks_per_message = 1 + next_u32(rng) % 3 * (next_u32(rng) % 20);
}

// Random order of all rows.
void set_order(Rng* rng, FrameRequest* request) {
  request->chunk_rows = static_cast<std::uint16_t>(1 + next_u32(rng) % 12);
  request->run_count = 0;
  for (std::uint32_t left = request->settings.height; left > 0;) {
    const std::uint32_t rows = std::min(left, 1 + next_u32(rng) % 20), i = request->run_count++;
    request->runs[i] = {static_cast<std::uint8_t>(rows), static_cast<std::uint8_t>(i)};
    std::swap(request->runs[i].place, request->runs[next_u32(rng) % (i + 1)].place);
    left -= rows;
  }
}

void check_order(const FrameRequest& request, const ScriptedClient& client) {
  RowSequence at = first_rows(request);
  for (const RowChunk& chunk : client.chunks) {
    CHECK(chunk.row_begin + chunk.row_count == at.row_end);
    REQUIRE(chunk.row_count == next_chunk_rows(request, at));
    pass_rows(request, chunk.row_count, &at);
  }
  CHECK(!has_rows(at));
}

bool too_slow() {
  constexpr bool kSlow = kEffortDivisor > 6;
  if (kSlow) MESSAGE("skipped: it takes minutes under emulation");
  return kSlow;
}

std::uint32_t traced(const ScriptedClient& client) {
  std::uint32_t count = 0;
  for (const RowChunk& chunk : client.chunks)
    count += chunk.traced * chunk.row_count * client.decoder->state.shape.width / 255;
  return count;
}

struct ClusterRig {
  VirtualRanks ranks;
  ServerRig rig;
  ClusterRig(std::uint32_t count, const ServerOptions& options,
             const std::function<void(std::uint32_t, ServerOptions*)>& adapt = {}, std::uint64_t shared_ns_min = 0)
      : ranks(count, options, adapt, shared_ns_min),
        rig(welcomed(&ranks), platform::NullLinkSettings(), platform::kNullLink, small_store()) {}

 private:
  static ServerOptions welcomed(VirtualRanks* ranks) {
    Status status = ranks->welcome();
    REQUIRE_MESSAGE(status.ok, status.message);
    return ranks->options;
  }
};

}  // namespace

// Goal: pixels and their order are those of one server, whatever ranks there are, and helpers trace a part. Method: 1
// to 64 ranks of unequal speed, random orders of a moving scene's rows, with and without coherence.
TEST_CASE("cluster_sends_the_rows_of_one_server_in_the_order_asked_for") {
  if (too_slow()) return;
  Rng rng = make_rng(43);
  for (std::uint32_t count : {1u, 2u, 3u, 64u})
    for (CoherenceMode mode : {CoherenceMode::off, CoherenceMode::on}) {
      CAPTURE(count);
      CAPTURE(static_cast<int>(mode));
      ClusterRig c(count, small_options(mode));
      ScriptedClient client(&c.rig);
      for (std::uint32_t frame = 1; frame <= static_cast<std::uint32_t>(effort(8)); ++frame) {
        set_speeds(&rng, &c.ranks);
        FrameRequest request = frame_request("seesaw", frame, 64, 96);
        request.seconds = frame / 2 * 0.25;
        request.format = frame % 3 == 0 ? WireFormat::rgb565 : WireFormat::rgb888;
        request.dither = request.coarse_first = frame % 2 == 0;
        set_order(&rng, &request);
        client.request(request);
        client.wait_for_rows(96);
        CHECK(client.picture() == rendered_here(request));
        if (request.coarse_first) {
          const auto come = client.wait_for(MessageType::coarse_picture);
          const auto& pixels = come->message.coarse_picture.pixels;
          CHECK(std::vector<std::uint8_t>(pixels.begin(), pixels.end()) == squares_of(client.picture(), request));
        }
        check_order(request, client);
        CHECK((traced(client) == 64 * 96 || mode == CoherenceMode::on));
      }
      CHECK((c.ranks.lead->helped_share() > 0) == (count > 1));
      CHECK(c.ranks.log.empty());
    }
}

// Goal: helpers take the exposure that rank 0 has measured. Method: a scene without one; another view of it afterwards.
TEST_CASE("cluster_has_one_exposure") {
  if (too_slow()) return;
  ClusterRig c(3, small_options());
  ScriptedClient client(&c.rig);
  FrameRequest request = frame_request("seesaw", 1, 64, 96);
  request.scene = small_store().scenes.back().hash;
  for (request.frame = 1; request.frame <= 3; ++request.frame) {
    request.seconds = request.frame;
    client.request(request);
    client.wait_for_rows(96);
    CHECK(client.picture() == rendered_here(request, small_store()));
  }
  CHECK(c.ranks.lead->helped_share() > 0.1);
}

// Goal: expensive rows are given in parts. Method: pixels that by their settings could take .3 ms, however fast they
// are.
TEST_CASE("cluster_shares_parts_of_expensive_rows") {
  if (too_slow()) return;
  ClusterRig c(3, small_options());
  ScriptedClient client(&c.rig);
  int part_count = 0;
  c.ranks.change = [&](std::uint32_t, std::vector<std::uint8_t>* bytes) {
    part_count += (*bytes)[0] == kTraced && bytes->size() == 1 + sizeof(ClusterTraced);
    return true;
  };
  FrameRequest request = frame_request("cube", 1, 64, 24);
  request.settings.points_per_area_light = 256;
  request.settings.samples_per_pixel = 16;
  client.request(request);
  client.wait_for_rows(24);
  CHECK(client.picture() == rendered_here(request));
  CHECK(c.ranks.lead->helped_share() > 0.2);
  CHECK(part_count > 24);
}

// Goal: a rank keeps its rows for the next frame. Method: a still view again, and one in which little moves.
TEST_CASE("cluster_traces_only_what_changed") {
  if (too_slow()) return;
  ClusterRig c(3, small_options(CoherenceMode::on));
  ScriptedClient client(&c.rig);
  FrameRequest request = frame_request("seesaw", 1, 128, 96);
  std::uint32_t counts[4];
  for (std::uint32_t i = 0; i < 4; ++i) {
    request.frame = 1 + i;
    request.seconds = i < 2 ? 0.5 : 0.5 + i / 60.0;
    client.request(request);
    client.wait_for_rows(96);
    CHECK(client.picture() == rendered_here(request));
    counts[i] = traced(client);
  }
  CHECK(counts[0] == 128 * 96);
  CHECK(counts[1] == 0);
  CHECK(counts[3] < 128 * 96 / 2);
}

// Goal: frames with little work are rank 0's alone, the first excepted, and are shared again once there is more.
// Method: a limit that no frame reaches, whatever the machine, and then none.
TEST_CASE("cluster_does_not_share_what_is_soon_done") {
  if (too_slow()) return;
  for (std::uint64_t limit : {~std::uint64_t(0) / 4, std::uint64_t(0)}) {
    ClusterRig c(3, small_options(CoherenceMode::on), {}, limit);
    ScriptedClient client(&c.rig);
    FrameRequest request = frame_request("seesaw", 1, 128, 96);
    std::uint64_t messages[6];
    for (std::uint32_t i = 0; i < 6; ++i) {
      request.frame = 1 + i;
      request.seconds = i / 30.0;
      messages[i] = c.ranks.message_count;
      client.request(request);
      client.wait_for_rows(96);
      CHECK(client.picture() == rendered_here(request));
    }
    CHECK(messages[1] > messages[0]);
    CHECK((messages[5] > messages[2]) == (limit == 0));
    CHECK(traced(client) < 128 * 96 / 2);
  }
}

// Goal: a new request replaces the old one, whose late rows are ignored; two clients at once get their own rows.
// Method: slow ranks; requests of another size, camera and time before the last is complete.
TEST_CASE("cluster_ignores_late_rows_of_a_cancelled_frame") {
  if (too_slow()) return;
  Rng rng = make_rng(44);
  ClusterRig c(4, small_options(CoherenceMode::automatic));
  ScriptedClient client(&c.rig), other(&c.rig);
  for (std::uint32_t frame = 1; frame <= static_cast<std::uint32_t>(effort(12)); ++frame) {
    set_speeds(&rng, &c.ranks);
    FrameRequest request = frame_request(frame % 2 ? "seesaw" : "cube", 2 * frame - 1, 64, frame % 3 ? 96 : 48);
    request.seconds = frame * 0.1;
    FrameRequest second = frame_request("seesaw", frame, 48, 48);
    second.seconds = frame;
    client.request(request);
    other.request(second);
    const std::uint32_t some = next_u32(&rng) % 40;
    c.rig.run_until([&] { return client.poll(), client.rows_come >= some; });
    request.frame = 2 * frame;
    request.seconds += 0.5;
    if (frame % 4 == 0) request.settings.width = 80;
    client.request(request);
    client.wait_for_rows(request.settings.height);
    other.wait_for_rows(48);
    CHECK(client.picture() == rendered_here(request));
    CHECK(other.picture() == rendered_here(second));
  }
  CHECK(c.ranks.log.empty());
}

// Goal: a rank that answers what it was not asked is reported in one line and gets no more rows; every pixel is right.
// Method: other rows, another frame, rows that are missing or too many, an answer twice, no message at all.
TEST_CASE("cluster_does_without_a_rank_that_lies") {
  if (too_slow()) return;
  for (int lie = 0; lie < 7; ++lie) {
    CAPTURE(lie);
    ClusterRig c(3, small_options());
    ScriptedClient client(&c.rig);
    int answers = 0;
    c.ranks.change = [&](std::uint32_t rank, std::vector<std::uint8_t>* bytes) {
      if (rank != 2 || (*bytes)[0] != kTraced || ++answers < 3) return true;
      ClusterTraced traced;
      std::memcpy(&traced, bytes->data() + 1, sizeof traced);
      if (lie == 0) traced.asked.piece.row_begin += 1000, traced.asked.piece.row_end += 1000;
      if (lie == 1) traced.asked.piece.row_end = ~0u;
      if (lie == 2) ++traced.asked.job.number;
      if (lie == 3) traced.asked.job.session = 1000;
      std::memcpy(bytes->data() + 1, &traced, sizeof traced);
      if (lie == 4) bytes->resize(bytes->size() - 1);
      if (lie == 5) bytes->push_back(0);
      if (lie == 6) (*bytes)[0] = kPrepared;
      return true;
    };
    for (std::uint32_t frame = 1; frame <= 2; ++frame) {
      FrameRequest request = frame_request("seesaw", frame, 64, 96);
      request.seconds = frame;
      client.request(request);
      client.wait_for_rows(96);
      CHECK(client.picture() == rendered_here(request));
    }
    REQUIRE(c.ranks.log.size() == 1);
    CHECK(c.ranks.log[0].find("rank 2 sent an unrequested answer") == 0);
    CHECK(answers >= 3);
    CHECK(answers < 6);
  }
}

// Goal: a rank that stops answering costs a moment, and none of the pixels; it is used again when it answers. Method:
// one that loses its work after some rows; then what it was sent is done at last.
TEST_CASE("cluster_goes_on_without_a_rank_that_does_not_answer") {
  if (too_slow()) return;
  ClusterRig c(2, small_options());
  ScriptedClient client(&c.rig);
  FrameRequest request = frame_request("seesaw", 1, 64, 96);
  std::uint64_t stop_after = c.ranks.message_count + 2;
  VirtualRanks::Seat* seat = c.ranks.seats[1].get();
  c.ranks.change = [&](std::uint32_t, std::vector<std::uint8_t>*) {
    if (c.ranks.message_count == stop_after) seat->looks_per_message = 0;
    return true;
  };
  client.request(request);
  client.wait_for_rows(96);
  CHECK(client.picture() == rendered_here(request));
  REQUIRE(c.ranks.log.size() == 1);
  CHECK(c.ranks.log[0].find("rank 1 does not answer") == 0);
  seat->looks_per_message = 1;
  const double helped = c.ranks.lead->helped_share();
  for (request.frame = 2; request.frame < 5; ++request.frame) {
    request.seconds = request.frame;
    client.request(request);
    client.wait_for_rows(96);
    CHECK(client.picture() == rendered_here(request));
  }
  REQUIRE(c.ranks.log.size() == 2);
  CHECK(c.ranks.log[1] == "rank 1 answers again");
  CHECK(c.ranks.lead->helped_share() > helped);
}

// Goal: a rank that cannot prepare a frame says why; the others render it. Method: one with less memory than the rest.
TEST_CASE("cluster_goes_on_without_a_rank_that_cannot_help") {
  if (too_slow()) return;
  auto adapt = [](std::uint32_t rank, ServerOptions* options) {
    if (rank == 1) options->client_memory_bytes = kSessionBytesMin;
  };
  ServerOptions options = small_options();
  options.client_memory_bytes = 24u << 20, options.image_side_max = 640;
  ClusterRig c(3, options, adapt);
  ScriptedClient client(&c.rig);
  FrameRequest request = frame_request("cube", 1, 640, 480);
  client.request(request);
  client.wait_for_rows(480);
  CHECK(client.picture() == rendered_here(request));
  REQUIRE(c.ranks.log.size() == 1);
  CHECK(c.ranks.log[0].find("rank 1 cannot help with a frame: ") == 0);
  CHECK(c.ranks.lead->helped_share() > 0);
}

// Goal: a rank with another program or other options, or one that fails, ends the service with one line. Method:
// another identity; a failure while serving.
TEST_CASE("cluster_names_the_rank_that_fails") {
  if (too_slow()) return;
  VirtualRanks ranks(3, small_options());
  ranks.seats[2]->helper = std::make_unique<ClusterHelper>(ranks.of(2), ranks.options, 1u << 30, "another");
  ranks.seats[2]->messages.clear();
  ranks.seats[0]->messages.pop_back();
  REQUIRE(ranks.seats[2]->helper->open().ok);
  Status status = ranks.welcome();
  CHECK(!status.ok);
  CHECK(std::string(status.message).find("rank 2: its program or options") == 0);

  VirtualRanks poor(2, small_options());
  poor.seats[1]->helper = std::make_unique<ClusterHelper>(poor.of(1), poor.options, 1u << 10, "the same");
  poor.seats[0]->messages.clear();
  REQUIRE(poor.seats[1]->helper->open().ok);
  status = poor.welcome();
  CHECK(!status.ok);
  CHECK(std::string(status.message).find("rank 1: scene ") == 0);

  ClusterRig c(2, small_options());
  CHECK(c.ranks.lead->tend().ok);
  send_to(c.ranks.of(1), 0, kTeamFailed, "no luck", 7);
  status = c.ranks.lead->tend();
  CHECK(!status.ok);
  CHECK(std::string(status.message) == "rank 1: no luck");
}
