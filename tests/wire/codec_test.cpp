// The codec on random, partly changed and hostile pictures.
#include "wire/codec.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>

#include "base/rng.h"
#include "support/effort.h"
#include "wire/block_coder.h"
#include "wire/codec_ends.h"

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

RowChunk chunk_of(const Bytes& bytes, std::uint8_t encoding, std::uint16_t row_begin = 0, std::uint16_t row_count = 1) {
  return {1,          row_begin, row_count, 0,
          kPriceUnit, 0,         encoding,  {bytes.data(), static_cast<std::uint32_t>(bytes.size())}};
}

RowCoding any_coding(Rng* rng) { return static_cast<RowCoding>(next_u32(rng) % 2); }

}  // namespace

// Goal: decoding returns what was encoded, for all changes, both formats, coded or raw, and any chunk size.
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
        ends.send(picture, any_coding(&rng));
        REQUIRE(ends.holds(picture));
      }
    }
}

// Goal: chunks of any rows in any order, some rows left out and some sent twice in a frame, keep both ends equal.
TEST_CASE("codec_round_trip_of_rows_in_any_order") {
  Rng rng = make_rng(2);
  CodecShape shape = {33, 21, 8, WireFormat::rgb565};
  CodecEnds ends(shape);
  Bytes picture(33 * 21 * 2), sent(picture.size());
  for (int round = 0; round < effort(2000); ++round) {
    change(shape, &rng, &picture);
    if (next_u32(&rng) % 4 == 0) ++ends.frame;
    std::uint32_t begin = next_u32(&rng) % 21, count = 1 + next_u32(&rng) % (21 - begin < 8 ? 21 - begin : 8);
    REQUIRE(decode_rows(ends.decoder, ends.encode(picture.data(), begin, count, any_coding(&rng))));
    std::copy_n(picture.data() + begin * 66, count * 66, sent.data() + begin * 66);
    REQUIRE(ends.holds(sent));
  }
}

// Goal: near-lossless rows are off by at most a level of their format per channel, however many frames build on them,
// and both ends hold the same. Method: drifting ramps with noise of a level.
TEST_CASE("codec_near_lossless_pixels_are_off_by_at_most_a_level") {
  Rng rng = make_rng(7);
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
    CodecShape shape = {80, 40, 8, format};
    CodecEnds near(shape), exact(shape);
    const bool is_565 = format == WireFormat::rgb565;
    std::size_t near_bytes = 0, exact_bytes = 0;
    int off = 0;
    for (std::uint32_t frame = 0; frame < 20; ++frame) {
      Bytes picture(80 * 40 * pixel_bytes(format));
      for (std::uint32_t i = 0; i < 80 * 40; ++i) {
        const std::uint32_t ramp = (i % 80 + i / 80 + frame) / 4 + next_u32(&rng) % 2;
        is_565 ? Pixel565::store(&picture[i * 2], (ramp & 31) << 11)
               : Pixel888::store(&picture[i * 3], 0x010101 * ramp);
      }
      near_bytes += near.send(picture, RowCoding::near_lossless);
      exact_bytes += exact.send(picture, RowCoding::lossless);
      for (std::uint32_t y = 0; y < 40; ++y)
        for (std::uint32_t x = 0; x < 80; ++x)
          for (int c = 0; c < 3; ++c) {
            const std::size_t at = x * pixel_bytes(format), in_picture = y * near.row_bytes() + at;
            const std::uint8_t *got = picture_row(near.decoder->state, y) + at,
                               *sent = picture_row(near.encoder->state, y) + at;
            const int a = static_cast<int>(is_565 ? channel_of<Pixel565>(Pixel565::load(got), c) : got[c]);
            const int b = static_cast<int>(is_565 ? channel_of<Pixel565>(Pixel565::load(&picture[in_picture]), c)
                                                  : picture[in_picture + static_cast<std::size_t>(c)]);
            REQUIRE(std::abs(a - b) <= 1);
            REQUIRE(std::memcmp(got, sent, pixel_bytes(format)) == 0);
            off += a != b;
          }
    }
    CHECK(off > 0);
    CHECK(2 * near_bytes < exact_bytes);
  }
}

// Goal: an unchanged picture takes at most a byte per chunk, coded or raw, and noise no more than its own bytes.
TEST_CASE("codec_unchanged_rows_take_a_byte_noise_its_own") {
  Rng rng = make_rng(3);
  CodecShape shape = {320, 240, 16, WireFormat::rgb565};
  CodecEnds ends(shape);
  Bytes picture(320 * 240 * 2);
  for (std::uint8_t& byte : picture) byte = static_cast<std::uint8_t>(next_u32(&rng));
  CHECK(ends.send(picture, RowCoding::lossless) == picture.size());
  ends.send(picture, RowCoding::lossless);  // adapts
  CHECK(ends.send(picture, RowCoding::lossless) <= 15);
  CHECK(ends.send(picture, RowCoding::raw) <= 15);
  CHECK(ends.holds(picture));
}

// Goal: a picture that moves takes only its motion and the blocks into which something new comes: at most 13 % here.
// Method: noise, which nothing else predicts, moved along both axes.
TEST_CASE("codec_moved_noise_takes_its_motion") {
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
    CodecShape shape = {160, 96, 8, format};
    CodecEnds ends(shape);
    Rng rng = make_rng(10);
    Bytes scene(256 * 256 * pixel_bytes(format));
    for (std::uint8_t& byte : scene) byte = static_cast<std::uint8_t>(next_u32(&rng));
    std::size_t bytes = 0;
    std::uint32_t left = 40, top = 80;
    for (int frame = 0; frame < 12; ++frame) {
      Bytes picture(160 * 96 * pixel_bytes(format));
      for (std::uint32_t y = 0; y < 96; ++y)
        std::copy_n(scene.data() + ((top + y) * 256 + left) * pixel_bytes(format), 160 * pixel_bytes(format),
                    picture.data() + y * ends.row_bytes());
      bytes = ends.send(picture, RowCoding::lossless);
      REQUIRE(ends.holds(picture));
      if (frame > 0) CHECK(6 * bytes < picture.size());
      left += 1, top -= frame % 2;
    }
  }
}

// Goal: motions of neighbours that are further apart than a code can express cost bytes, not pixels. Method: noise in
// two halves that move apart, faster by a pixel from frame to frame, so that each block knows its motion from below.
TEST_CASE("codec_motions_far_apart_keep_pixels") {
  CodecShape shape = {1024, 16, 8, WireFormat::rgb565};
  CodecEnds ends(shape);
  Rng rng = make_rng(11);
  constexpr std::int32_t kWide = 1 << 15;
  std::vector<std::uint16_t> scene(kWide * 16);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const std::uint32_t before = i > 0 ? scene[i - 1] >> 5 : 32, step = next_u32(&rng) % 5;
    scene[i] = static_cast<std::uint16_t>(((before + step < 2 ? 0 : before + step - 2) & 63) << 5);
  }
  std::int32_t moved = 0;
  for (std::int32_t speed = 0; speed <= 150; ++speed) {
    moved += speed;
    Bytes picture(1024 * 16 * 2);
    for (std::int32_t y = 0; y < 16; ++y)
      for (std::int32_t x = 0; x < 1024; ++x) {
        const std::int32_t from = kWide / 2 + (x < 512 ? x - moved : x + moved);
        Pixel565::store(&picture[static_cast<std::size_t>(y * 1024 + x) * 2],
                        scene[static_cast<std::size_t>(y * kWide + from)]);
      }
    const std::size_t bytes = ends.send(picture, RowCoding::lossless);
    REQUIRE(ends.holds(picture));
    if (speed > 0 && speed < 120) CHECK(2 * bytes < picture.size());
  }
}

// Goal: restarted ends behave like new ones: the same bytes again, and a broken decoder works again.
TEST_CASE("codec_restarted_is_as_new") {
  Rng rng = make_rng(4);
  CodecShape shape = {64, 48, 16, WireFormat::rgb888};
  CodecEnds ends(shape);
  Bytes picture(64 * 48 * 3);
  for (std::size_t i = 0; i < picture.size(); ++i) picture[i] = static_cast<std::uint8_t>(i / 7 + next_u32(&rng) % 3);
  std::size_t first = ends.send(picture, RowCoding::lossless);
  CHECK(ends.send(picture, RowCoding::lossless) < first);
  Bytes junk = {0xFF, 0xFF, 0xFF};
  CHECK(!decode_rows(ends.decoder, chunk_of(junk, 0)));
  CHECK(!decode_rows(ends.decoder, ends.encode(picture.data(), 0, 1, RowCoding::lossless)));
  restart_row_encoder(ends.encoder);
  restart_row_decoder(ends.decoder);
  CHECK(ends.send(picture, RowCoding::lossless) == first);
  CHECK(ends.holds(picture));
}

// Goal: the memory is as need() says: two versions of the picture and little else.
TEST_CASE("codec_need_is_what_it_takes") {
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
    CodecShape shape = {320, 240, 16, format};
    CodecEnds ends(shape);
    CHECK(ends.arena.used == row_encoder_need(shape) + row_decoder_need(shape));
    std::printf("%u bytes a pixel: sender %zu bytes, receiver %zu\n", pixel_bytes(format), row_encoder_need(shape),
                row_decoder_need(shape));
    CHECK(row_decoder_need(shape) < 320 * 240 * 2 * pixel_bytes(format) + (12 << 10));
  }
}

// Goal: chunks that no encoder writes are refused. Method: a picture of 16 × 4 and one fault each; code with a motion
// out of the picture on each side.
TEST_CASE("codec_chunks_that_do_not_fit_are_refused") {
  CodecShape shape = {16, 4, 2, WireFormat::rgb565};
  CodecEnds ends(shape);
  auto moved = [&](int x, int y) {
    Bytes bytes(200);
    restart_codec_state(&ends.encoder->state);
    CodecState* s = &ends.encoder->state;
    begin_rows(s, 1, 0, 1);
    RangeEncoder coder(bytes.data(), bytes.size());
    const CodecShape wide = {999, 999, 1, WireFormat::rgb565};
    for (std::uint32_t column : {400u, 408u}) {  // where any motion stays inside
      BlockChoice choice = {BlockKind::exact, {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)}};
      const BlockChoice beside = column == 400 ? BlockChoice() : choice;
      REQUIRE(code_choice(&coder, &s->models.block, wide, {column, 8, 400, 401}, beside, BlockKind::spatial, &choice));
    }
    bytes.resize(coder.finish());
    return bytes;
  };
  const Bytes inside = moved(0, 3), row(32, 7), none;
  Bytes longer = inside, ends_in_zero = inside;
  longer.insert(longer.end(), {9, 9, 9, 9, 9, 9, 9, 9}), ends_in_zero.push_back(0);
  struct Fault {
    const char* what;
    Bytes body;
    std::uint8_t encoding;
    std::uint16_t row_begin, row_count;
  };
  const Fault faults[] = {
      {"empty", none, 0, 0, 1},
      {"unknown encoding", row, 2, 0, 1},
      {"no rows", none, 0, 0, 0},
      {"no rows, coded", none, 1, 0, 0},
      {"more rows than a chunk may have", Bytes(96), 0, 0, 3},
      {"rows beyond the picture", Bytes(64), 0, 3, 2},
      {"rows far beyond the picture", row, 0, 65535, 1},
      {"a byte too few", Bytes(31), 0, 0, 1},
      {"a byte too many", Bytes(33), 0, 0, 1},
      {"moved out to the left", moved(-1, 0), 1, 0, 1},
      {"moved out to the right", moved(9, 0), 1, 0, 1},
      {"moved out above", moved(0, -1), 1, 0, 1},
      {"moved out below", moved(0, 4), 1, 0, 1},
      {"moved far out", moved(0, 255), 1, 0, 1},
      {"code that goes on", longer, 1, 0, 1},
      {"code that ends in zeros", ends_in_zero, 1, 0, 1},
      {"code longer than the pixels", Bytes(33, 1), 1, 0, 1},
  };
  for (const Fault& fault : faults) {
    CAPTURE(fault.what);
    restart_row_decoder(ends.decoder);
    CHECK(!decode_rows(ends.decoder, chunk_of(fault.body, fault.encoding, fault.row_begin, fault.row_count)));
    restart_row_decoder(ends.decoder);
    CHECK(decode_rows(ends.decoder, chunk_of(row, 0, 3, 1)));
    RowChunk next = chunk_of(inside, 1, 0, 1);
    next.frame = 2;
    CHECK(decode_rows(ends.decoder, next));
    CHECK(picture_row(ends.decoder->state, 0)[31] == 7);
  }
}

// Goal: chunks truncated at any byte, with any byte flipped, or of random bytes do no harm: they are refused or give
// other pixels. Method: a sanitizer, and the picture's size; the codec alone, without the message's checksum.
TEST_CASE("codec_damaged_chunks_are_harmless") {
  Rng rng = make_rng(6);
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
    CodecShape shape = {40, 16, 8, format};
    CodecEnds ends(shape);
    Bytes picture(40 * 16 * pixel_bytes(format));
    for (std::size_t i = 0; i < picture.size(); ++i)
      picture[i] = static_cast<std::uint8_t>(i % 23 + next_u32(&rng) % 2);
    RowChunk chunk = ends.encode(picture.data(), 8, 8, RowCoding::lossless);
    REQUIRE(chunk.encoding == kEncodingCoded);
    const Bytes good(chunk.bytes.begin(), chunk.bytes.end());
    int refused = 0;
    for (std::size_t at = 0; at < good.size(); ++at)
      for (int way = 0; way < 3; ++way) {
        Bytes damaged = good;
        if (way == 0) damaged.resize(at);
        if (way == 1) damaged[at] ^= static_cast<std::uint8_t>(1 + next_u32(&rng) % 255);
        if (way == 2)
          for (std::uint8_t& byte : damaged) byte = static_cast<std::uint8_t>(next_u32(&rng));
        restart_row_decoder(ends.decoder);
        bool right = decode_rows(ends.decoder, chunk_of(damaged, kEncodingCoded, 8, 8));
        refused += !right;
        for (std::uint32_t y = 8; right && y < 16; ++y)
          right =
              std::memcmp(picture_row(ends.decoder->state, y), &picture[y * ends.row_bytes()], ends.row_bytes()) == 0;
        REQUIRE(!right);
      }
    CHECK(refused > 0);
  }
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

// Goal: the prediction is LOCO-I's, channel by channel. Method: a pixel between its neighbours in one channel at a
// time.
TEST_CASE("predict_is_the_median_of_left_below_and_plane") {
  for (int c = 0; c < 3; ++c) {
    auto with = [c](std::uint32_t level) { return (0x090909u & ~(255u << 8 * c)) | level << 8 * c; };
    auto predicted = [&](std::uint32_t corner, std::uint32_t below, std::uint32_t left) {
      const std::uint32_t pixel = predict<Pixel888>(with(left), with(below), with(corner));
      CHECK(pixel == with(pixel >> 8 * c & 255));
      return pixel >> 8 * c & 255;
    };
    CHECK(predicted(10, 20, 12) == 20);  // corner below both: the larger
    CHECK(predicted(30, 20, 12) == 12);  // above both: the smaller
    CHECK(predicted(15, 20, 12) == 17);  // between: the plane
    CHECK(predicted(12, 20, 12) == 20);
    CHECK(predicted(20, 20, 12) == 12);
  }
}
