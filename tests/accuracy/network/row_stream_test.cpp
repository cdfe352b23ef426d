// Pictures whose rows went through both ends of the codec.
#include "desktop/accuracy/network/row_stream.h"

#include <doctest/doctest.h>

#include <cstring>

#include "desktop/accuracy/display.h"
#include "desktop/accuracy/flip.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 160, kHeight = 120, kFrames = 4;

// Cornell from a camera that moves sideways by a hundredth of its distance per frame.
std::vector<Picture> moving_frames(float* exposure) {
  auto built = build_builtin("cornell");
  Settings settings;
  settings.width = kWidth, settings.height = kHeight;
  auto test = make_renderer(built->scene, settings);
  Camera camera = test->renderer.view.camera;
  std::vector<Picture> frames;
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    camera.eye = camera.eye + 0.01f * cross(camera.target - camera.eye, camera.up);
    REQUIRE(set_camera(&test->renderer, camera).ok);
    REQUIRE(render_frame(&test->renderer, 0).ok);
    frames.emplace_back(test->renderer.image.begin(), test->renderer.image.end());
  }
  *exposure = test->renderer.view.exposure;
  return frames;
}

struct Shown {
  std::vector<std::uint8_t> pixels;
  std::size_t bytes = 0;  // of the last frame
};

Shown send(const std::vector<std::vector<std::uint8_t>>& frames, WireFormat format, RowCoding coding) {
  RowStream stream;
  open_row_stream({kWidth, kHeight, 32, format}, &stream);
  Shown shown;
  for (const std::vector<std::uint8_t>& frame : frames) shown.bytes = send_picture(&stream, frame.data(), coding);
  for (std::uint32_t row = 0; row < kHeight; ++row)
    shown.pixels.insert(shown.pixels.end(), shown_row(stream, row),
                        shown_row(stream, row) + kWidth * pixel_bytes(format));
  return shown;
}

}  // namespace

// Goal: near-lossless pictures are off by at most a level in each channel, and by some; they look nearly the same and
// take at most three quarters of the bytes. Lossless ones are equal. Method: the last of some frames of a moving
// camera, in all output formats, against what was sent; ꟻLIP between the two.
TEST_CASE("row_stream_shows_pictures_within_a_level") {
  float exposure;
  const std::vector<Picture> frames = moving_frames(&exposure);
  for (const OutputFormat& output : kOutputFormats) {
    CAPTURE(std::string(output.name));
    const WireFormat format = output.format.bits_per_pixel == 16 ? WireFormat::rgb565 : WireFormat::rgb888;
    std::vector<std::vector<std::uint8_t>> sent;
    for (const Picture& frame : frames) sent.push_back(packed_pixels(frame.data(), kWidth, kHeight, exposure, output));
    const Shown lossless = send(sent, format, RowCoding::lossless), near = send(sent, format, RowCoding::near_lossless);
    CHECK(lossless.pixels == sent.back());
    CHECK(near.pixels != sent.back());
    CHECK(pixels_close(format, near.pixels.data(), sent.back().data(), kWidth * kHeight, 1));
    CHECK(4 * near.bytes < 3 * lossless.bytes);
    CHECK(near.bytes > 0);
    const Levels seen = unpacked_levels(near.pixels.data(), kWidth, kHeight, output.format);
    const Levels right = displayed_levels(frames.back().data(), kWidth, kHeight, exposure, output);
    const double flip = mean_of(flip_errors(encoded_levels(right), encoded_levels(seen), kWidth, kHeight, 20));
    CHECK((flip > 0 && flip < 0.1));
  }
}

// Goal: after a restart a stream is as new. Method: the same picture sent before and after.
TEST_CASE("row_stream_restarts") {
  std::vector<std::uint8_t> pixels(std::size_t(kWidth) * kHeight * 2);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * i >> 7);
  RowStream stream;
  open_row_stream({kWidth, kHeight, 32, WireFormat::rgb565}, &stream);
  const std::size_t first = send_picture(&stream, pixels.data(), RowCoding::lossless);
  CHECK(send_picture(&stream, pixels.data(), RowCoding::lossless) < first);
  restart_row_stream(&stream);
  CHECK(send_picture(&stream, pixels.data(), RowCoding::lossless) == first);
  CHECK(std::memcmp(shown_row(stream, 1), &pixels[kWidth * 2], kWidth * 2) == 0);
}
