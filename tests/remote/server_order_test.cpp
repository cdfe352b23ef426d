// The order in which a server sends the rows of a frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/rng.h"
#include "support/effort.h"
#include "support/scripted_client.h"
#include "wire/row_sequence.h"

using namespace pocketray;

// Goal: several threads code rows beside the next ones: the first rows come at once, others a slice later, the last
// ones with those before. Method: rows sent after each step, with one thread and with two, of a frame whose pixels'
// cost is known.
TEST_CASE("server_codes_rows_beside_the_next_ones") {
  for (std::uint32_t threads : {1u, 2u}) {
    ServerOptions options;
    options.thread_count = threads, options.coherence = CoherenceMode::off;
    ServerRig rig(options);
    ScriptedClient client(&rig);
    FrameRequest request = frame_request("cube", 1);
    request.chunk_rows = 8;
    client.request(request);
    client.wait_for_rows(48);
    request.frame = 2, request.seconds = 1;
    client.request(request);
    std::vector<std::uint64_t> sent;
    while (sent.empty() || sent.back() < 48) {
      rig.step();
      const std::uint64_t rows = server_totals(*rig.server).row_count - 48;
      if (rows > 0) sent.push_back(rows);
    }
    client.wait_for_rows(48);
    CHECK(client.picture() == rendered_here(request));
    CHECK(sent == (threads == 1 ? std::vector<std::uint64_t>{8, 16, 24, 32, 40, 48}
                                : std::vector<std::uint64_t>{8, 8, 16, 24, 32, 48}));
  }
}

// Goal: rows come in the order asked for, and the picture is the same, however many threads trace and whatever part of
// the rows changed. Method: random orders of all rows and of some, still and moving, with one to sixteen threads.
TEST_CASE("server_sends_rows_in_the_order_asked_for") {
  Rng rng = make_rng(17);
  for (std::uint32_t threads : {1u, 3u, 16u})
    for (CoherenceMode mode : {CoherenceMode::off, CoherenceMode::on}) {
      ServerOptions options;
      options.thread_count = threads, options.coherence = mode;
      ServerRig rig(options);
      ScriptedClient client(&rig);
      for (std::uint32_t frame = 1; frame <= static_cast<std::uint32_t>(effort(8)); ++frame) {
        FrameRequest request = frame_request("seesaw", frame);
        request.seconds = frame / 2 * 0.25;
        request.chunk_rows = static_cast<std::uint16_t>(1 + next_u32(&rng) % 9);
        std::uint32_t left = 48;
        while (left > 0) {
          const std::uint32_t rows = std::min(left, 1 + next_u32(&rng) % 12), i = request.run_count++;
          request.runs[i] = {static_cast<std::uint8_t>(rows), static_cast<std::uint8_t>(i)};
          std::swap(request.runs[i].place, request.runs[next_u32(&rng) % (i + 1)].place);
          left -= rows;
        }
        client.request(request);
        client.wait_for_rows(48);
        CHECK(client.picture() == rendered_here(request));
        RowSequence at = first_rows(request);
        for (const RowChunk& chunk : client.chunks) {
          CHECK(chunk.row_begin + chunk.row_count == at.row_end);
          REQUIRE(chunk.row_count == next_chunk_rows(request, at));
          pass_rows(request, chunk.row_count, &at);
        }
        CHECK(!has_rows(at));
      }
    }
}
