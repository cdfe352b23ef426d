// The order in which a server sends the rows of a frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <utility>

#include "base/rng.h"
#include "support/effort.h"
#include "support/scripted_client.h"
#include "wire/row_sequence.h"

using namespace pocketray;

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
