// Messages: reading returns what was written, and invalid bytes are refused.
#include "wire/message.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "support/effort.h"
#include "wire/raw_messages.h"
#include "wire/sample_messages.h"

using namespace pocketray;

namespace {

std::vector<std::uint8_t> random_bytes(Rng* rng, std::uint32_t count) {
  std::vector<std::uint8_t> bytes(count);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(next_u32(rng));
  return bytes;
}

// Calls act(message) for samples of every type.
template <class Act>
void for_each_sample(std::uint64_t seed, int rounds, Act act) {
  Rng rng = make_rng(seed);
  for (int type = 1; type <= kMessageTypeCount; ++type)
    for (int round = 0; round < rounds; ++round) {
      std::vector<std::uint8_t> tail = random_bytes(&rng, next_u32(&rng) % 40);
      CAPTURE(type);
      act(sample_message(static_cast<MessageType>(type), &rng, tail), &rng);
    }
}

}  // namespace

// Goal: the bytes follow PROTOCOL.md, so that others can write them. Method: three messages byte by byte; the checksum
// by its definition, bit by bit.
TEST_CASE("message_bytes_are_the_protocol_s") {
  Message m;
  m.type = MessageType::cancel;
  m.cancel.frame = 0x01020304;
  std::vector<std::uint8_t> bytes = encoded(m);
  CHECK(bytes == sealed({9, 0, 0, 0, 0, 0, 0, 0, 4, 3, 2, 1}));
  m.type = MessageType::hello;
  m.hello = {1, 320, 0x12345678, 0x1122334455667788, 0x0140};
  CHECK(encoded(m) ==
        sealed({1,    0,    0,    0,    0,    0,    0,    0,    'P',  'R',  'A',  'Y',  1,    0,    0x40,
                0x01, 0x78, 0x56, 0x34, 0x12, 0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 0x40, 0x01}));
  m.type = MessageType::row_chunk;
  const std::uint8_t data[] = {0xAB, 0xCD};
  m.row_chunk = {0x10203, 258, 4, 0x00010123, 0x0140, 5, 9, {data, 2}};
  CHECK(encoded(m) == sealed({8, 0, 0, 0, 0, 0, 0, 0, 3, 2, 2, 1, 4, 4, 0x34, 5, 11, 0x40, 1, 0xAB, 0xCD}));
  CHECK(row_chunk_prefix_bytes(true, false) == encoded(m).size() - 2);
  m.row_chunk.prepare_ns = 0x00010123;
  CHECK(encoded(m) == sealed({8, 0, 0, 0, 0, 0, 0, 0, 3, 2, 2, 1, 4, 4, 0x34, 5, 15, 0x40, 1, 4, 0x34, 0xAB, 0xCD}));
  CHECK(row_chunk_prefix_bytes(true, true) == encoded(m).size() - 2);
  m.row_chunk.price = 0;
  CHECK(encoded(m) == sealed({8, 0, 0, 0, 0, 0, 0, 0, 3, 2, 2, 1, 4, 4, 0x34, 5, 13, 4, 0x34, 0xAB, 0xCD}));
  m.row_chunk.prepare_ns = 0;
  CHECK(encoded(m) == sealed({8, 0, 0, 0, 0, 0, 0, 0, 3, 2, 2, 1, 4, 4, 0x34, 5, 9, 0xAB, 0xCD}));
  CHECK(row_chunk_prefix_bytes(false, false) == encoded(m).size() - 2);
}

// Goal: reading returns what was written, field by field. Method: writing the result again gives the same bytes, which
// a lost or swapped field would not; the reader consumes exactly the message.
TEST_CASE("message_round_trip_of_every_type") {
  for_each_sample(1, effort(400), [](const Message& message, Rng*) {
    std::vector<std::uint8_t> bytes = encoded(message), stream = bytes;
    stream.insert(stream.end(), {9, 9, 9});
    Message read;
    Decoded decoded = decode(stream, &read);
    REQUIRE(decoded.state == DecodeState::message);
    CHECK(decoded.byte_count == bytes.size());
    CHECK(read.type == message.type);
    CHECK(encoded(read) == bytes);
  });
}

// Goal: every field is encoded: messages that differ in one field differ as bytes. Method: a few fields of each type.
TEST_CASE("message_every_field_travels") {
  Rng rng = make_rng(5);
  using Change = std::function<void(Message*)>;
  const std::pair<MessageType, Change> changes[] = {
      {MessageType::hello, [](Message* m) { m->hello.image_side_max ^= 1; }},
      {MessageType::hello, [](Message* m) { m->hello.message_bytes_max ^= 1; }},
      {MessageType::hello, [](Message* m) { m->hello.scene_bytes_max ^= 1; }},
      {MessageType::scene_entry, [](Message* m) { m->scene_entry.name[0] = 'S'; }},
      {MessageType::scene_entry, [](Message* m) { m->scene_entry.count ^= 1; }},
      {MessageType::scene_entry, [](Message* m) { m->scene_entry.triangle_count ^= 1; }},
      {MessageType::view_query, [](Message* m) { m->view_query.measure_exposure ^= 1; }},
      {MessageType::view_query, [](Message* m) { m->view_query.camera_index ^= 1; }},
      {MessageType::view_query, [](Message* m) { m->view_query.settings.width ^= 1; }},
      {MessageType::view_entry, [](Message* m) { m->view_entry.camera.eye.x += 1; }},
      {MessageType::view_entry, [](Message* m) { m->view_entry.exposure += 1; }},
      {MessageType::view_entry, [](Message* m) { m->view_entry.frames_per_second += 1; }},
      {MessageType::view_entry, [](Message* m) { m->view_entry.effects ^= 1; }},
      {MessageType::view_entry, [](Message* m) { m->view_entry.bounds.high.z += 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.scene.high ^= 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.seconds += 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.camera_stated ^= 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.camera.up.z += 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.camera.vertical_extent += 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.settings.cut_off_levels += 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.settings.forced_off ^= 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.exposure += 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.settings.tone = Tone::film; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.dither ^= 1; }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.chunk_rows -= 1; }},
      {MessageType::frame_request,
       [](Message* m) {
         m->frame_request.coding = m->frame_request.coding == RowCoding::raw ? RowCoding::lossless : RowCoding::raw;
       }},
      {MessageType::frame_request, [](Message* m) { m->frame_request.coarse_first ^= 1; }},
      {MessageType::frame_change, [](Message* m) { m->frame_request.coarse_first ^= 1; }},
      {MessageType::coarse_picture, [](Message* m) { m->coarse_picture.frame ^= 1; }},
      {MessageType::frame_request,
       [](Message* m) { m->frame_request.light_pitch = m->frame_request.light_pitch == 7 ? 8 : 7; }},
      {MessageType::light_map, [](Message* m) { m->light_map.frame ^= 1; }},
      {MessageType::light_map, [](Message* m) { m->light_map.light_ps ^= 1u << 31; }},
      {MessageType::light_map, [](Message* m) { m->light_map.price ^= 1; }},
      {MessageType::frame_change, [](Message* m) { m->frame_request.frame ^= 1; }},
      {MessageType::frame_change, [](Message* m) { m->frame_request.seconds += 1; }},
      {MessageType::frame_change, [](Message* m) { m->frame_request.camera.eye.z += 1; }},
      {MessageType::frame_change, [](Message* m) { m->frame_request.camera.target.x += 1; }},
      {MessageType::frame_change,
       [](Message* m) {
         FrameRequest* q = &m->frame_request;
         q->row_end = static_cast<std::uint16_t>(q->row_begin + 9), q->run_count = 2;
         q->runs[0] = {4, 1}, q->runs[1] = {5, 0};
       }},
      {MessageType::hello, [](Message* m) { m->hello.price ^= 1; }},
      {MessageType::row_chunk, [](Message* m) { m->row_chunk.pixel_ps ^= 1u << 31; }},
      {MessageType::row_chunk, [](Message* m) { m->row_chunk.price ^= 1; }},
      {MessageType::row_chunk, [](Message* m) { m->row_chunk.prepare_ns ^= 1u << 31; }},
      {MessageType::row_chunk, [](Message* m) { m->row_chunk.traced ^= 1; }},
      {MessageType::error, [](Message* m) { m->error.frame ^= 1; }},
      {MessageType::pong, [](Message* m) { m->pong.pixel_ps ^= 1; }},
      {MessageType::pong, [](Message* m) { m->pong.price ^= 1; }},
  };
  const std::vector<std::uint8_t> tail = {1, 2, 3};
  for (const auto& change : changes) {
    Message message = sample_message(change.first, &rng, tail);
    std::vector<std::uint8_t> before = encoded(message);
    change.second(&message);
    std::vector<std::uint8_t> after = encoded(message);
    CHECK(before != after);
    Message read;
    REQUIRE(decode(after, &read).state == DecodeState::message);
    CHECK(encoded(read) == after);
  }
}

// Goal: a message truncated at any byte asks for more and says how much; never more than the message.
TEST_CASE("message_every_prefix_needs_more") {
  for_each_sample(2, effort(20), [](const Message& message, Rng*) {
    std::vector<std::uint8_t> bytes = encoded(message);
    for (std::size_t count = 0; count < bytes.size(); ++count) {
      // A separate copy, so that a sanitizer sees a read beyond it.
      std::vector<std::uint8_t> prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
      Message read;
      Decoded decoded = decode(prefix, &read);
      REQUIRE(decoded.state == DecodeState::need_more);
      CHECK(decoded.byte_count == (count < kHeaderBytes ? kHeaderBytes : bytes.size()));
    }
  });
}

// Goal: no flipped bit yields a message: it is refused, or more bytes are requested than there are.
TEST_CASE("message_every_flipped_bit_is_refused_or_waits") {
  for_each_sample(3, effort(6), [](const Message& message, Rng*) {
    std::vector<std::uint8_t> bytes = encoded(message);
    for (std::size_t at = 0; at < bytes.size(); ++at)
      for (int bit = 0; bit < 8; ++bit) {
        std::vector<std::uint8_t> flipped = bytes;
        flipped[at] ^= static_cast<std::uint8_t>(1 << bit);
        Message read;
        Decoded decoded = decode(flipped, &read);
        REQUIRE(decoded.state != DecodeState::message);
        if (decoded.state == DecodeState::need_more) REQUIRE(decoded.byte_count > bytes.size());
      }
  });
}

// Goal: flipped bits with a correct checksum are refused or give values within their limits. Method: accepted messages
// can be written again, which checks every limit.
TEST_CASE("message_flipped_bits_under_a_right_checksum_stay_in_range") {
  int accepted = 0;
  for_each_sample(4, effort(30), [&](const Message& message, Rng* rng) {
    std::vector<std::uint8_t> bytes = encoded(message);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::vector<std::uint8_t> flipped = bytes;
      flipped[at] ^= static_cast<std::uint8_t>(1 + next_u32(rng) % 255);
      flipped = sealed(flipped);
      Message read;
      if (decode(flipped, &read).state != DecodeState::message) continue;
      ++accepted;
      if (read.type == MessageType::hello && read.hello.version != kWireVersion) continue;
      CHECK(encoded(read) == flipped);
    }
  });
  CHECK(accepted > 100);
}

// Goal: every value outside its limits is refused. Method: one field at a time, with a correct checksum.
TEST_CASE("message_values_out_of_range_are_refused") {
  Rng rng = make_rng(6);
  struct Edit {
    MessageType type;
    std::size_t at;  // in the message
    std::vector<std::uint8_t> bytes;
  };
  const std::vector<std::uint8_t> nan = {0, 0, 0xC0, 0x7F}, infinite = {0, 0, 0x80, 0xFF};
  const std::size_t more = setting_wire_bytes() - 10;  // bytes beyond those of the first settings, ten
  const Edit edits[] = {
      {MessageType::hello, 8, {'p'}},
      {MessageType::hello, 8 + 20, {0, 0}},  // price
      {MessageType::hello, 8 + 20, {0xFF, 0}},
      {MessageType::scene_entry, 8 + 95, {'x'}},
      {MessageType::scene_fetch, 8 + 24, {1, 0, 1, 0}},
      {MessageType::scene_fetch, 8 + 16, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}},
      {MessageType::scene_piece, 8 + 16, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}},
      {MessageType::frame_request, 8 + 20, {0, 0, 0, 0, 0, 0, 0xF8, 0x7F}},  // seconds
      {MessageType::frame_request, 8 + 32, {2}},                             // camera stated
      {MessageType::frame_request, 8 + 35, nan},                             // eye.x
      {MessageType::frame_request, 8 + 71, infinite},                        // fov
      {MessageType::frame_request, 8 + 79, {2}},                             // projection
      {MessageType::frame_request, 8 + 83, {0, 0}},                          // width
      {MessageType::frame_request, 8 + 83, {1, 0x20}},
      {MessageType::frame_request, 8 + 85, {0, 0}},  // height
      {MessageType::frame_request, 8 + 87, {0}},     // samples
      {MessageType::frame_request, 8 + 87, {17}},
      {MessageType::frame_request, 8 + 88, {17}},    // depth
      {MessageType::frame_request, 8 + 89, {0, 0}},  // points
      {MessageType::frame_request, 8 + 89, {1, 1}},
      {MessageType::frame_request, 8 + 91, nan},                           // cut-off
      {MessageType::frame_request, 8 + 91, {0, 0, 0x82, 0x42}},            // 65 levels
      {MessageType::frame_request, 8 + 91, {0, 0, 0x80, 0xBF}},            // −1
      {MessageType::frame_request, 8 + 95, {5}},                           // filter
      {MessageType::frame_request, 8 + 96, {2}},                           // normals
      {MessageType::frame_request, 8 + 97, {kIndirectChoiceCount}},        // indirect
      {MessageType::frame_request, 8 + 98, {5}},                           // reconstruction
      {MessageType::frame_request, 8 + 101, {2}},                          // compensation
      {MessageType::frame_request, 8 + 102, nan},                          // selective
      {MessageType::frame_request, 8 + more + 116, {0, 0, 0x80, 0xBF}},    // exposure −1
      {MessageType::frame_request, 8 + more + 104, {1}},                   // an effect that is none, on
      {MessageType::frame_request, 8 + more + 112, {1}},                   // and off
      {MessageType::frame_request, 8 + more + 113, {kToneCount}},          // tone
      {MessageType::frame_request, 8 + more + 120, {2}},                   // dither
      {MessageType::frame_request, 8 + more + 121, {2}},                   // format
      {MessageType::frame_request, 8 + more + 126, {0, 5, 0, 5, 0}},       // no rows
      {MessageType::frame_request, 8 + more + 129, {0xFF, 0xFF}},          // rows beyond the picture
      {MessageType::frame_request, 8 + more + 122, {0, 0}},                // chunk rows
      {MessageType::frame_request, 8 + more + 124, {3}},                   // coding
      {MessageType::frame_request, 8 + more + 125, {2}},                   // coarse first
      {MessageType::frame_change, 8 + 4, {0, 0, 0, 0, 0, 0, 0xF8, 0x7F}},  // seconds
      {MessageType::frame_change, 8 + 12, nan},                            // eye.x
      {MessageType::frame_change, 8 + 36, {2}},                            // coarse first
      {MessageType::frame_change, 8 + 37, {6, 0, 5, 0}},                   // rows that end before they begin
      {MessageType::frame_change, 8 + 39, {0xFF, 0xFF}},                   // rows beyond any picture
      {MessageType::row_chunk, 8 + 4, {0}},                                // rows
      {MessageType::row_chunk, 8 + 2, {0xFF, 0x1F, 2}},                    // rows beyond any picture
      {MessageType::row_chunk, 8 + 5, {0xFF, 0xB7}},                       // picoseconds shifted out
      {MessageType::row_chunk, 8 + 11, {0xFF, 0xB7}},                      // preparation shifted out
      {MessageType::row_chunk, 8 + 11, {0, 0}},                            // preparation that takes no time
      {MessageType::row_chunk, 8 + 5, {0xFF, 0x0B}},                       // picoseconds with too few bits
      {MessageType::row_chunk, 8 + 8, {2, 0xFF, 0}},                       // price
      {MessageType::error, 8, {0, 0}},
      {MessageType::error, 8, {8, 0}},
      {MessageType::ping, 8 + 4, {1, 0, 1, 0}},
      {MessageType::pong, 8 + 8, {0xFF, 0}},                              // price
      {MessageType::view_query, 8 + 80, {2}},                             // camera stated
      {MessageType::view_query, 8 + 83, nan},                             // eye.x
      {MessageType::view_query, 8 + 131, {0, 0}},                         // width
      {MessageType::view_query, 8 + more + 164, {2}},                     // exposure measured
      {MessageType::view_query, 8 + 79, {'x'}},                           // an animation's name without end
      {MessageType::view_entry, 8 + 20, {0, 0, 0, 0, 0, 0, 0xF0, 0x7F}},  // origin
      {MessageType::view_entry, 8 + 44, infinite},                        // eye.x
      {MessageType::view_entry, 8 + 92, {0, 0, 0, 0}},                    // exposure
      {MessageType::view_entry, 8 + 96, nan},                             // frames a second
      {MessageType::view_entry, 8 + 107, {1}},                            // an effect that is none
      {MessageType::view_entry, 8 + 112, {0, 0, 0, 0x7F}},                // bounds turned over
  };
  const std::vector<std::uint8_t> tail = {1, 2, 3};
  for (const Edit& edit : edits) {
    std::vector<std::uint8_t> bytes = encoded(sample_message(edit.type, &rng, tail));
    CAPTURE(static_cast<int>(edit.type));
    CAPTURE(edit.at);
    CHECK(!refused(bytes));
    std::copy(edit.bytes.begin(), edit.bytes.end(), bytes.begin() + static_cast<std::ptrdiff_t>(edit.at));
    CHECK(refused(sealed(bytes)));
  }
}

// Goal: lengths are judged by the header alone: too long for the type or for the receiver, or too short.
TEST_CASE("message_impossible_lengths_are_refused_from_the_header") {
  auto header = [](int type, std::uint32_t payload) {
    return std::vector<std::uint8_t>{static_cast<std::uint8_t>(type),
                                     static_cast<std::uint8_t>(payload),
                                     static_cast<std::uint8_t>(payload >> 8),
                                     static_cast<std::uint8_t>(payload >> 16),
                                     0,
                                     0,
                                     0,
                                     0};
  };
  Message message;
  for (int type = 0; type < 256; ++type) {
    CAPTURE(type);
    bool known = type >= 1 && type <= kMessageTypeCount;
    CHECK(refused(header(type, 0xFFFFFF)));
    CHECK((decode({static_cast<std::uint8_t>(type)}, &message).state == DecodeState::malformed) == !known);
    if (type == static_cast<int>(MessageType::hello)) continue;
    if (known) CHECK(refused(header(type, 1)));
  }
  CHECK(refused(header(9, 5)));
  CHECK(refused(header(8, 13 + kChunkBytesMax + 1)));
  CHECK(!refused(header(8, 11 + kChunkBytesMax)));
  CHECK(decode(header(8, 19 + 1000), &message, 8 + 19 + 999).state == DecodeState::malformed);
  CHECK(decode(header(8, 19 + 1000), &message, 8 + 19 + 1000).state == DecodeState::need_more);
}

// Goal: a request that a change can express is recognised, and the change reproduces it; other requests are not.
// Method: random requests that differ in everything that a change carries, then in one field more.
TEST_CASE("message_change_gives_the_request") {
  Rng rng = make_rng(9);
  using Field = std::function<void(FrameRequest*)>;
  const Field others[] = {
      [](FrameRequest* r) { r->camera.up.x += 1; },
      [](FrameRequest* r) { r->camera.vertical_fov += 0.01f; },
      [](FrameRequest* r) { r->camera.vertical_extent += 1; },
      [](FrameRequest* r) { r->chunk_rows ^= 1; },
      [](FrameRequest* r) { r->coding = r->coding == RowCoding::raw ? RowCoding::lossless : RowCoding::raw; },
      [](FrameRequest* r) { r->scene.low ^= 1; },
      [](FrameRequest* r) { r->camera_stated ^= 1; },
      [](FrameRequest* r) { r->camera_index ^= 1; },
      [](FrameRequest* r) { r->settings.height ^= 1; },
      [](FrameRequest* r) { r->settings.cut_off_levels += 1; },
      [](FrameRequest* r) { r->exposure += 1; },
      [](FrameRequest* r) { r->format = WireFormat(1 - static_cast<int>(r->format)); },
      [](FrameRequest* r) { r->dither ^= 1; },
  };
  for (int round = 0; round < 50; ++round) {
    FrameRequest before = sample_message(MessageType::frame_request, &rng, {}).frame_request;
    Message change = sample_message(MessageType::frame_change, &rng, {}), read, whole;
    FrameRequest request = before;
    take_change(change.frame_request, &request);
    request.row_begin = 0, request.row_end = 1, request.run_count = 0;
    CHECK(is_change(request, before));
    change.frame_request = request;
    REQUIRE(decode(encoded(change), &read).state == DecodeState::message);
    whole.type = MessageType::frame_request;
    whole.frame_request = before;
    take_change(read.frame_request, &whole.frame_request);
    Message expected = whole;
    expected.frame_request = request;
    CHECK(encoded(whole) == encoded(expected));
    for (const Field& other : others) {
      FrameRequest differs = request;
      other(&differs);
      CHECK(!is_change(differs, before));
    }
  }
}

// Goal: an order is one of the rows asked for. Method: orders of ten rows with one thing wrong, as bytes with a correct
// checksum; in a frame_request and in a frame_change.
TEST_CASE("message_orders_that_are_none_are_refused") {
  Rng rng = make_rng(12);
  using Runs = std::vector<std::uint8_t>;  // row count and place, run by run
  const Runs good[] = {{}, {10, 0}, {4, 1, 6, 0}, {1, 2, 2, 0, 7, 1}};
  const Runs bad[] = {
      {4, 1, 6},              // half a run
      {4},                    //
      {9, 0},                 // rows are missing
      {11, 0},                // or too many
      {4, 1, 5, 0},           //
      {255, 0, 11, 1},        // also modulo 256
      {0, 0, 10, 1},          // an empty run
      {4, 0, 6, 0},           // a place taken twice
      {4, 1, 6, 2},           // a place beyond the last
      {4, 255, 6, 0},         //
      {4, 64, 6, 0},          //
      {1, 2, 2, 0, 7, 0},     //
      Runs(2 * 65, 0),        // too many runs
      Runs(3 * kHeaderBytes)  //
  };
  for (MessageType type : {MessageType::frame_request, MessageType::frame_change}) {
    Message message = sample_message(type, &rng, {});
    FrameRequest* q = &message.frame_request;
    q->settings.height = 100, q->row_begin = 50, q->row_end = 60, q->run_count = 0;
    const std::vector<std::uint8_t> without = encoded(message);
    auto with = [&](const Runs& runs) {
      std::vector<std::uint8_t> bytes = without;
      bytes.insert(bytes.end(), runs.begin(), runs.end());
      return sealed(bytes);
    };
    for (const Runs& runs : good) CHECK(!refused(with(runs)));
    for (const Runs& runs : bad) {
      CAPTURE(runs.size());
      CHECK(refused(with(runs)));
    }
    // What could not be decoded cannot be sent.
    q->run_count = 2, q->runs[0] = {4, 0}, q->runs[1] = {6, 0};
    CHECK(!can_encode(message));
    q->runs[1].place = 1;
    CHECK(can_encode(message));
    q->run_count = kRunCountMax + 1;
    CHECK(!can_encode(message));
  }
}

// Goal: of a hello of another version, the version is read, however long the message.
TEST_CASE("message_hello_of_another_version_tells_its_version") {
  for (std::size_t extra : {0, 16, 100}) {
    std::vector<std::uint8_t> bytes = {1, 0, 0, 0, 0, 0, 0, 0, 'P', 'R', 'A', 'Y', 3, 1};
    bytes.resize(bytes.size() + extra, 0xEE);
    Message message;
    REQUIRE(decode(sealed(bytes), &message).state == DecodeState::message);
    CHECK(message.hello.version == 0x0103);
    bytes[12] = kWireVersion, bytes[13] = 0;
    CHECK(refused(sealed(bytes)) == (extra != 16));
  }
}

// Goal: random bytes are no messages. Method: 200,000 streams; correct checksums are covered above.
TEST_CASE("message_random_bytes_are_refused_or_wait") {
  Rng rng = make_rng(7);
  for (int round = 0; round < effort(200000); ++round) {
    std::vector<std::uint8_t> bytes = random_bytes(&rng, next_u32(&rng) % 64);
    if (!bytes.empty()) bytes[0] %= kMessageTypeCount + 2;
    Message message;
    REQUIRE(decode(bytes, &message).state != DecodeState::message);
  }
}

// Goal: a chunk's bytes may already be in place.
TEST_CASE("message_tail_may_lie_in_place") {
  const std::uint32_t prefix = row_chunk_prefix_bytes(true, false);
  std::vector<std::uint8_t> buffer(prefix + 5);
  for (std::uint8_t i = 0; i < 5; ++i) buffer[prefix + i] = i;
  Message m;
  m.type = MessageType::row_chunk;
  m.row_chunk = {1, 2, 3, 4, kPriceUnit, 5, 0, {buffer.data() + prefix, 5}};
  std::vector<std::uint8_t> apart = encoded(m);
  encode_message(m, buffer.data());
  CHECK(buffer == apart);
}
