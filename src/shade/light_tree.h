// Groups of lights for source selection.
#pragma once
#include "base/array.h"
#include "base/box.h"
#include "shade/light_point.h"

namespace pocketray {

// A group of lights of one kind.
struct LightNode {
  Box box;                   // bounds of their positions, of all samples
  float intensity;           // sum over the brightest channel of each, in any sample
  std::uint32_t begin, end;  // range in LightTree::order
  std::uint32_t right;       // second half; the first half is the next node; kNone: a leaf
  LightPoint mean;           // a light that stands for all of them
};
struct LightTree {
  Array<const LightNode> nodes;
  Array<const std::uint32_t> order;  // indices of lights
  std::uint32_t roots[4];            // by index in Lights::runs; kNone: the run has no tree
};

}  // namespace pocketray
