// The codec on real frames: sizes, and lossless transfer.
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
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
  Camera camera = test->renderer.view.camera;
  for (int i = 0; i < count; ++i) {
    Vec3 aside = step * (camera.target - camera.eye);
    camera.eye.x += aside.z, camera.eye.z -= aside.x;
    if (step > 0) REQUIRE(set_camera(&test->renderer, camera).ok);
    REQUIRE(render_frame(&test->renderer, i / 25.0).ok);
    Bytes bytes(kWidth * kHeight * pixel_bytes(format));
    int width = static_cast<int>(kWidth), height = static_cast<int>(kHeight);
    pack_rows(test->renderer.image.data, width, height, 0, height, display_of(test->renderer),
              format == WireFormat::rgb565 ? kRgb565 : kRgb888, Rotation::none, false, bytes.data(),
              width * static_cast<int>(pixel_bytes(format)));
    frames.push_back(bytes);
  }
  return frames;
}

struct Sent {
  std::size_t bytes = 0, last = 0, alone = 0;  // of all frames; of the last; if each frame were a connection's first
  double encode_ns = 0, decode_ns = 0;         // per pixel
  double squares = 0;                          // mean square error of a channel, in levels of the format
};

double clock_ns() {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <class Pixel>
double squares(const std::uint8_t* a, const std::uint8_t* b) {
  double sum = 0;
  for (std::uint32_t i = 0; i < kWidth; ++i, a += Pixel::kBytes, b += Pixel::kBytes)
    for (int c = 0; c < 3; ++c) {
      const double d = static_cast<double>(channel_of<Pixel>(Pixel::load(a), c)) - channel_of<Pixel>(Pixel::load(b), c);
      REQUIRE(d * d <= 1);
      sum += d * d;
    }
  return sum / (3.0 * kWidth * kHeight);
}

Sent send_frames(const std::vector<Bytes>& frames, WireFormat format, RowCoding coding, std::uint32_t chunk_rows) {
  CodecShape shape = {kWidth, kHeight, chunk_rows, format};
  CodecEnds ends(shape), alone(shape);
  Sent sent;
  for (const Bytes& frame : frames) {
    ++ends.frame;
    sent.last = 0;
    for (std::uint32_t end = kHeight; end > 0;) {
      const std::uint32_t begin = end > chunk_rows ? end - chunk_rows : 0;
      double begin_ns = clock_ns();
      RowChunk chunk = ends.encode(frame.data(), begin, end - begin, coding);
      end = begin;
      double encoded_ns = clock_ns();
      REQUIRE(decode_rows(ends.decoder, chunk));
      sent.encode_ns += encoded_ns - begin_ns, sent.decode_ns += clock_ns() - encoded_ns;
      sent.last += chunk.bytes.count;
    }
    sent.bytes += sent.last;
    for (std::uint32_t y = 0; y < kHeight; ++y) {
      const std::uint8_t *row = picture_row(ends.decoder->state, y), *wanted = &frame[y * ends.row_bytes()];
      sent.squares += (format == WireFormat::rgb565 ? squares<Pixel565>(row, wanted) : squares<Pixel888>(row, wanted)) /
                      static_cast<double>(frames.size());
    }
    REQUIRE((coding == RowCoding::near_lossless || sent.squares == 0));
    restart_row_encoder(alone.encoder), restart_row_decoder(alone.decoder);
    sent.alone += alone.send(frame, coding);
  }
  double pixels = static_cast<double>(frames.size()) * kWidth * kHeight;
  sent.encode_ns /= pixels, sent.decode_ns /= pixels;
  return sent;
}

void print(const char* what, WireFormat format, std::uint32_t chunk_rows, std::size_t frame_count, const Sent& sent) {
  double pixels = static_cast<double>(frame_count) * kWidth * kHeight;
  std::printf(
      "%-24s %s, %u rows a chunk: %.3f bytes a pixel, the last frame %zu bytes, %.2f of first frames; error %.3f "
      "levels; "
      "%.0f ns a pixel to encode, %.0f to decode\n",
      what, format == WireFormat::rgb565 ? "rgb565" : "rgb888", chunk_rows, static_cast<double>(sent.bytes) / pixels,
      sent.last, static_cast<double>(sent.bytes) / static_cast<double>(sent.alone), std::sqrt(sent.squares),
      sent.encode_ns, sent.decode_ns);
}

constexpr int kFrames = kEffortDivisor > 1 ? 3 : 6;
constexpr float kOneDegree = 0.01745f;

}  // namespace

// Goal: frames of the renderer arrive unchanged; a first frame takes at most a ninth of the raw bytes in RGB565, which
// is less than half of the paper's quarter, and a fifth in RGB888; small chunks take little more.
TEST_CASE("codec_real_frames_round_trip_and_take_less") {
  for (const char* name : {"cornell", "statue"})
    for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
      std::vector<Bytes> frames = frames_of(name, format, 1, 0);
      Sent by_chunk[3];
      const std::uint32_t chunks[] = {2, 8, 24};
      for (int i = 0; i < 3; ++i) {
        by_chunk[i] = send_frames(frames, format, RowCoding::lossless, chunks[i]);
        print(name, format, chunks[i], 1, by_chunk[i]);
      }
      CHECK(100 * by_chunk[0].bytes < 115 * by_chunk[2].bytes);
      std::size_t ratio = kWidth < 320 ? 3 : format == WireFormat::rgb565 ? 9 : 5;
      CHECK(ratio * by_chunk[1].bytes < frames[0].size());
    }
}

// Goal: with a moving object only changes are sent: at most a sixteenth of whole frames.
TEST_CASE("codec_moving_object_sends_what_changed") {
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
    std::vector<Bytes> frames = frames_of("seesaw", format, kEffortDivisor > 1 ? 4 : 8, 0);
    Sent all = send_frames(frames, format, RowCoding::lossless, 8);
    Sent first = send_frames({frames[0]}, format, RowCoding::lossless, 8);
    Sent later = all;
    later.bytes -= first.bytes, later.alone -= first.alone;
    print("seesaw, after the first", format, 8, frames.size() - 1, later);
    CHECK(16 * later.bytes <= later.alone);
  }
}

// Goal: with the camera at 1° a frame, which changes nearly every pixel, frames take at most two thirds of first
// frames, since motion predicts them; in RGB565 a tenth of the raw bytes, 16,500 at 320 × 240. Near-lossless frames
// take at most two thirds of that again, at an error below .7 of a level.
TEST_CASE("codec_moving_camera_is_followed") {
  for (const char* name : {"cornell", "statue"})
    for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
      std::vector<Bytes> frames = frames_of(name, format, kFrames, kOneDegree);
      Sent sent = send_frames(frames, format, RowCoding::lossless, 8);
      Sent near = send_frames(frames, format, RowCoding::near_lossless, 8);
      print((std::string(name) + ", 1° a frame").c_str(), format, 8, frames.size(), sent);
      print((std::string(name) + ", near-lossless").c_str(), format, 8, frames.size(), near);
      Sent still = send_frames({frames.back()}, format, RowCoding::lossless, 8);
      CHECK(4 * sent.last < 3 * still.bytes);
      CHECK(4 * near.last < 3 * sent.last);
      CHECK(near.squares < 0.49);
      if (kWidth < 320) continue;  // details of a small picture are smaller
      CHECK(3 * near.last < 2 * sent.last);
      if (format == WireFormat::rgb565) CHECK(10 * sent.last < frames[0].size());
    }
}
