// The codec on random, partly changed and hostile pictures.
#include "wire/codec.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>

#include "base/rng.h"
#include "support/effort.h"
#include "wire/codec_ends.h"
#include "wire/entropy.h"
#include "wire/pixel_runs.h"
#include "wire/predict.h"

using namespace pocketray;

namespace {

using Bytes = std::vector<std::uint8_t>;

// Changes the picture: nothing, a pixel, a block, a smooth ramp, noise, or all of it to one value.
void change(const CodecShape& shape, Rng* rng, Bytes* picture) {
  std::size_t row_bytes = std::size_t(shape.width) * pixel_bytes(shape.format);
  std::uint32_t kind = next_u32(rng) % 6;
  if (kind == 0) return;
  std::uint32_t row = next_u32(rng) % shape.height, rows = kind == 1 ? 1 : 1 + next_u32(rng) % (shape.height - row);
  if (kind >= 4) row = 0, rows = shape.height;
  std::uint8_t value = static_cast<std::uint8_t>(next_u32(rng));
  for (std::uint32_t r = row; r < row + rows; ++r)
    for (std::size_t i = 0; i < row_bytes; ++i) {
      std::uint8_t* byte = &(*picture)[r * row_bytes + i];
      if (kind == 1 && i != row_bytes / 2) continue;
      if (kind == 2 && (i < row_bytes / 4 || i > row_bytes / 2)) continue;
      *byte = kind == 3   ? static_cast<std::uint8_t>(value + i + r)
              : kind == 4 ? static_cast<std::uint8_t>(next_u32(rng))
                          : value;
    }
}

// A chunk with that body, deflated by zlib as a hostile peer would.
Bytes deflated(const Bytes& body, bool finish) {
  z_stream z = {};
  REQUIRE(deflateInit2(&z, 9, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  Bytes bytes(body.size() + 1000);
  z.next_in = const_cast<Bytef*>(body.data()), z.avail_in = static_cast<uInt>(body.size());
  z.next_out = bytes.data(), z.avail_out = static_cast<uInt>(bytes.size());
  deflate(&z, finish ? Z_FINISH : Z_SYNC_FLUSH);
  bytes.resize(z.total_out - (finish ? 0 : 4));
  deflateEnd(&z);
  return bytes;
}

RowChunk chunk_of(const Bytes& bytes, std::uint8_t encoding, std::uint16_t row_begin = 0, std::uint16_t row_count = 1) {
  return {0,          row_begin, row_count, 0,
          kPriceUnit, 0,         encoding,  {bytes.data(), static_cast<std::uint32_t>(bytes.size())}};
}

}  // namespace

// Goal: decoding returns what was encoded, for all changes, both formats, and any level and chunk size.
TEST_CASE("codec_round_trip_over_changing_pictures") {
  Rng rng = make_rng(1);
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888})
    for (int round = 0; round < effort(60); ++round) {
      CodecShape shape = {1 + next_u32(&rng) % 70, 1 + next_u32(&rng) % 40, 1, format};
      shape.chunk_rows_max = 1 + next_u32(&rng) % shape.height;
      CodecEnds ends(shape);
      Bytes picture(shape.width * shape.height * pixel_bytes(format));
      for (int frame = 0; frame < 12; ++frame) {
        change(shape, &rng, &picture);
        ends.send(picture, static_cast<int>(next_u32(&rng) % 10));
        REQUIRE(ends.holds(picture));
      }
    }
}

// Goal: chunks of any rows in any order, with some rows left out, keep both ends equal.
TEST_CASE("codec_round_trip_of_rows_in_any_order") {
  Rng rng = make_rng(2);
  CodecShape shape = {33, 21, 8, WireFormat::rgb565};
  CodecEnds ends(shape);
  Bytes picture(33 * 21 * 2), sent(picture.size());
  for (int round = 0; round < effort(2000); ++round) {
    change(shape, &rng, &picture);
    std::uint32_t begin = next_u32(&rng) % 21, count = 1 + next_u32(&rng) % (21 - begin < 8 ? 21 - begin : 8);
    REQUIRE(decode_rows(ends.decoder, ends.encode(picture.data(), begin, count, 1)));
    std::copy_n(picture.data() + begin * 66, count * 66, sent.data() + begin * 66);
    REQUIRE(ends.holds(sent));
  }
}

// Goal: an unchanged picture takes a byte per chunk, and noise no more than its own bytes and a few.
TEST_CASE("codec_unchanged_rows_take_a_byte_noise_its_own") {
  Rng rng = make_rng(3);
  CodecShape shape = {320, 240, 16, WireFormat::rgb565};
  CodecEnds ends(shape);
  Bytes picture(320 * 240 * 2);
  for (std::uint8_t& byte : picture) byte = static_cast<std::uint8_t>(next_u32(&rng));
  CHECK(ends.send(picture, 1) <= picture.size() + 15 * 8);
  CHECK(ends.send(picture, 1) == 15);
  CHECK(ends.holds(picture));
}

// Goal: restarted ends behave like new ones: the same bytes again, and a broken decoder works again.
TEST_CASE("codec_restarted_is_as_new") {
  Rng rng = make_rng(4);
  CodecShape shape = {64, 48, 16, WireFormat::rgb888};
  CodecEnds ends(shape);
  Bytes picture(64 * 48 * 3);
  for (std::size_t i = 0; i < picture.size(); ++i) picture[i] = static_cast<std::uint8_t>(i / 7 + next_u32(&rng) % 3);
  std::size_t first = ends.send(picture, 6);
  CHECK(ends.send(picture, 6) < first);
  Bytes junk = {0xFF, 0xFF, 0xFF};
  CHECK(!decode_rows(ends.decoder, chunk_of(junk, 0)));
  CHECK(!decode_rows(ends.decoder, ends.encode(picture.data(), 0, 1, 6)));
  restart_row_encoder(ends.encoder);
  restart_row_decoder(ends.decoder);
  CHECK(ends.send(picture, 6) == first);
  CHECK(ends.holds(picture));
}

// Goal: the memory is as need() says, with zlib's part nearly used up but not exceeded, including its lazily made
// window.
TEST_CASE("codec_need_is_what_it_takes") {
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
    CodecShape shape = {320, 240, 16, format};
    CodecEnds ends(shape);
    Rng rng = make_rng(5);
    Bytes picture(320 * 240 * pixel_bytes(format));
    for (std::size_t i = 0; i < picture.size(); ++i) picture[i] = static_cast<std::uint8_t>(next_u32(&rng) % 9);
    ends.send(picture, 9);
    CHECK(ends.arena.used == row_encoder_need(shape) + row_decoder_need(shape));
    const Arena &deflating = ends.encoder->state.zlib_arena, &inflating = ends.decoder->state.zlib_arena;
    std::printf("%u bytes a pixel: sender %zu bytes, of which zlib has %zu and uses %zu; receiver %zu, %zu, %zu\n",
                pixel_bytes(format), row_encoder_need(shape), deflating.capacity, deflating.used,
                row_decoder_need(shape), inflating.capacity, inflating.used);
    CHECK(deflating.used > deflating.capacity - (12 << 10));
    CHECK(inflating.used > inflating.capacity - (12 << 10));
  }
}

// Goal: decompression bombs are capped. Method: bodies that inflate to ten million bytes; the decoder writes no more
// than its scratch memory, as a sanitizer and the bytes after it would show, and refuses.
TEST_CASE("codec_decompression_bomb_is_capped") {
  CodecShape shape = {320, 240, 16, WireFormat::rgb565};
  CodecEnds ends(shape);
  for (std::uint8_t value : {0, 1, 255})
    for (std::uint16_t rows : {1, 16}) {
      Bytes bomb = deflated(Bytes(10000000, value), false);
      CHECK(bomb.size() < 20000);
      CHECK(!decode_rows(ends.decoder, chunk_of(bomb, kEncodingDeflated, 0, rows)));
      std::size_t written = static_cast<std::size_t>(ends.decoder->state.stream.total_out);
      CHECK(written <= ends.decoder->state.body.count);
      restart_row_decoder(ends.decoder);
    }
}

// Goal: invalid bodies are refused. Method: handmade bodies for a picture of 8 × 4, one fault each.
TEST_CASE("codec_bodies_that_do_not_fit_are_refused") {
  CodecShape shape = {8, 4, 2, WireFormat::rgb565};
  const Bytes good = {2, 3, 1, 0xAA, 0xBB};  // two bytes of runs: skip 3, give 1
  struct Fault {
    const char* what;
    Bytes body;
    std::uint8_t encoding;
    std::uint16_t row_begin, row_count;
  };
  const Fault faults[] = {
      {"empty", {}, 0, 0, 1},
      {"unknown encoding", good, 4, 0, 1},
      {"no rows", good, 0, 0, 0},
      {"more rows than a chunk may have", good, 0, 0, 3},
      {"rows beyond the picture", good, 0, 3, 2},
      {"rows far beyond the picture", good, 0, 65535, 1},
      {"runs longer than the body", {5, 3, 1, 0xAA, 0xBB}, 0, 0, 1},
      {"a run cut short", {1, 3, 0xAA, 0xBB}, 0, 0, 1},
      {"a number cut short", {2, 3, 0x81, 0xAA, 0xBB}, 0, 0, 1},
      {"a number of 33 bits", {6, 3, 0x81, 0x80, 0x80, 0x80, 0x10, 0xAA, 0xBB}, 0, 0, 1},
      {"skips beyond the rows", {2, 8, 1, 0xAA, 0xBB}, 0, 0, 1},
      {"skips past the rows into the next", {2, 9, 1, 0xAA, 0xBB}, 0, 0, 1},
      {"skips far beyond", {6, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 1, 0xAA, 0xBB}, 0, 0, 1},
      {"gives beyond the rows", {2, 7, 2, 0xAA, 0xBB, 0xCC, 0xDD}, 0, 0, 1},
      {"gives nothing", {4, 1, 0, 2, 1, 0xAA, 0xBB}, 0, 0, 1},
      {"too few values", {2, 3, 1, 0xAA}, 0, 0, 1},
      {"too many values", {2, 3, 1, 0xAA, 0xBB, 0xCC}, 0, 0, 1},
      {"a stream that ends", deflated(good, true), kEncodingDeflated, 0, 1},
      {"no stream", good, kEncodingDeflated, 0, 1},
      {"an empty stream", {}, kEncodingDeflated, 0, 1},
      {"an empty body, deflated", deflated({}, false), kEncodingDeflated, 0, 1},
  };
  CodecEnds ends(shape);
  Bytes two_rows = {2, 0, 16};  // all 16 pixels given
  two_rows.resize(3 + 2 * 16);
  auto restart = [&] {
    restart_row_decoder(ends.decoder);
    for (std::uint16_t row : {0, 2}) REQUIRE(decode_rows(ends.decoder, chunk_of(two_rows, 0, row, 2)));
  };
  for (const Fault& fault : faults) {
    CAPTURE(fault.what);
    restart();
    CHECK(!decode_rows(ends.decoder, chunk_of(fault.body, fault.encoding, fault.row_begin, fault.row_count)));
    restart();
    CHECK(decode_rows(ends.decoder, chunk_of(good, 0, 3, 1)));
    CHECK(picture_row(ends.decoder->state, 3)[6] == 0xAA);
    CHECK(decode_rows(ends.decoder, chunk_of(deflated(good, false), kEncodingDeflated, 0, 1)));
  }
}

// Goal: a row that was never sent cannot be claimed unchanged, in whole or in part; once sent, it can. Method: handmade
// bodies for a picture of 8 × 4 that leave the first, a middle or the last pixel of a new row, or all of it; an encoder
// whose picture is as black as the receiver's.
TEST_CASE("codec_rows_that_were_never_sent_are_not_left") {
  CodecShape shape = {8, 4, 2, WireFormat::rgb565};
  CodecEnds ends(shape);
  auto given = [](Bytes runs, std::size_t count) {
    runs.resize(runs.size() + 2 * count);
    return runs;
  };
  const Bytes nothing = {0}, first = given({2, 1, 7}, 7), middle = given({4, 0, 4, 1, 3}, 7),
              last = given({2, 0, 7}, 7), row = given({2, 0, 8}, 8);
  for (const Bytes* body : {&nothing, &first, &middle, &last}) {
    restart_row_decoder(ends.decoder);
    CHECK(!decode_rows(ends.decoder, chunk_of(*body, 0, 1)));
    restart_row_decoder(ends.decoder);
    REQUIRE(decode_rows(ends.decoder, chunk_of(row, 0, 1)));
    CHECK(decode_rows(ends.decoder, chunk_of(*body, 0, 1)));
    CHECK(decode_rows(ends.decoder, chunk_of(given({2, 8, 8}, 8), 0, 1, 2)));  // leaves row 1, gives row 2
    CHECK(decode_rows(ends.decoder, chunk_of(nothing, 0, 1, 2)));
    CHECK(!decode_rows(ends.decoder, chunk_of(nothing, 0, 2, 2)));  // row 3 is new
  }
  const Bytes black(2 * 8);
  std::uint8_t bytes[200], encoding;
  CHECK(encode_rows(ends.encoder, 0, 1, black.data(), 0, bytes, &encoding) > 2 * 8);
  CHECK(encode_rows(ends.encoder, 0, 1, black.data(), 0, bytes, &encoding) == 1);
}

// Goal: chunks truncated at any byte or with any byte flipped do no harm: they are refused or give other pixels.
// Method: a sanitizer, and the picture's size; the codec alone, without the message's checksum.
TEST_CASE("codec_damaged_chunks_are_harmless") {
  Rng rng = make_rng(6);
  CodecShape shape = {40, 16, 8, WireFormat::rgb565};
  int refused = 0, tried = 0;
  for (int level : {0, 1, 9}) {
    CodecEnds ends(shape);
    Bytes picture(40 * 16 * 2);
    for (std::size_t i = 0; i < picture.size(); ++i)
      picture[i] = static_cast<std::uint8_t>(i % 23 + next_u32(&rng) % 2);
    RowChunk chunk = ends.encode(picture.data(), 8, 8, level);
    Bytes good(chunk.bytes.begin(), chunk.bytes.end());
    for (std::size_t at = 0; at < good.size(); ++at)
      for (bool flip : {false, true}) {
        Bytes damaged = good;
        if (flip) damaged[at] ^= static_cast<std::uint8_t>(1 + next_u32(&rng) % 255);
        if (!flip) damaged.resize(at);
        restart_row_decoder(ends.decoder);
        ++tried, refused += !decode_rows(ends.decoder, chunk_of(damaged, chunk.encoding, 8, 8));
      }
  }
  CHECK(refused > tried / 2);
}

// Goal: valid shapes keep every size within 32 bits and a chunk within a message.
TEST_CASE("codec_shapes_beyond_the_limits_are_refused") {
  CHECK(codec_shape_valid({320, 240, 240, WireFormat::rgb888}));
  CHECK(codec_shape_valid({8192, 8192, 32, WireFormat::rgb888}));
  for (CodecShape shape : {CodecShape{0, 240, 16, WireFormat::rgb565}, CodecShape{320, 0, 16, WireFormat::rgb565},
                           CodecShape{320, 240, 0, WireFormat::rgb565}, CodecShape{320, 240, 241, WireFormat::rgb565},
                           CodecShape{8193, 1, 1, WireFormat::rgb565}, CodecShape{8192, 8192, 33, WireFormat::rgb565},
                           CodecShape{~0u, ~0u, ~0u, WireFormat::rgb888}})
    CHECK(!codec_shape_valid(shape));
}

// Goal: differences restore the pixel, and channels do not affect each other. Method: random pixels; channels
// separately, modulo their levels; a difference of green is subtracted from the others only as far as they share it.
TEST_CASE("predict_differences_give_the_pixel_back") {
  Rng rng = make_rng(8);
  for (int i = 0; i < effort(200000); ++i) {
    std::uint32_t a = next_u32(&rng) & 0xFFFF, b = next_u32(&rng) & 0xFFFF;
    REQUIRE(pixel_of<Pixel565>(difference_of<Pixel565>(a, b), b) == a);
    std::uint32_t difference = subtract_channels<Pixel565>(a, b);
    REQUIRE((difference >> 11) == (((a >> 11) - (b >> 11)) & 31));
    REQUIRE(((difference >> 5) & 63) == (((a >> 5) - (b >> 5)) & 63));
    REQUIRE((difference & 31) == ((a - b) & 31));
    a = next_u32(&rng) & 0xFFFFFF, b = next_u32(&rng) & 0xFFFFFF;
    REQUIRE(pixel_of<Pixel888>(difference_of<Pixel888>(a, b), b) == a);
    difference = subtract_channels<Pixel888>(a, b);
    for (int shift : {0, 8, 16}) REQUIRE(((difference >> shift) & 255) == (((a >> shift) - (b >> shift)) & 255));
  }
  // A grey that rises by one level of red, two of green, one of blue: only green differs.
  CHECK(difference_of<Pixel565>(0x0841 * 5, 0x0841 * 4) == 0x0040);
  CHECK(difference_of<Pixel565>(0x0841 * 4, 0x0841 * 5) == 0x07C0);
  CHECK(difference_of<Pixel888>(0x0A0A0A, 0x080808) == 0x000200);
}

// Goal: the prediction is LOCO-I's. Method: 2 × 2 pixels of red levels: corner and upper above, left and the pixel
// below.
TEST_CASE("predict_is_the_median_of_left_up_and_plane") {
  auto red = [](std::uint8_t corner, std::uint8_t up, std::uint8_t left) {
    const std::uint8_t pixels[] = {corner, 9, 0, up, 9, 0, left, 9, 0, 77, 9, 0};
    std::uint32_t predicted = predict<Pixel888>(pixels, 3, 1, 2);
    CHECK((predicted >> 8) == 9);
    return predicted & 255;
  };
  CHECK(red(10, 20, 12) == 20);  // corner below both: the larger
  CHECK(red(30, 20, 12) == 12);  // above both: the smaller
  CHECK(red(15, 20, 12) == 17);  // between: the plane
  CHECK(red(12, 20, 12) == 20);
  CHECK(red(20, 20, 12) == 12);
  const std::uint8_t pixels[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  CHECK(predict<Pixel888>(pixels, 0, 0, 2) == 0);
  CHECK(predict<Pixel888>(pixels, 1, 1, 2) == 0x030201);
  CHECK(predict<Pixel888>(pixels, 2, 0, 2) == 0x030201);
}

TEST_CASE("pixel_runs_numbers_round_trip") {
  for (std::uint32_t value : {0u, 1u, 127u, 128u, 16383u, 16384u, 1u << 28, (1u << 28) - 1, ~0u}) {
    std::uint8_t bytes[kNumberBytesMax];
    std::uint8_t* end = put_number(bytes, value);
    std::uint32_t read;
    CHECK(get_number(bytes, end, &read) == end);
    CHECK(read == value);
    CHECK(get_number(bytes, end - 1, &read) == nullptr);
  }
}

// Goal: the estimate is within 3 % of the entropy. Method: geometric and uniform frequencies against the C library.
TEST_CASE("entropy_bits_near_the_entropy") {
  Rng rng = make_rng(9);
  for (std::uint32_t kind = 0; kind < 4; ++kind) {
    ByteCounts counts;
    for (int i = 0; i < 20000; ++i) {
      std::uint32_t x = next_u32(&rng);
      count_bytes(&counts,
                  kind == 0   ? x
                  : kind == 1 ? x & 15
                  : kind == 2 ? static_cast<std::uint32_t>(__builtin_ctz(x | 1 << 20))
                              : 7,
                  1);
    }
    double exact = 0;
    for (std::uint32_t count : counts.count)
      if (count) exact += count * std::log2(20000.0 / count);
    CHECK(std::fabs(static_cast<double>(entropy_bits(counts)) - exact) <= 0.03 * exact + 2);
  }
  CHECK(entropy_bits(ByteCounts()) == 0);
}
