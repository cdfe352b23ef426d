#include "desktop/sweep/network/sent_frames.h"

#include <algorithm>

#include "base/check.h"
#include "desktop/accuracy/display.h"
#include "desktop/accuracy/network/row_stream.h"
#include "engine/frame.h"
#include "remote/client/client.h"
#include "session/camera_control.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

// While it exists, the camera may move.
struct MovedCamera {
  Renderer* renderer;
  Camera camera;
  bool overridden;
  explicit MovedCamera(Renderer* moved)
      : renderer(moved), camera(moved->view.camera), overridden(moved->view.camera_overridden) {}
  ~MovedCamera() { renderer->view.camera = camera, renderer->view.camera_overridden = overridden; }
};

}  // namespace

Status send_frames(Rig* rig, const Configuration& configuration, double seconds, SentPicture* sent) {
  CHECK(rig != nullptr && sent != nullptr);
  CHECK_EQ(rig->part_pixels, 0u);
  Renderer* renderer = &rig->opened.renderer;
  RETURN_IF_ERROR(change_settings(renderer, configuration.settings));
  RETURN_IF_ERROR(begin_frame(renderer, {seconds}));  // returns the camera to the scene's
  const OutputFormat& output = kOutputFormats[configuration.output];
  const std::uint32_t width = renderer->settings.width, height = renderer->settings.height;
  RowStream stream;
  open_row_stream({width, height, std::min(kChunkRowsMax, height),
                   output.format.bits_per_pixel == 16 ? WireFormat::rgb565 : WireFormat::rgb888},
                  &stream);
  const RowCoding coding = configuration.near_lossless ? RowCoding::near_lossless : RowCoding::lossless;
  const MovedCamera before(renderer);
  const CameraControl path = make_camera_control(renderer->view.camera, renderer->accel.built.bounds);
  double bytes = 0;
  for (std::uint32_t left = kSentFrames; left-- > 0;) {
    const Camera turned = orbited_camera(path, static_cast<float>(-kSentOrbitDegrees * left));
    RETURN_IF_ERROR(set_camera(renderer, left > 0 ? turned : before.camera));
    RETURN_IF_ERROR(render_frame(renderer, seconds, Aov::none, &interrupted));
    if (interrupted) return success();
    const std::vector<std::uint8_t> pixels =
        packed_pixels(renderer->image.data, width, height, display_of(*renderer), output);
    const std::size_t sent_bytes = send_picture(&stream, pixels.data(), coding);
    if (left + 1 < kSentFrames) bytes += static_cast<double>(sent_bytes);
  }
  sent->bytes_per_frame = bytes / (kSentFrames - 1);
  std::vector<std::uint8_t> shown;
  const std::size_t row_bytes = std::size_t(width) * static_cast<std::size_t>(output.format.bits_per_pixel / 8);
  for (std::uint32_t row = 0; row < height; ++row)
    shown.insert(shown.end(), shown_row(stream, row), shown_row(stream, row) + row_bytes);
  sent->levels = unpacked_levels(shown.data(), width, height, output.format);
  return success();
}

}  // namespace pocketray
