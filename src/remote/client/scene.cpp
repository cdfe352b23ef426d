// Opens the scene: fetches it from servers if the device lacks it, leaves it to them if it does not fit on the device.
#include <cstdio>

#include "base/check.h"
#include "base/printable.h"
#include "platform/net/tcp.h"
#include "remote/client/inquiry.h"
#include "remote/client/servers.h"
#include "scene/baked.h"
#include "scene/builtin/builtin.h"
#include "session/heap_scene.h"
#include "session/interrupt.h"
#include "session/progress.h"
#include "session/scene_identity.h"
#include "shade/camera.h"

namespace pocketray {
namespace {

double megabytes(std::size_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

// "; 24.0M would hold the scene": the --memory needed. Empty if no --memory suffices.
std::string memory_hint(const char* before, std::size_t wanted, const char* would) {
  if (wanted > kMemoryBytesMax) return "";
  char text[80];
  std::snprintf(text, sizeof text, "%s%.1fM would %s", before, megabytes(wanted), would);
  return text;
}

Status ask(ConnectedServers* s, std::size_t server, Inquiry* inquiry) {
  CHECK_LT(server, s->addresses.size());
  InquiryOptions options;
  options.stopped = [s] { return s->stopped.load() || interrupted.load(); };
  return open_inquiry(options, s->inquiry_link ? s->inquiry_link : s->link, s->addresses[server], inquiry);
}

// "127.0.0.1:7411: it does not answer; …", each server once.
void add_reason(const ConnectedServers& s, std::size_t server, const std::string& reason, std::string* reasons) {
  *reasons += (reasons->empty() ? "" : "; ") + std::string(s.addresses[server].text) + ": " + reason;
}

std::string names_of(const std::vector<SceneEntry>& entries) {
  std::string names;
  for (const SceneEntry& entry : entries) names += (names.empty() ? "" : ", ") + std::string(entry.name);
  return names.empty() ? "it has no scenes" : "it has " + names;
}

// Finds the scene `name` in the server's list.
Status find_on(Inquiry* inquiry, const std::string& name, SceneEntry* entry) {
  std::vector<SceneEntry> entries;
  RETURN_IF_ERROR(list_scenes(inquiry, &entries));
  const SceneEntry* found = find_entry(entries, name);
  if (!found) return failure("%s", names_of(entries).c_str());
  *entry = *found;
  return success();
}

// Fetches into the scene arena, if it fits. The size is the server's claim: 64 bits, of which this CPU may address only
// 32.
Status fetch(Inquiry* inquiry, const std::string& name, const SceneEntry& entry, Renderer* renderer,
             SceneSource* source) {
  auto* bytes = static_cast<std::uint8_t*>(arena_try_allocate(&renderer->memory.scene, entry.byte_count));
  if (!bytes) return scene_too_large(name, entry.byte_count, renderer->settings.memory_bytes, source);
  std::size_t byte_count = to_size(entry.byte_count);
  Progress progress = start_progress("fetching the scene", byte_count);
  Status status =
      fetch_scene(inquiry, entry, bytes, byte_count, [&](std::uint64_t done) { show_progress(&progress, done); });
  end_progress(&progress);
  RETURN_IF_ERROR(status);
  RETURN_IF_ERROR(baked_open(bytes, byte_count, &renderer->scene));
  source->baked = bytes;
  source->baked_bytes = byte_count;
  return success();
}

// Loads from the first server that has the scene and sends it.
Status load_from_servers(ConnectedServers* s, const std::string& name, Renderer* renderer, SceneSource* source,
                         SceneStorage* storage) {
  std::string reasons;
  for (std::size_t i = 0; i < s->addresses.size(); ++i) {
    Inquiry inquiry;
    SceneEntry entry;
    std::size_t mark = arena_mark(renderer->memory.scene);
    Status status = ask(s, i, &inquiry);
    if (status.ok) status = find_on(&inquiry, name, &entry);
    if (status.ok) {
      s->scene = entry.hash;
      s->is_named = true;
      status = fetch(&inquiry, name, entry, renderer, source);
    }
    if (status.ok) storage->arena_bytes = renderer->memory.scene.used;
    if (status.ok || source->bytes_wanted > 0) return status;
    arena_release(&renderer->memory.scene, mark);
    s->is_named = false;
    add_reason(*s, i, status.message, &reasons);
  }
  return failure("%.200s is neither a file nor a built-in scene, and no server offers it; %s", name.c_str(),
                 reasons.c_str());
}

Status load(ConnectedServers* s, const std::string& name, Renderer* renderer, SceneSource* source,
            SceneStorage* storage) {
  *storage = SceneStorage();
  return is_local_scene(name) ? load_scene(name, renderer, source, storage)
                              : load_from_servers(s, name, renderer, source, storage);
}

// Identifies the loaded scene by its source.
Status name_loaded(ConnectedServers* s, SceneSource* source, Renderer* renderer) {
  Status status = identify_scene(*source, renderer, &s->scene);
  s->is_named = status.ok;
  if (!status.ok)
    source->bytes_wanted =
        renderer->settings.memory_bytes - arena_free(renderer->memory.scene) + baked_size(renderer->scene);
  return status;
}

// Gets the hash of a scene that did not fit: a file's from its bytes, a built-in scene's from a server that has it.
Status name_without_loading(ConnectedServers* s, const std::string& name) {
  bool is_builtin = find_builtin(name.c_str()) != nullptr;
  if (!is_builtin && is_baked_name(name)) return hash_file(name, &s->scene);
  if (!is_builtin) {
    HeapScene heap;
    RETURN_IF_ERROR(read_heap_scene(name, ModelOptions(), &heap));
    std::vector<std::max_align_t> bytes(baked_size(heap.scene) / sizeof(std::max_align_t) + 1);
    auto* begin = reinterpret_cast<std::uint8_t*>(bytes.data());
    baked_write(heap.scene, begin);
    s->scene = content_hash(begin, baked_size(heap.scene));
    return success();
  }
  std::string reasons;
  for (std::size_t i = 0; i < s->addresses.size(); ++i) {
    Inquiry inquiry;
    SceneEntry entry;
    Status status = ask(s, i, &inquiry);
    if (status.ok) status = find_on(&inquiry, name, &entry);
    s->scene = entry.hash;
    if (status.ok) return status;
    add_reason(*s, i, status.message, &reasons);
  }
  return failure("%s", reasons.c_str());
}

Status find_view(ConnectedServers* s, const ViewQuery& query) {
  std::string reasons;
  for (std::size_t i = 0; i < s->addresses.size(); ++i) {
    Inquiry inquiry;
    Status status = ask(s, i, &inquiry);
    if (status.ok) status = ask_view(&inquiry, query, &s->view);
    CameraRays rays;
    if (status.ok) status = make_camera_rays(s->view.camera, query.settings.width, query.settings.height, &rays);
    if (status.ok) return status;
    add_reason(*s, i, status.message, &reasons);
  }
  return failure("%s", reasons.c_str());
}

// Gets the view from --camera, which uses the model's own coordinates: their origin is what servers know.
Status find_stated_view(ConnectedServers* s, const std::string& camera, ViewQuery* query) {
  const bool measures = query->measure_exposure;
  query->camera_stated = query->measure_exposure = false;
  RETURN_IF_ERROR(find_view(s, *query));
  RETURN_IF_ERROR(parse_camera(camera, &query->camera, s->view.origin));
  query->camera_stated = true, query->measure_exposure = measures;
  return find_view(s, *query);
}

EffectPlan effects_of_servers(EffectMask mask) {
  EffectPlan plan;
  plan.mask = mask;
  for (int i = 0; i < kEffectCount; ++i) {
    EffectDecision* decision = &plan.decisions[i];
    decision->on = has(mask, static_cast<Effect>(i));
    std::snprintf(decision->reason, sizeof decision->reason, "planned by the servers");
  }
  return plan;
}

// Opens without the scene: shows what the servers render.
Status open_thin(ConnectedServers* s, const CommonOptions& o, const OutputNeed& output, OpenScene* opened) {
  CHECK(opened->block != nullptr);
  if (!o.fov.empty())
    return failure("--fov needs the scene on this device: raise --memory to hold it, or use --camera");
  ViewQuery query;
  if (o.animation.size() >= kNameBytes)
    return failure("--animation is '%.60s': no animation has a name that long", o.animation.c_str());
  std::snprintf(query.animation, sizeof query.animation, "%s", o.animation.c_str());
  query.settings = opened->renderer.settings;
  query.camera_index = static_cast<std::uint16_t>(o.camera_index);  // below kCameraCountMax: options are checked
  if (!o.camera.empty()) RETURN_IF_ERROR(parse_camera(o.camera, &query.camera));
  ExposureChoice exposure;
  float factor;
  RETURN_IF_ERROR(parse_exposure(o.exposure, &exposure, &factor));
  if (exposure == ExposureChoice::fixed)
    return failure("--exposure fixed needs the scene on this device: raise --memory to hold it, or leave it out");
  query.measure_exposure = exposure == ExposureChoice::measured;
  std::size_t wanted = opened->source.bytes_wanted, limit = query.settings.memory_bytes;
  Status status = s->is_named ? success() : name_without_loading(s, o.scene);
  query.scene = s->scene;
  if (status.ok) status = o.camera.empty() ? find_view(s, query) : find_stated_view(s, o.camera, &query);
  if (!status.ok)
    return failure("%.100s does not fit in --memory %.1fM%s, and no server can render it; %s", o.scene.c_str(),
                   megabytes(limit), memory_hint(" (", wanted, "be a start)").c_str(), status.message);
  std::vector<std::string> files = std::move(opened->source.files);
  opened->source = SceneSource();
  opened->source.files = std::move(files);

  Pace pace = opened->renderer.pace;
  Renderer* renderer = &opened->renderer;
  *renderer = Renderer();
  start_renderer(opened->block, limit, query.settings, renderer);
  RETURN_IF_ERROR(plan_without_scene(renderer, output));
  renderer->pace = pace;
  renderer->view.camera = s->view.camera;
  renderer->view.camera_index = o.camera_index;
  renderer->view.animation = s->view.animation;
  renderer->view.camera_overridden = query.camera_stated;
  renderer->view.exposure = s->view.exposure;
  RETURN_IF_ERROR(change_exposure(factor, &renderer->view.exposure));
  renderer->effects = effects_of_servers(s->view.effects);
  renderer->scene.info.frames_per_second = s->view.frames_per_second;
  renderer->accel.built.bounds = s->view.bounds;
  s->is_named = s->is_thin = true;
  char line[400];
  std::snprintf(
      line, sizeof line,
      "%.100s does not fit in --memory %.1fM: the servers render every pixel and this device only shows them%s",
      o.scene.c_str(), megabytes(limit), memory_hint("; ", wanted, "hold the scene").c_str());
  opened->source.warning = line;
  return success();
}

}  // namespace

Status open_scene_or_leave_it(Servers* servers, const CommonOptions& common, const OutputBytes& output_bytes,
                              OpenScene* opened) {
  ConnectedServers* s = connected(servers);
  if (!common.background.empty() || !common.environment.empty() || common.light != CommonOptions().light)
    return failure(
        "--server renders the scene's own background and lights: drop --server, --background, --environment and "
        "--light");
  OpenHooks hooks;
  hooks.is_shared = true;
  hooks.output_bytes = [&](const Settings& settings) {
    OutputNeed need(output_bytes(settings) + servers->backend->need(*servers, settings));
    need.tls_bytes = arena_need(client_tls_need(*s));
    return need;
  };
  end_client(s);
  s->is_named = s->is_thin = false;
  hooks.load = [s](const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage) {
    renderer->view.animation = 0;  // the scene is the servers', even if nothing moves in it
    return load(s, name, renderer, source, storage);
  };
  hooks.loaded = [s, opened](const SceneSource&, Renderer* renderer) {
    return name_loaded(s, &opened->source, renderer);
  };
  Status status = open_scene(common, hooks, opened);
  if (status.ok) return start_scene(opened, common);
  if (opened->source.bytes_wanted == 0 || !common.focus.empty()) return status;
  return open_thin(s, common, hooks.output_bytes(opened->renderer.settings), opened);
}

void stop_opening(Servers* servers) { connected(servers)->stopped = true; }

std::uint32_t scene_triangle_count(const Servers& servers, const Renderer& renderer) {
  const ConnectedServers& s = connected(servers);
  return s.is_thin ? s.view.triangle_count : renderer.scene.triangles.count;
}

Status list_offered_scenes(Servers* servers, std::size_t server, std::vector<OfferedScene>* scenes) {
  ConnectedServers* s = connected(servers);
  scenes->clear();
  Inquiry inquiry;
  std::vector<SceneEntry> entries;
  Status status = ask(s, server, &inquiry);
  if (status.ok) status = list_scenes(&inquiry, &entries);
  std::string reason;
  if (!status.ok) add_reason(*s, server, status.message, &reason);
  if (!status.ok) return failure("%s", reason.c_str());
  for (const SceneEntry& entry : entries) {
    OfferedScene scene = {entry.name, entry.triangle_count, entry.byte_count};
    make_printable(&scene.name[0], scene.name.size());  // the server may have sent anything
    scenes->push_back(scene);
  }
  return success();
}

}  // namespace pocketray
