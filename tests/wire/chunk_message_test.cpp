// What chunks of rows abbreviate or leave out.
#include <doctest/doctest.h>

#include "support/effort.h"
#include "wire/raw_messages.h"
#include "wire/sample_messages.h"

using namespace pocketray;

// Goal: a chunk's frame is found from its low bits, up to 65,535 frames later, and picoseconds arrive rounded down by
// at most a 1024th.
TEST_CASE("message_chunk_abbreviates_its_numbers") {
  RowChunk chunk;
  for (std::uint32_t latest : {1u, 65535u, 65536u, 65537u, 1000000u, ~0u})
    for (std::uint32_t late : {0u, 1u, 300u, 65535u}) {
      if (late >= latest) continue;
      chunk.frame = (latest - late) & 0xFFFF;
      CHECK(frame_of(chunk.frame, latest) == latest - late);
    }
  Rng rng = make_rng(13);
  for (int i = 0; i < effort(2000); ++i) {
    Message m, read;
    m.type = MessageType::row_chunk;
    const std::uint32_t ps = i == 0 ? ~0u : next_u32(&rng) >> next_u32(&rng) % 32;
    m.row_chunk = {1, 2, 3, ps, 0, 5, 0, {nullptr, 0}};
    REQUIRE(decode(encoded(m), &read).state == DecodeState::message);
    REQUIRE(read.row_chunk.prepare_ns == 0);
    m.row_chunk.prepare_ns = ps;
    REQUIRE(decode(encoded(m), &read).state == DecodeState::message);
    REQUIRE(read.row_chunk.prepare_ns == read.row_chunk.pixel_ps);
    REQUIRE(read.row_chunk.pixel_ps <= ps);
    REQUIRE(ps - read.row_chunk.pixel_ps <= ps / 1024);
  }
  CHECK(traced_part(0, 640) == 0);
  CHECK(traced_part(1, 640) == 1);
  CHECK(traced_part(639, 640) == 255);
  CHECK(traced_part(640, 640) == 255);
}

// Goal: a chunk that says that its price or preparation follows, but ends, is refused, whatever lies behind it in
// memory.
TEST_CASE("message_chunk_without_its_price_is_refused") {
  Message m;
  m.type = MessageType::row_chunk;
  m.row_chunk = {1, 2, 3, 4, 0, 5, 0, {nullptr, 0}};
  std::vector<std::uint8_t> bytes = encoded(m);
  REQUIRE(bytes.size() == row_chunk_prefix_bytes(false, false));
  for (int stated : {kEncodingPrice | 0, kEncodingPreparation | 0, kEncodingPrice | kEncodingPreparation}) {
    CAPTURE(stated);
    std::vector<std::uint8_t> longer = bytes;
    longer.back() = static_cast<std::uint8_t>(longer.back() | stated);
    const std::size_t wanted = stated == (kEncodingPrice | kEncodingPreparation) ? 4 : 2;
    for (std::size_t more = 0; more < 6; ++more, longer.push_back(1)) {
      longer[1] = static_cast<std::uint8_t>(longer.size() - kHeaderBytes);
      CHECK(refused(sealed(longer)) == (more < wanted));
    }
  }
}
