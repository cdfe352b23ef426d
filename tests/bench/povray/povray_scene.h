// The statue with one point light, hard shadows and matte surfaces, for both ray tracers.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "session/source.h"

namespace pocketray {

struct PovrayScene {
  std::unique_ptr<unsigned char[]> block;
  std::unique_ptr<Renderer> renderer;  // ready to render frames; one thread, one sample, no cut-off
  SceneSource source;
  std::vector<Material> materials;
  Light light;
};

Status open_povray_scene(std::uint32_t width, std::uint32_t height, PovrayScene* scene);

// The same scene in POV-Ray's language: a mesh2 with vertex normals, the camera of the renderer, the light.
Status write_povray_scene(const PovrayScene& scene, const std::string& path);

}  // namespace pocketray
