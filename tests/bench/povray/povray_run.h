// Runs POV-Ray: one picture of a scene file, and its reported time.
#pragma once
#include <string>
#include <vector>

#include "base/status.h"
#include "base/vec3.h"

namespace pocketray {

struct PovrayPicture {
  double trace_seconds;     // CPU time of tracing alone, by POV-Ray's own statistics: no parsing, no bounding
  std::vector<Vec3> image;  // linear, row 0 on top
};

// Runs `program` on scene_path with one thread and no antialiasing; its picture and its log go to files beside the
// scene.
Status run_povray(const std::string& program, const std::string& scene_path, std::uint32_t width, std::uint32_t height,
                  PovrayPicture* picture);

}  // namespace pocketray
