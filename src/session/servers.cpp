#include "session/servers.h"

namespace pocketray {

Status open_scene_with(Servers* servers, const CommonOptions& common, const OutputBytes& output_bytes,
                       OpenScene* opened) {
  if (servers) return servers->backend->open_scene(servers, common, output_bytes, opened);
  OpenHooks hooks;
  hooks.output_bytes = output_bytes;
  RETURN_IF_ERROR(open_scene(common, hooks, opened));
  return start_scene(opened, common);
}

std::uint32_t triangle_count(const Servers* servers, const Renderer& renderer) {
  return servers ? servers->backend->triangle_count(*servers, renderer) : renderer.scene.triangles.count;
}

}  // namespace pocketray
