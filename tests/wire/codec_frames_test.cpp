// The codec on real frames: sizes, and lossless transfer.
#include <doctest/doctest.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "present/pack.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/generated_scene.h"
#include "wire/codec_ends.h"

using namespace pocketray;

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kWidth = effort_side(320), kHeight = effort_side(240);

// Packed frames of a built-in scene; the camera moves sideways by `step` of its distance per frame.
std::vector<Bytes> frames_of(const char* name, WireFormat format, int count, float step) {
  auto built = build_builtin(name);
  Settings settings;
  settings.width = kWidth, settings.height = kHeight;
  auto test = make_renderer(built->scene, settings);
  std::vector<Bytes> frames;
  Camera camera = test->renderer.camera;
  for (int i = 0; i < count; ++i) {
    Vec3 aside = step * (camera.target - camera.eye);
    camera.eye.x += aside.z, camera.eye.z -= aside.x;
    if (step > 0) REQUIRE(set_camera(&test->renderer, camera).ok);
    REQUIRE(render_frame(&test->renderer, i / 25.0).ok);
    Bytes bytes(kWidth * kHeight * pixel_bytes(format));
    int width = static_cast<int>(kWidth), height = static_cast<int>(kHeight);
    pack_rows(test->renderer.image.data, width, height, 0, height, test->renderer.exposure,
              format == WireFormat::rgb565 ? kRgb565 : kRgb888, Rotation::none, false, bytes.data(),
              width * static_cast<int>(pixel_bytes(format)));
    frames.push_back(bytes);
  }
  return frames;
}

struct Sent {
  std::size_t persistent = 0, independent = 0, whole = 0;  // bytes of all frames
  double encode_ns = 0, decode_ns = 0;                     // per pixel, sent as by the codec
};

double clock_ns() {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Sends the frames in three ways: as by the codec; with a separate stream for every chunk; and with one stream, but
// whole.
Sent send_frames(const std::vector<Bytes>& frames, WireFormat format, int level, std::uint32_t chunk_rows) {
  CodecShape shape = {kWidth, kHeight, chunk_rows, format};
  CodecEnds ends(shape), apart(shape), whole(shape);
  Sent sent;
  for (const Bytes& frame : frames) {
    for (std::uint32_t end = kHeight; end > 0; end -= chunk_rows) {
      double begin_ns = clock_ns();
      RowChunk chunk = ends.encode(frame.data(), end - chunk_rows, chunk_rows, level);
      double encoded_ns = clock_ns();
      REQUIRE(decode_rows(ends.decoder, chunk));
      sent.encode_ns += encoded_ns - begin_ns, sent.decode_ns += clock_ns() - encoded_ns;
      sent.persistent += chunk.bytes.count;
      REQUIRE(deflateReset(&apart.encoder->state.stream) == Z_OK);
      sent.independent += apart.encode(frame.data(), end - chunk_rows, chunk_rows, level).bytes.count;
    }
    REQUIRE(ends.holds(frame));
    // As for a first frame: every pixel has changed.
    for (std::size_t i = 0; i < frame.size(); ++i)
      whole.encoder->state.picture[i] = static_cast<std::uint8_t>(~frame[i]);
    sent.whole += whole.send(frame, level);
  }
  double pixels = static_cast<double>(frames.size()) * kWidth * kHeight;
  sent.encode_ns /= pixels, sent.decode_ns /= pixels;
  return sent;
}

void print(const char* what, WireFormat format, int level, std::uint32_t chunk_rows, std::size_t frame_count,
           const Sent& sent) {
  double pixels = static_cast<double>(frame_count) * kWidth * kHeight, raw = pixels * pixel_bytes(format);
  double bytes = static_cast<double>(sent.persistent);
  std::printf(
      "%-24s %s level %d, %u rows a chunk: %.3f bytes a pixel, 1/%.1f of raw; independent chunks take %.2f "
      "times that, whole frames %.2f; %.0f ns a pixel to encode, %.0f to decode\n",
      what, format == WireFormat::rgb565 ? "rgb565" : "rgb888", level, chunk_rows, bytes / pixels, raw / bytes,
      static_cast<double>(sent.independent) / bytes, static_cast<double>(sent.whole) / bytes, sent.encode_ns,
      sent.decode_ns);
}

}  // namespace

// Goal: frames of the renderer arrive unchanged; RGB565 takes less than the paper's quarter of the raw bytes. One
// stream takes less than one per chunk, and the advantage grows as chunks shrink.
TEST_CASE("codec_real_frames_round_trip_and_take_less") {
  for (const char* name : {"cornell", "statue"})
    for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
      std::vector<Bytes> frames = frames_of(name, format, 1, 0);
      for (int level : {1, 6})
        for (std::uint32_t chunk_rows : {1, 8}) {
          Sent sent = send_frames(frames, format, level, chunk_rows);
          print(name, format, level, chunk_rows, 1, sent);
          if (chunk_rows == 1) {
            CHECK(20 * sent.independent > 21 * sent.persistent);
            continue;
          }
          CHECK(100 * sent.persistent < 105 * sent.independent);
          // A small picture has few repetitions.
          std::size_t ratio = format == WireFormat::rgb565 && kWidth >= 320 ? 4 : 2;
          CHECK(ratio * sent.persistent < frames[0].size());
        }
    }
}

// Goal: with a moving object only changes are sent: at most a sixth of the whole frames in the same format.
TEST_CASE("codec_moving_object_sends_what_changed") {
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
    std::vector<Bytes> frames = frames_of("seesaw", format, kEffortDivisor > 1 ? 4 : 8, 0);
    Sent all = send_frames(frames, format, 1, 8), first = send_frames({frames[0]}, format, 1, 8);
    Sent later = all;
    later.persistent -= first.persistent, later.independent -= first.independent, later.whole -= first.whole;
    print("seesaw, after the first", format, 1, 8, frames.size() - 1, later);
    CHECK(6 * later.persistent <= later.whole);
  }
}

// Goal: a moving camera changes nearly everything and still takes less than a quarter of the raw bytes.
TEST_CASE("codec_moving_camera_still_takes_less") {
  std::vector<Bytes> frames = frames_of("cornell", WireFormat::rgb565, kEffortDivisor > 1 ? 3 : 6, 0.02f);
  Sent sent = send_frames(frames, WireFormat::rgb565, 1, 8);
  print("cornell, moving camera", WireFormat::rgb565, 1, 8, frames.size(), sent);
  CHECK(4 * sent.persistent < frames.size() * frames[0].size());
}
