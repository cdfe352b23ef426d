// Stored radiosity in hostile files.
#include <doctest/doctest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "scene/baked.h"

using namespace pocketray;

namespace {

struct Stored {
  Vec3 positions[3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  Triangle triangle = Triangle(0, 1, 2, 0);
  Material material;
  RadiosityInfo info = {{4, 4, 4}};
  std::uint32_t places[2] = {kRadiosityGridBit, 0};
  RadiosityGrid grid = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2, 0};
  RadiosityNode nodes[4] = {};
  RadiosityCorners corners = {{0, 1, 2}};
  Vec3 values[3] = {};
  RadiositySplit splits[2] = {{{kRadiositySplitBit | 2u << kRadiosityTurnShift | 1, 0}},
                              {{1u << kRadiosityLevelShift, 0}}};
  RadiosityCut cuts[2] = {{{0, 0, 0}, {1, 0, 0}, {kRadiosityCutBits | 1, kRadiosityGridBit}},
                          {{0, 0, 0}, {0, 1, 0}, {kRadiosityGridBit, kRadiosityGridBit}}};
  Scene scene;
  void bind() {
    scene.positions = {positions, 3}, scene.triangles = {&triangle, 1}, scene.materials = {&material, 1};
    scene.radiosity_info = {&info, 1}, scene.radiosity_triangles = {places, 2};
    scene.radiosity_grids = {&grid, 1}, scene.radiosity_nodes = {nodes, 4};
    scene.radiosity_corners = {&corners, 1}, scene.radiosity_values = {values, 3};
    scene.radiosity_splits = {splits, 2}, scene.radiosity_cuts = {cuts, 2};
  }
};

}  // namespace

// Goal: a faulty solution is refused with a line that names the fault. Method: one fault after the other in a valid
// one.
TEST_CASE("radiosity_faults_are_named") {
  struct Fault {
    std::function<void(Stored*)> make;
    const char* says;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Fault faults[] = {
      {[](Stored* s) { s->places[0] = kRadiosityGridBit | 1; }, "grid 1 of 1"},
      {[](Stored* s) { s->places[1] = 1; }, "corners 1 of 1"},
      {[](Stored* s) { s->places[1] = kRadiosityAtVertices, s->scene.radiosity_values.count = 2, s->corners = {}; },
       "2 radiosity_values for 3 vertices"},
      {[](Stored* s) { s->corners.value[2] = 3; }, "value 3 of 3"},
      {[](Stored* s) { s->grid.columns = 1; }, "1 by 2 nodes"},
      {[](Stored* s) { s->grid.rows = 257; }, "2 by 257 nodes"},
      {[](Stored* s) { s->grid.node_begin = 1; }, "beyond the scene's 4 nodes"},
      {[](Stored* s) { s->grid.node_begin = ~0u; }, "beyond the scene's 4 nodes"},
      {[nan](Stored* s) { s->grid.along_s.x = nan; }, "not finite"},
      {[nan](Stored* s) { s->nodes[3].dst.y = nan; }, "radiosity_nodes[3]"},
      {[](Stored* s) { s->nodes[2].value.y = -1; }, "radiosity_nodes[2]"},
      {[](Stored* s) { s->values[1].z = -1e-3f; }, "radiosity_values[1]"},
      {[nan](Stored* s) { s->info.value_max.x = nan; }, "radiosity_info[0]"},
      {[](Stored* s) { s->scene.radiosity_info.count = 0; }, "0 radiosity_info"},
      {[](Stored* s) { s->scene.radiosity_triangles.count = 0; }, "1 radiosity_info"},
      {[](Stored* s) { s->scene.triangles.count = 0; }, "2 sides of 0 triangles"},
      {[](Stored* s) { s->places[1] = kRadiositySplitBit | 2; },
       "radiosity_triangles[1] refers to split 0x40000002 of 2"},
      {[](Stored* s) { s->places[1] = kRadiositySplitBit | 3u << kRadiosityTurnShift; }, "split 0x70000000"},
      {[](Stored* s) { s->places[1] = kRadiositySplitBit | 1u << kRadiosityLevelShift; }, "split 0x40800000"},
      {[](Stored* s) { s->splits[1].part[1] = 1; }, "radiosity_splits[1] has part 0x1 of 1 corners"},
      {[](Stored* s) { s->splits[0].part[1] = kRadiositySplitBit | 2; }, "part 0x40000002 of 2 splits"},
      {[](Stored* s) { s->splits[0].part[1] = kRadiosityGridBit; }, "part 0x80000000"},
      {[](Stored* s) { s->splits[0].part[1] = kNone; }, "part 0xffffffff"},
      {[](Stored* s) { s->splits[0].part[1] = kRadiositySplitBit | 3u << kRadiosityTurnShift | 1; }, "part 0x70000001"},
      {[](Stored* s) { s->splits[0].part[1] = 1u << kRadiosityTurnShift; }, "part 0x10000000"},
      {[](Stored* s) { s->places[1] = kRadiosityCutBits | 2; }, "radiosity_triangles[1] refers to cut 2 of 2"},
      {[nan](Stored* s) { s->cuts[1].across.z = nan; }, "radiosity_cuts[1] is not finite"},
      {[](Stored* s) { s->cuts[1].part[1] = kRadiosityGridBit | 1; }, "part 0x80000001 of 1 grids"},
      {[](Stored* s) { s->cuts[1].part[1] = 0; }, "radiosity_cuts[1] has part 0 of 1 grids"},
      {[](Stored* s) { s->cuts[1].part[0] = kNone; }, "part 0xffffffff"},
      {[](Stored* s) { s->cuts[0].part[1] = kRadiosityCutBits | 2; }, "part 0xc0000002 of 2 cuts"},
      {[](Stored* s) { s->cuts[1].part[1] = kRadiosityCutBits | 1; }, "radiosity_cuts[1] has part 0xc0000001"},
      {[](Stored* s) { s->splits[1].part[0] = 0; }, "radiosity_splits[0] has a part of no higher level"},
      {[](Stored* s) { s->splits[0].part[1] = kRadiositySplitBit; },
       "radiosity_splits[0] has a part of no higher level"},
  };
  Stored sound;
  sound.bind();
  CHECK(validate_scene(sound.scene).ok);
  for (const Fault& fault : faults) {
    CAPTURE(fault.says);
    Stored s;
    s.bind();
    fault.make(&s);
    Status status = validate_scene(s.scene);
    REQUIRE_FALSE(status.ok);
    CAPTURE(std::string(status.message));
    CHECK(std::strstr(status.message, fault.says) != nullptr);
  }
}
