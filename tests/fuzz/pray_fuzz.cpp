// A .pray file from anyone: opened, posed, rendered.
#include <memory>

#include "fuzz/fuzz.h"
#include "scene/baked_file.h"
#include "support/generated_scene.h"

POCKETRAY_FUZZ_TARGET(fuzz_pray)

namespace pocketray {
namespace {

// Larger ones take the fuzzer's time and show nothing that small ones do not.
constexpr std::uint32_t kTrianglesToRender = 64;

void render(const Scene& scene) {
  Settings settings;
  settings.width = 4, settings.height = 3, settings.ray_depth = 3, settings.points_per_area_light = 1;
  settings.memory_bytes = 2u << 20;
  Status status;
  std::unique_ptr<TestRenderer> test = make_renderer(scene, settings, nullptr, &status);
  if (!test) return;
  for (double seconds : {0.0, 0.7}) fuzz_counts.frames += render_frame(&test->renderer, seconds).ok;
}

}  // namespace

void fuzz_pray(const std::uint8_t* bytes, std::size_t byte_count) {
  if (byte_count == 0) return;
  bool repair = bytes[0] & 1;
  ++bytes, --byte_count;
  BakedFile file(byte_count);
  if (byte_count > 0) std::memcpy(file.data(), bytes, byte_count);
  if (repair && byte_count >= kTableAt) {
    put_u64(file, kByteCountAt, byte_count);
    fix_checksum(file);
  }
  Scene scene;
  if (!baked_open(file.data(), file.size(), &scene).ok) return;
  ++fuzz_counts.scenes;
  if (scene.triangles.count <= kTrianglesToRender) render(scene);
}

}  // namespace pocketray
