// Embree's side of the comparison: devices held to an instruction set or not, scenes by flags and build quality, rays
// one at a time or in packets.
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

// What is compared for these rays; the fast mode alone has a high build quality (Embree 3.13 builds its robust mode and
// its compact one at medium quality whatever is asked for); packets wider than four where the CPU is used in full.
std::vector<EmbreeMode> embree_modes(RayKindOfBench kind, const std::string& isa);

class EmbreeSide {
 public:
  // "sse2" or "native". The scene must outlive it.
  EmbreeSide(const BenchScene& scene, const std::string& isa);
  ~EmbreeSide();
  EmbreeSide(const EmbreeSide&) = delete;
  EmbreeSide& operator=(const EmbreeSide&) = delete;

  // The scene for a mode, built at the first call.
  RTCScene scene_for(const EmbreeMode& mode);
  // Bytes that the device holds now, by its memory monitor.
  std::size_t bytes() const { return bytes_; }
  RTCScene build(const EmbreeMode& mode);

 private:
  RTCDevice device_;
  std::vector<float> vertices_;  // padded: Embree reads 16 bytes a vertex
  std::vector<std::uint32_t> indices_;
  const BenchScene& bench_;
  std::map<std::pair<bool, EmbreeBuild>, RTCScene> scenes_;
  std::size_t bytes_ = 0;
};

// Rays in the layout that Embree likes best, and the hits that it wrote out.
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
