// The objects of `seesaw`, each appended in its own space. Sizes are constexpr, as in mesh_writer.h.
#pragma once
#include "scene/builtin/mesh_writer.h"

namespace pocketray {

enum SeesawMaterial : std::uint32_t {
  kTentRed,
  kTentCream,
  kSawdust,
  kCurbRed,
  kGold,
  kPoleWood,
  kBoardBlue,
  kIron,
  kWormSkin,
  kWormBelly,
  kEyeWhite,
  kPupil,
  kMouth,
  kHat,
  kSeesawMaterialCount
};

// The tent does not move: striped wall, pennants, roof, floor, ring, poles and the tub that carries the seesaw.
constexpr std::uint32_t kTentStripes = 48, kRoofBands = 3, kFloorColumns = 108, kCurbColumns = 64, kPoleColumns = 16,
                        kTubColumns = 40, kCurbPoints = 5, kTubPoints = 7;
constexpr MeshSize kStripeSize = quad_size() + MeshSize{3, 1} + kRoofBands * quad_size();
constexpr MeshSize kTentSize = kTentStripes * kStripeSize + MeshSize{kFloorColumns + 1, kFloorColumns} +
                               lathe_size(kCurbColumns, kCurbPoints, 0) + 2 * lathe_size(kPoleColumns, 2, 0) +
                               lathe_size(kTubColumns, kTubPoints, 1);
void add_tent(MeshWriter* mesh);

// Middle at the origin, along x.
constexpr MeshSize kBoardSize = 3 * box_size();
void add_board(MeshWriter* mesh);

// Underside at the origin; an iron kettle weight with a ring as a handle.
constexpr std::uint32_t kWeightColumns = 32, kWeightPoints = 8, kHandleColumns = 16, kHandleRows = 8;
constexpr MeshSize kHandleSize = {kHandleColumns * kHandleRows, 2 * kHandleColumns* kHandleRows};
constexpr MeshSize kWeightSize = lathe_size(kWeightColumns, kWeightPoints, 2) + kHandleSize;
void add_weight(MeshWriter* mesh);

// Straight along +y from its tail at the origin, looking along +z. Vertices above kWormLength - kWormHead belong to the
// head.
constexpr std::uint32_t kWormColumns = 30, kWormRows = 47, kHatColumns = 24;
constexpr float kWormHead = 0.35f;
constexpr MeshSize kWormSize = tube_size(kWormColumns, kWormRows) + 2 * sphere_size(14, 9) + 2 * sphere_size(10, 5) +
                               sphere_size(12, 5) + 2 * sphere_size(8, 4) + lathe_size(kHatColumns, 3, 2) +
                               sphere_size(10, 6);
void add_worm(MeshWriter* mesh);

}  // namespace pocketray
