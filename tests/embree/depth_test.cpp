// Depth against an independent ray caster.
#include <doctest/doctest.h>
#include <embree3/rtcore.h>

#include <sys/stat.h>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "engine/frame.h"
#include "session/source.h"
#include "shade/camera.h"

using namespace pocketray;

namespace {

struct EmbreeCaster {
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scene = rtcNewScene(device);

  explicit EmbreeCaster(const Scene& s) {
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, s.positions.count));
    for (std::uint32_t i = 0; i < s.positions.count; ++i)
      for (int axis = 0; axis < 3; ++axis) vertices[3 * i + static_cast<std::uint32_t>(axis)] = s.positions[i][axis];
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, s.triangles.count));
    for (std::uint32_t i = 0; i < s.triangles.count; ++i)
      for (std::uint32_t k = 0; k < 3; ++k) indices[3 * i + k] = s.triangles[i].vertex(k);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  ~EmbreeCaster() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  // Distance along the ray; 0 where nothing is hit.
  float cast(const Ray& ray) const {
    RTCRayHit hit = {};
    hit.ray.org_x = ray.origin.x, hit.ray.org_y = ray.origin.y, hit.ray.org_z = ray.origin.z;
    hit.ray.dir_x = ray.direction.x, hit.ray.dir_y = ray.direction.y, hit.ray.dir_z = ray.direction.z;
    hit.ray.tfar = ray.t_max;
    hit.ray.mask = ~0u;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &hit);
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? 0 : hit.ray.tfar;
  }
};

// Share of pixels whose depth agrees to 1e-4, relatively.
double agreement(const std::string& name) {
  Settings settings;
  std::size_t block_bytes = std::size_t(256) << 20;
  auto block = std::make_unique<unsigned char[]>(block_bytes);
  auto renderer = std::make_unique<Renderer>();
  SceneSource source;
  SceneStorage storage;
  start_renderer(block.get(), block_bytes, settings, renderer.get());
  REQUIRE(load_scene(name, renderer.get(), &source, &storage).ok);
  REQUIRE(plan_renderer(renderer.get(), storage, 0).ok);
  REQUIRE(build_renderer(renderer.get()).ok);
  REQUIRE(render_frame(renderer.get(), 0, Aov::depth).ok);
  EmbreeCaster embree(renderer->scene);
  std::uint32_t agree = 0;
  for (std::uint32_t row = 0; row < settings.height; ++row) {
    for (std::uint32_t column = 0; column < settings.width; ++column) {
      Ray ray =
          camera_ray(renderer->frame.view.camera, static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
      float theirs = embree.cast(ray),
            ours = renderer->image[static_cast<std::size_t>(row) * settings.width + column].x;
      agree += std::fabs(ours - theirs) <= 1e-4f * theirs;
    }
  }
  double share = static_cast<double>(agree) / (settings.width * settings.height);
  std::printf("%s: depth agrees on %.4f %% of the pixels\n", name.c_str(), share * 100);
  return share;
}

}  // namespace

// Goal: primary visibility is right. Method: every pixel of 320×240 against Embree in its robust mode; what disagrees
// may only lie on silhouettes, at most one pixel in a thousand.
TEST_CASE("depth_agrees_with_embree_on_built_in_scenes") {
  CHECK(agreement("cornell") >= 0.999);
  CHECK(agreement("statue") >= 0.999);
}

TEST_CASE("depth_agrees_with_embree_on_models") {
  const char* models[] = {"mesh/happy_vrip_res3.ply",
                          "gltf/Duck.glb",
                          "cornell/mcguire/CornellBox-Original.obj",
                          "cornell/mcguire/CornellBox-Sphere.obj",
                          "cornell/mcguire/CornellBox-Mirror.obj",
                          "cornell/embree/cornell_box.obj",
                          "cornell/bevy_CornellBox.glb"};
  for (const char* model : models) {
    std::string path = std::string(POCKETRAY_SHARED "/scenes/") + model;
    struct stat info;
    if (stat(path.c_str(), &info) != 0) {
      std::printf("skipped: %s is not here\n", path.c_str());
      continue;
    }
    CHECK(agreement(path) >= 0.999);
  }
}
