// sharing.h for builds without a network: there are no options that would ask for it.
#include "remote/client/sharing.h"

namespace pocketray {

Status open_sharing(const SharingOptions&, const platform::Device*, Sharing** sharing) {
  *sharing = nullptr;
  return success();
}
void close_sharing(Sharing*) {}
std::size_t sharing_bytes(const Sharing*, const Settings&) { return 0; }
Status open_shared_scene(Sharing*, const CommonOptions& common,
                         const std::function<std::size_t(const Settings&)>& output_bytes, OpenScene* opened) {
  OpenHooks hooks;
  hooks.output_bytes = output_bytes;
  RETURN_IF_ERROR(open_scene(common, hooks, opened));
  return start_scene(opened, common);
}
void stop_opening(Sharing*) {}
std::uint32_t shared_triangle_count(const Sharing*, const Renderer& renderer) { return renderer.scene.triangles.count; }
Status list_shared_scenes(Sharing*, std::size_t, std::vector<OfferedScene>*) { return success(); }
Status start_sharing(Sharing*, Renderer*, bool, bool) { return success(); }
Status begin_shared(Sharing*, Renderer*, double) { return success(); }
bool advance_shared(Sharing*, Renderer*, std::uint64_t, const std::atomic<bool>*) { return true; }
bool is_cut_off(const Sharing&) { return false; }
bool is_disputed(const Sharing&) { return false; }
bool has_servers(const Sharing&) { return false; }
void show_own_picture(Sharing*, const Renderer&) {}
void tend_servers(Sharing*) {}
SharedPicture shared_picture(const Sharing&) { return {}; }
bool take_shared_rows(Sharing*, std::uint32_t*, std::uint32_t*) { return false; }
std::uint32_t shared_rows_done(const Sharing&) { return 0; }
void write_share_lines(const Sharing&, HudText*) {}
void write_server_lines(const Sharing&, HudText*) {}
ShareTotals share_totals(const Sharing&) { return {}; }

}  // namespace pocketray
