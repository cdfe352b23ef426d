// Random edits of a generated scene between frames, and two renderers that follow them: one traces whole frames, the
// other what has changed.
#pragma once
#include <memory>

#include "base/rng.h"
#include "engine/frame.h"
#include "support/generated_scene.h"
#include "support/test_environment.h"
#include "temporal/shared_script.h"

namespace pocketray {

struct EditScript {
  Rng rng;
  std::unique_ptr<GeneratedScene> generated;
  std::unique_ptr<TestEnvironment> environment;  // or none
  std::unique_ptr<TestRenderer> whole, coherent;
  std::vector<Vec3> rest;  // positions at rest before any edit
  double seconds = 0;
  float scale = 1;      // of the scene
  bool shares = false;  // mostly traces a part of the rows
  SharedScript shared;
  std::uint64_t partial_frames = 0, pixels_traced = 0;  // of the frames that were not traced whole
  std::uint64_t partly_relit_frames = 0;  // of these, those with virtual lights in which something changed
};

// A material that may take the place of another, which is `m` now; mostly no brighter.
Material recolored(const Material& opened, Material m, std::uint32_t texture_count, Rng* rng);

// A scene with the features and animation; size, table, threads and accelerator follow from the seed.
EditScript begin_script(std::uint32_t features, std::uint64_t seed);
// Edits, renders both frames and compares them: true if every bit is equal.
bool follow_script(EditScript* script);

}  // namespace pocketray
