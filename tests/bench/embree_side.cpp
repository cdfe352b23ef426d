#include "bench/embree_side.h"

#include "base/check.h"

namespace pocketray {
namespace {

bool count_bytes(void* sum, ssize_t bytes, bool) {
  *static_cast<std::size_t*>(sum) += static_cast<std::size_t>(bytes);
  return true;
}

}  // namespace

std::string mode_name(const EmbreeMode& mode) {
  return (mode.lanes == 1 ? std::string("single") : "packet" + std::to_string(mode.lanes)) +
         (mode.robust ? " robust " : " fast ") + kEmbreeBuildNames[static_cast<int>(mode.build)];
}

std::vector<EmbreeMode> embree_modes(RayKindOfBench kind, const std::string& isa) {
  constexpr EmbreeBuild kMedium = EmbreeBuild::medium, kHigh = EmbreeBuild::high, kCompact = EmbreeBuild::compact;
  std::vector<EmbreeMode> modes = {
      {1, true, kMedium}, {1, true, kCompact}, {1, false, kMedium}, {1, false, kHigh}, {1, false, kCompact}};
  if (kind != RayKindOfBench::primary) return modes;
  for (int lanes = 4; lanes <= (isa == "native" ? 16 : 4); lanes *= 2)
    for (EmbreeBuild build : {kMedium, kHigh}) modes.push_back({lanes, false, build});
  return modes;
}

EmbreeSide::EmbreeSide(const BenchScene& scene, const std::string& isa) : bench_(scene) {
  device_ = rtcNewDevice(isa == "native" ? "threads=1" : ("threads=1,isa=" + isa).c_str());
  CHECK_EQ(rtcGetDeviceError(nullptr), RTC_ERROR_NONE);
  rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
  for (const Vec3& p : scene.scene().positions) vertices_.insert(vertices_.end(), {p.x, p.y, p.z});
  vertices_.push_back(0);
  for (const Triangle& t : scene.scene().triangles)
    for (std::uint32_t vertex : t.vertices()) indices_.push_back(vertex);
}

EmbreeSide::~EmbreeSide() {
  for (auto& entry : scenes_) rtcReleaseScene(entry.second);
  rtcReleaseDevice(device_);
}

RTCScene EmbreeSide::build(const EmbreeMode& mode) {
  const Scene& s = bench_.scene();
  RTCScene scene = rtcNewScene(device_);
  int flags =
      (mode.robust ? RTC_SCENE_FLAG_ROBUST : 0) | (mode.build == EmbreeBuild::compact ? RTC_SCENE_FLAG_COMPACT : 0);
  rtcSetSceneFlags(scene, static_cast<RTCSceneFlags>(flags));
  RTCBuildQuality quality = mode.build == EmbreeBuild::high ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
  rtcSetSceneBuildQuality(scene, quality);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0, 12,
                             s.positions.count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_.data(), 0, 12,
                             s.triangles.count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  CHECK_EQ(rtcGetDeviceError(device_), RTC_ERROR_NONE);
  return scene;
}

RTCScene EmbreeSide::scene_for(const EmbreeMode& mode) {
  RTCScene& scene = scenes_[{mode.robust, mode.build}];
  if (!scene) scene = build(mode);
  return scene;
}

}  // namespace pocketray
