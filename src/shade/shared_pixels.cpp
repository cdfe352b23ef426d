#include "shade/shared_pixels.h"

#include "base/check.h"
#include "shade/window.h"

namespace pocketray {
namespace {

InterleavedPixel as_pixel(const Surface& s) {
  InterleavedPixel pixel = {};
  pixel.triangle = s.hit.triangle, pixel.point = s.point, pixel.normal = s.normal, pixel.geometric = s.geometric;
  return pixel;
}

// Steps to the pixel itself and those around it, the nearest first.
constexpr int kSteps[9][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

}  // namespace

SharedPixel* shared_pixel(Tracer* tracer, std::uint32_t column, std::uint32_t row) {
  const PixelWindow& window = tracer->window;
  if (!is_shared(window)) return nullptr;
  CHECK_GE(row + kRowsAbove, window.row);
  return &window.shared[(row + kRowsAbove - window.row) * tracer->frame->settings.width + column];
}

void take_shared_light(Tracer* tracer, std::uint32_t column, std::uint32_t row, Surface* surface) {
  if (is_zero(surface->diffuse)) return;
  const FrameData& frame = *tracer->frame;
  const InterleavedPixel here = as_pixel(*surface);
  const SharedPixel *same = nullptr, *any = nullptr;
  for (const auto& step : kSteps) {
    const std::uint32_t x = column + static_cast<std::uint32_t>(step[0]), y = row + static_cast<std::uint32_t>(step[1]);
    if (x >= frame.settings.width || y >= frame.settings.height) continue;  // -1 wraps
    const SharedPixel* pixel = shared_pixel(tracer, x, y);
    CHECK(pixel != nullptr);
    if (pixel->pixel.triangle == kNone) continue;
    if (!any) any = pixel;
    if (!shows_same(pixel->pixel, here)) continue;
    same = pixel;
    break;
  }
  for (int source = 0; source < kInterleavedSourceCount; ++source) {
    const InterleavedSource& info = *kInterleavedSources[source];
    if (!has(frame.mask, info.effect)) continue;
    const SharedPixel* from = same ? same : any;
    constexpr InterleavedLight kAllVisible;
    const InterleavedLight& sum = from ? from->pixel.light[source] : kAllVisible;
    const bool are_few = !same || same->are_few[source];
    surface->glow += surface->diffuse * info.irradiance(frame, surface->point, surface->normal, sum, are_few);
  }
}

}  // namespace pocketray
