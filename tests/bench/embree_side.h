// Embree's side of the comparison: devices with a limited or full instruction set, scenes by flags and build quality,
// single rays or packets.
#pragma once
#include <embree3/rtcore.h>

#include <map>
#include <string>
#include <vector>

#include "bench/bench_rays.h"

namespace pocketray {

enum class EmbreeBuild : int { medium, high, compact };
constexpr const char* kEmbreeBuildNames[] = {"medium", "high", "compact"};

struct EmbreeMode {
  int lanes;  // 1: one ray at a time; 4, 8, 16: coherent packets
  bool robust;
  EmbreeBuild build;
};
std::string mode_name(const EmbreeMode& mode);  // "single robust medium", "packet4 fast high"

// The modes to compare for these rays. Only the fast mode has a high build quality (Embree 3.13 always builds its
// robust and compact modes at medium quality); packets wider than four only with the native instruction set.
std::vector<EmbreeMode> embree_modes(RayKindOfBench kind, const std::string& isa);

class EmbreeSide {
 public:
  // "sse2" or "native". The scene must outlive it.
  EmbreeSide(const BenchScene& scene, const std::string& isa);
  ~EmbreeSide();
  EmbreeSide(const EmbreeSide&) = delete;
  EmbreeSide& operator=(const EmbreeSide&) = delete;

  // The scene for a mode, built on first use.
  RTCScene scene_for(const EmbreeMode& mode);
  // Bytes currently held by the device, from its memory monitor.
  std::size_t bytes() const { return bytes_; }
  RTCScene build(const EmbreeMode& mode);

 private:
  RTCDevice device_;
  std::vector<float> vertices_;  // padded: Embree reads 16 bytes per vertex
  std::vector<std::uint32_t> indices_;
  const BenchScene& bench_;
  std::map<std::pair<bool, EmbreeBuild>, RTCScene> scenes_;
  std::size_t bytes_ = 0;
};

// Rays in Embree's best layout, and the hits it wrote.
struct EmbreeTask {
  RTCScene scene;
  EmbreeMode mode;
  RayKindOfBench kind;
  Vec3 eye;                       // of primary rays
  std::vector<RTCRay> singles;    // modes of one lane
  std::vector<float> directions;  // packets: x, y, z of the lanes in turn
  std::vector<Hit> hits;          // one lane
  std::vector<unsigned char> occluded;
  std::vector<float> packet_t, packet_u, packet_v;
  std::vector<std::uint32_t> packet_triangle;
};

// Lays out the rays of the set and makes room for the hits.
EmbreeTask make_embree_task(EmbreeSide* side, const EmbreeMode& mode, const RaySet& set);
void trace_embree(EmbreeTask* task);
// The hits in the order of the ray set.
std::vector<Hit> embree_hits(const EmbreeTask& task);

}  // namespace pocketray
