#include <zlib.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "support/generated_scene.h"

namespace pocketray {

std::unique_ptr<TestRenderer> make_renderer(const Scene& scene, const Settings& settings, const AccelInfo* accel,
                                            Status* status, bool recolorable) {
  auto test = std::make_unique<TestRenderer>();
  std::size_t bytes = settings.memory_bytes;
  test->block.reset(new std::uint8_t[bytes]);
  Renderer* renderer = &test->renderer;
  start_renderer(test->block.get(), bytes, settings, renderer);
  if (accel) renderer->accel.info = accel;
  renderer->scene = scene;
  renderer->materials.recolorable = recolorable;
  Status result = plan_renderer(renderer, SceneStorage(), 0);
  if (result.ok) {
    renderer->workers = start_workers(settings.threads);
    result = build_renderer(renderer);
  }
  if (status) *status = result;
  if (result.ok) return test;
  if (!status) {
    std::fprintf(stderr, "a test scene was refused: %s\n", result.message);
    std::abort();
  }
  return nullptr;
}

Picture render_picture(const Scene& scene, const Settings& settings, double seconds, const AccelInfo* accel) {
  auto test = make_renderer(scene, settings, accel);
  Status status = render_frame(&test->renderer, seconds);
  if (!status.ok) {
    std::fprintf(stderr, "a test frame failed: %s\n", status.message);
    std::abort();
  }
  const Array<Vec3>& image = test->renderer.image;
  return Picture(image.begin(), image.end());
}

bool same_picture(const Picture& a, const Picture& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

std::uint32_t picture_hash(const Vec3* image, std::size_t pixel_count) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(image), static_cast<uInt>(pixel_count * sizeof(Vec3))));
}

Vec3 trace_ray(const Renderer& renderer, const Vec3& origin, const Vec3& direction, Tracer* tracer) {
  Tracer own = make_tracer(renderer.frame);
  own.light_entries = renderer.tracers[0].light_entries;
  if (!tracer) tracer = &own;
  const FrameData& frame = renderer.frame;
  Ray ray = {origin, direction, __builtin_inff()};
  Hit hit;
  frame.geometry.accel_info->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, nullptr);
  return frame.kernels.radiance(tracer, ray, hit, nullptr);
}

}  // namespace pocketray
