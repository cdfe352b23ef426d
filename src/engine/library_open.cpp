// Opens scenes: the caller's request → a planned and built renderer in the caller's memory.
#include <cstring>
#include <new>

#include "accel/accel_list.h"
#include "base/check.h"
#include "base/limit_list.h"
#include "effect/effect_list.h"
#include "engine/library.h"
#include "plan/plan_effects.h"
#include "scene/baked.h"
#include "scene/builtin/builtin.h"

namespace pocketray {
namespace {

static_assert(kEffectCount <= POCKETRAY_EFFECTS_MAX, "a plan holds all effects");
static_assert(kMemoryPartMax <= POCKETRAY_MEMORY_PARTS_MAX, "and all parts of the memory");
static_assert(kNone == POCKETRAY_NONE, "no such index");

// The checked request.
struct Request {
  pocketray_source source;
  pocketray_options options;
  Settings settings;
  Camera camera;
  const AccelInfo* accel = nullptr;       // null: let the plan choose
  const BuiltinScene* builtin = nullptr;  // null: source.bytes
};

bool is_aligned(const void* bytes) { return reinterpret_cast<std::uintptr_t>(bytes) % kArenaAlignment == 0; }

Status read_source(const pocketray_source* given, Request* q) {
  RETURN_IF_ERROR(read_struct("the source", given, &q->source));
  const pocketray_source& s = q->source;
  RETURN_IF_ERROR(check_choice("the source's copy", s.copy, 2));
  if (s.builtin) {
    q->builtin = find_builtin(s.builtin);
    if (!q->builtin) return failure("there is no built-in scene '%.60s'", s.builtin);
    return success();
  }
  if (!s.bytes)
    return failure("the scene's bytes are a null pointer: pass those of a .pray file, or a built-in's name");
  if (!s.copy && !is_aligned(s.bytes))
    return failure("the scene's bytes are not aligned to %zu: align them, or set copy", kArenaAlignment);
  return success();
}

Status read_effects(const char* text, Settings* settings) {
  if (!text) return success();
  if (parse_effects(text, settings).ok) return success();
  return failure(
      "effects are '%.60s': write auto, all or names, each with an optional '-' before it, and commas between", text);
}

Status read_accelerator(const char* name, const AccelInfo** accel) {
  if (!name) return success();
  for (const AccelInfo* info : kAccelList)
    if (std::strcmp(info->name, name) == 0) return *accel = info, success();
  return failure("there is no accelerator '%.60s'", name);
}

Status read_options(const pocketray_options* given, Request* q) {
  RETURN_IF_ERROR(read_struct("the options", given, &q->options));
  const pocketray_options& o = q->options;
  Settings* s = &q->settings;
  RETURN_IF_ERROR(check_limit(Quantity::width, o.width));
  RETURN_IF_ERROR(check_limit(Quantity::height, o.height));
  if (o.threads < 1 || o.threads > static_cast<int>(kThreadCountMax))
    return failure("the number of threads is %d: it must lie in 1 … %u", o.threads, kThreadCountMax);
  s->width = static_cast<std::uint32_t>(o.width);
  s->height = static_cast<std::uint32_t>(o.height);
  s->threads = static_cast<std::uint32_t>(o.threads);
  RETURN_IF_ERROR(check_choice("measure_exposure", o.measure_exposure, 2));
  RETURN_IF_ERROR(check_choice("movable", o.movable, 2));
  RETURN_IF_ERROR(check_choice("recolorable", o.recolorable, 2));
  RETURN_IF_ERROR(check_choice("coherence", o.coherence, 3));
  s->coherence = static_cast<CoherenceMode>(o.coherence);
  if (o.coherence_table < 1 || o.coherence_table > static_cast<int>(kCoherenceTableSideMax))
    return failure("coherence_table is %d: it must lie in 1 … %u", o.coherence_table, kCoherenceTableSideMax);
  s->coherence_table = static_cast<std::uint32_t>(o.coherence_table);
  RETURN_IF_ERROR(check_limit(Quantity::camera_index, o.camera_index));
  if (o.light_count_max > kLightCountMax)
    return failure("light_count_max is %u: at most %u lights are supported", o.light_count_max, kLightCountMax);
  if (o.part_count > kNodeCountMax) return failure("%u parts, at most %u are supported", o.part_count, kNodeCountMax);
  if (o.part_count && !o.parts) return failure("parts is a null pointer, part_count is %u", o.part_count);
  if (o.settings) RETURN_IF_ERROR(read_settings(o.settings, s));
  if (o.camera) RETURN_IF_ERROR(read_camera(o.camera, *s, &q->camera));
  RETURN_IF_ERROR(read_effects(o.effects, s));
  return read_accelerator(o.accelerator, &q->accel);
}

Status read_request(const pocketray_source* source, const pocketray_options* options, Request* q) {
  q->source = POCKETRAY_SOURCE_INIT;
  q->options = POCKETRAY_OPTIONS_INIT;
  RETURN_IF_ERROR(read_source(source, q));
  return read_options(options, q);
}

std::size_t parts_need(const Request& q) {
  if (!q.options.part_count) return 0;
  return arena_need<Node>(q.options.part_count) + arena_need<MovingMesh>(q.options.part_count) +
         arena_need<Animation>(1);
}

// Bytes that load_scene() takes from the scene arena.
std::size_t load_need(const Request& q, bool copies) {
  std::size_t scene = q.builtin ? q.builtin->need() : copies ? arena_need(q.source.byte_count) : 0;
  return size_sum(scene, parts_need(q));
}
std::size_t lights_need(const Request& q) { return 2 * arena_need<Light>(q.options.light_count_max); }
bool moves_nodes(const Request& q) { return q.options.movable || q.options.part_count; }
std::size_t overrides_need(const Request& q, const Scene& scene) {
  return moves_nodes(q) ? arena_need<NodeOverride>(scene.nodes.count) : 0;
}

// Finds the run of vertices used by the triangles of a material.
Status find_run(const Scene& scene, std::uint32_t part, std::uint32_t material, MovingMesh* mesh) {
  std::uint32_t first = kNone, last = 0;
  for (const Triangle& t : scene.triangles) {
    if (t.material() != material) continue;
    for (std::uint32_t v : t.vertices()) first = v < first ? v : first, last = v > last ? v : last;
  }
  if (first == kNone) return failure("parts[%u]: no triangle has material %u", part, material);
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices())
      if (t.material() != material && v >= first && v <= last)
        return failure(
            "parts[%u]: vertex %u, among those of material %u, has another material: state a run of vertices", part, v,
            material);
  mesh->vertex_begin = first;
  mesh->vertex_count = last - first + 1;
  return success();
}

Status read_part(const Scene& scene, const Request& q, std::uint32_t part, MovingMesh* mesh) {
  const pocketray_part& p = q.options.parts[part];
  *mesh = MovingMesh();
  mesh->node = part;
  mesh->vertex_begin = p.vertex_begin;
  mesh->vertex_count = p.vertex_count;
  if (p.vertex_count == 0) RETURN_IF_ERROR(find_run(scene, part, p.material, mesh));
  std::uint32_t count = scene.positions.count;
  if (mesh->vertex_begin > count || mesh->vertex_count > count - mesh->vertex_begin)
    return failure("parts[%u] extends beyond the scene's %u vertices", part, count);
  mesh->rest_begin = mesh->vertex_begin;
  return success();
}

// Makes nodes of the parts, and an animation without channels: their rest pose is their place in the world.
Status add_parts(const Request& q, Renderer* renderer) {
  std::uint32_t count = q.options.part_count;
  Scene* scene = &renderer->scene;
  if (count == 0) return success();
  if (scene->nodes.count || scene->animations.count)
    return failure("the scene is animated and has nodes of its own: leave parts out and set movable");
  Array<Node> nodes = arena_array<Node>(&renderer->memory.scene, count);
  Array<MovingMesh> meshes = arena_array<MovingMesh>(&renderer->memory.scene, count);
  Array<Animation> animation = arena_array_zeroed<Animation>(&renderer->memory.scene, 1);
  for (std::uint32_t part = 0; part < count; ++part) {
    nodes[part] = Node();
    MovingMesh mesh;
    RETURN_IF_ERROR(read_part(*scene, q, part, &mesh));
    std::uint32_t at = part;  // keep runs in ascending order
    for (; at > 0 && meshes[at - 1].vertex_begin > mesh.vertex_begin; --at) meshes[at] = meshes[at - 1];
    meshes[at] = mesh;
  }
  for (std::uint32_t i = 1; i < count; ++i)
    if (meshes[i].vertex_begin - meshes[i - 1].vertex_begin < meshes[i - 1].vertex_count)
      return failure("parts[%u] and parts[%u] share vertices", meshes[i - 1].node, meshes[i].node);
  scene->nodes = nodes;
  scene->moving_meshes = meshes;
  scene->animations = animation;
  scene->rest_positions = scene->positions;
  scene->rest_normals = scene->normals;
  return success();
}

pocketray_result load_scene(const Request& q, bool copies, Renderer* renderer) {
  Arena* arena = &renderer->memory.scene;
  if (q.builtin) {
    q.builtin->build(arena, &renderer->scene);
    CHECK_LE(arena->used, q.builtin->need());
  } else {
    const std::uint8_t* bytes = static_cast<const std::uint8_t*>(q.source.bytes);
    if (copies) {
      void* copy = arena_allocate(arena, q.source.byte_count);
      std::memcpy(copy, bytes, q.source.byte_count);
      bytes = static_cast<std::uint8_t*>(copy);
    }
    Status status = baked_open(bytes, q.source.byte_count, &renderer->scene);
    if (!status.ok) return refuse(POCKETRAY_ERROR_SCENE, status);
  }
  if (q.options.measure_exposure) renderer->scene.info.auto_exposure = 1;
  return to_result(add_parts(q, renderer), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result plan_request(const Request& q, const SceneStorage& storage, Renderer* renderer) {
  const Scene& scene = renderer->scene;
  std::uint32_t index = q.options.camera_index;
  if (index > 0 && index >= scene.cameras.count)
    return refuse(POCKETRAY_ERROR_ARGUMENT,
                  failure("there is no camera %u: the scene has %u, counted from 0", index, scene.cameras.count));
  renderer->view.camera_index = index;
  renderer->accel.info = q.accel;
  renderer->lights.count_max = q.options.light_count_max;
  renderer->materials.recolorable = q.options.recolorable != 0;
  Status status = plan_renderer(renderer, storage, progressive_need(q.settings));
  if (renderer->memory.plan.total_bytes == SIZE_MAX)
    status = failure("the scene needs more memory than this CPU addresses");
  bool too_small = renderer->memory.plan.total_bytes == SIZE_MAX ||
                   renderer->memory.plan.total_bytes > renderer->memory.plan.limit_bytes;
  if (!status.ok) return refuse(too_small ? POCKETRAY_ERROR_MEMORY : POCKETRAY_ERROR_SCENE, status);
  if (renderer->lights.count_max && renderer->lights.count_max < scene.lights.count)
    return refuse(POCKETRAY_ERROR_ARGUMENT, failure("light_count_max is %u, the scene already has %u lights",
                                                    renderer->lights.count_max, scene.lights.count));
  return POCKETRAY_OK;
}

pocketray_result need_more(const char* what, std::size_t needed, std::size_t given) {
  return refuse(POCKETRAY_ERROR_MEMORY,
                failure("%s needs %zu bytes of memory but %zu were given", what, needed, given));
}

// Hands the memory planned for the caller's lights and transforms to the
// pose; the first frame was posed without them.
void attach_changes(pocketray_instance* instance) {
  Pose* pose = &instance->renderer.pose;
  if (pose->nodes.empty()) return;  // nothing moves
  CHECK(instance->overrides.empty() || instance->overrides.count == pose->nodes.count);
  if (instance->posed_lights.count) pose->lights = {instance->posed_lights.data, instance->renderer.scene.lights.count};
  pose->overrides = instance->overrides;
}

pocketray_result build(const Request& q, pocketray_instance* instance) {
  Renderer* renderer = &instance->renderer;
  if (instance->lights.count) {
    CHECK_LE(renderer->scene.lights.count, instance->lights.count);
    CHECK_EQ(instance->posed_lights.count, instance->lights.count);
    for (std::uint32_t i = 0; i < renderer->scene.lights.count; ++i) instance->lights[i] = renderer->scene.lights[i];
    renderer->scene.lights = {instance->lights.data, renderer->scene.lights.count};
  }
  if (q.options.camera) {
    Status status = set_camera(renderer, q.camera);
    if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  }
  renderer->workers = start_workers(q.settings.threads);
  Status status = build_renderer(renderer);
  if (!status.ok) {
    stop_workers(renderer->workers);
    return refuse(POCKETRAY_ERROR_SCENE, status);
  }
  instance->tile_spans = arena_array<Span>(&renderer->memory.frame, progressive_spans_max(q.settings));
  attach_changes(instance);
  return POCKETRAY_OK;
}

pocketray_result open_request(const Request& q, void* memory, std::size_t memory_bytes, pocketray_instance** result) {
  constexpr std::size_t least = kArenaAlignment + arena_need(sizeof(pocketray_instance));
  if (memory_bytes < least) return need_more("an instance alone", least, memory_bytes);
  Arena block = make_arena("instance", memory, memory_bytes);
  auto* instance = new (arena_allocate(&block, sizeof(pocketray_instance))) pocketray_instance;
  Renderer* renderer = &instance->renderer;
  std::size_t room = arena_free(block), scene_bytes = load_need(q, q.source.copy != 0);
  start_renderer(block.base + block.used, room, q.settings, renderer);
  if (scene_bytes > room) return need_more("the scene alone", size_sum(least, scene_bytes), memory_bytes);
  pocketray_result loaded = load_scene(q, q.source.copy != 0, renderer);
  if (loaded != POCKETRAY_OK) return loaded;
  std::size_t change_bytes = lights_need(q) + overrides_need(q, renderer->scene);
  if (change_bytes > arena_free(renderer->memory.scene))
    return need_more("room for changes", size_sum(memory_bytes, change_bytes), memory_bytes);
  if (q.options.light_count_max) {
    instance->lights = arena_array<Light>(&renderer->memory.scene, q.options.light_count_max);
    instance->posed_lights = arena_array<Light>(&renderer->memory.scene, q.options.light_count_max);
  }
  if (moves_nodes(q)) {
    instance->overrides = arena_array<NodeOverride>(&renderer->memory.scene, renderer->scene.nodes.count);
    for (NodeOverride& o : instance->overrides) o = NodeOverride();
  }
  SceneStorage storage;
  storage.arena_bytes = renderer->memory.scene.used;
  pocketray_result planned = plan_request(q, storage, renderer);
  if (planned != POCKETRAY_OK) return planned;
  pocketray_result built = build(q, instance);
  if (built == POCKETRAY_OK) *result = instance;
  return built;
}

}  // namespace

std::size_t instance_need(const Renderer& renderer) {
  return size_sum(kArenaAlignment + arena_need(sizeof(pocketray_instance)), renderer.memory.plan.total_bytes);
}

void write_plan(const Renderer& renderer, std::size_t scratch_bytes, pocketray_plan* plan) {
  const Scene& scene = renderer.scene;
  CHECK(renderer.accel.info != nullptr);  // it has been planned
  std::memset(static_cast<void*>(plan), 0, sizeof *plan);
  plan->memory_bytes = instance_need(renderer);
  plan->scratch_bytes = scratch_bytes;
  plan->accelerator = renderer.accel.info->name;
  plan->vertex_count = scene.positions.count;
  plan->triangle_count = scene.triangles.count;
  plan->material_count = scene.materials.count;
  plan->light_count = scene.lights.count;
  plan->camera_count = scene.cameras.count;
  plan->node_count = scene.nodes.count;
  plan->default_camera = scene.info.default_camera != 0;
  plan->default_lights = scene.info.default_lights != 0;
  plan->frame_count = scene.info.frame_count;
  plan->frames_per_second = scene.info.frames_per_second;
  plan->duration_seconds = scene.animations.count ? static_cast<double>(scene.animations[0].duration) : 0;
  plan->effect_count = kEffectCount;
  for (int i = 0; i < kEffectCount; ++i) {
    pocketray_effect* e = &plan->effects[i];
    const EffectDecision& d = renderer.effects.decisions[i];
    e->name = kEffectList[i].name;
    e->called_for_by = kEffectList[i].called_for_by;
    e->on = d.on;
    static_assert(sizeof e->reason == sizeof d.reason, "a reason is copied whole");
    std::memcpy(e->reason, d.reason, sizeof e->reason);
  }
  plan->memory_part_count = static_cast<std::uint32_t>(renderer.memory.plan.part_count);
  for (int i = 0; i < renderer.memory.plan.part_count; ++i)
    plan->memory_parts[i] = {renderer.memory.plan.parts[i].name, renderer.memory.plan.parts[i].bytes};
}

}  // namespace pocketray

using namespace pocketray;

pocketray_result pocketray_make_plan(const pocketray_source* source, const pocketray_options* options, void* scratch,
                                     std::size_t scratch_bytes, pocketray_plan* plan) {
  Status sized = check_struct("the plan", plan, sizeof *plan);
  if (!sized.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, sized);
  Request q;
  Status status = read_request(source, options, &q);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  // Bytes that can be read in place are not copied, so memory is planned only for a copy that is needed.
  bool copies = !q.builtin && !is_aligned(q.source.bytes);
  std::size_t need = load_need(q, copies);
  if (need > 0) need = size_sum(need, kArenaAlignment);
  plan->scratch_bytes = need;
  if (need > 0 && (!scratch || scratch_bytes < need)) return need_more("planning", need, scratch ? scratch_bytes : 0);
  Renderer renderer;
  start_renderer(need > 0 ? scratch : nullptr, need, q.settings, &renderer);
  renderer.settings.memory_bytes = SIZE_MAX;
  pocketray_result loaded = load_scene(q, copies, &renderer);
  if (loaded != POCKETRAY_OK) return loaded;
  SceneStorage storage;
  storage.arena_bytes = size_sum(q.builtin ? renderer.memory.scene.used : load_need(q, q.source.copy != 0),
                                 lights_need(q) + overrides_need(q, renderer.scene));
  pocketray_result planned = plan_request(q, storage, &renderer);
  if (planned != POCKETRAY_OK) return planned;
  pocketray_plan made;
  write_plan(renderer, need, &made);
  return to_result(write_struct("the plan", made, plan), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_open(const pocketray_source* source, const pocketray_options* options, void* memory,
                                std::size_t memory_bytes, pocketray_instance** instance) {
  if (!instance)
    return refuse(POCKETRAY_ERROR_ARGUMENT, failure("the instance's address is null: pass the address of a pointer"));
  *instance = nullptr;
  if (!memory)
    return refuse(POCKETRAY_ERROR_ARGUMENT, failure("the memory is a null pointer: pass a block for the instance"));
  Request q;
  Status status = read_request(source, options, &q);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  return open_request(q, memory, memory_bytes, instance);
}

void pocketray_close(pocketray_instance* instance) {
  if (instance) stop_workers(instance->renderer.workers);
}

pocketray_result pocketray_get_plan(const pocketray_instance* instance, pocketray_plan* plan) {
  Status status = check_instance(instance);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  pocketray_plan made;
  write_plan(instance->renderer, 0, &made);
  return to_result(write_struct("the plan", made, plan), POCKETRAY_ERROR_ARGUMENT);
}
