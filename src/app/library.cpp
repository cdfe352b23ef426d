#include <cstring>
#include <new>

#include "app/frame.h"
#include "app/pocketray.h"
#include "base/fmath.h"
#include "present/pack.h"
#include "scene/baked.h"
#include "scene/builtin/builtin.h"

namespace pocketray {

struct Instance {
  Renderer renderer;
  PixelFormat format;
  bool dither;
};

namespace {

Result to_result(const Status& status) {
  Result result;
  result.ok = status.ok;
  std::memcpy(result.message, status.message, sizeof result.message);
  return result;
}

PixelFormat to_format(PixelOrder order) {
  switch (order) {
    case PixelOrder::rgb565:
      return kRgb565;
    case PixelOrder::bgr565:
      return kBgr565;
    case PixelOrder::xbgr8888:
      return kXbgr8888;
    case PixelOrder::rgb888:
      return kRgb888;
    case PixelOrder::xrgb8888:
      break;
  }
  return kXrgb8888;
}

// Negative numbers become too large ones: validate_settings() refuses them by name.
std::uint32_t to_count(int value) { return static_cast<std::uint32_t>(value); }

template <class Load>
Status open_instance(const Options& o, void* memory, std::size_t memory_bytes, Instance** result, Load load) {
  *result = nullptr;
  Arena block = make_arena("instance", memory, memory_bytes);
  void* place = arena_try_allocate(&block, sizeof(Instance));
  if (!place)
    return failure("%zu bytes of memory are too few: an instance alone takes %zu", memory_bytes, sizeof(Instance));
  Instance* instance = new (place) Instance;
  instance->format = to_format(o.order);
  instance->dither = o.dither;
  Settings s;
  s.width = to_count(o.width);
  s.height = to_count(o.height);
  s.samples_per_pixel = to_count(o.samples_per_pixel);
  s.ray_depth = to_count(o.ray_depth);
  s.points_per_area_light = to_count(o.points_per_area_light);
  s.threads = to_count(o.threads);
  Renderer* r = &instance->renderer;
  start_renderer(block.base + block.used, arena_free(block), s, r);
  SceneStorage storage;
  RETURN_IF_ERROR(load(r, &storage));
  RETURN_IF_ERROR(plan_renderer(r, storage, 0));
  r->workers = start_workers(s.threads);
  Status status = build_renderer(r);
  if (status.ok)
    *result = instance;
  else
    stop_workers(r->workers);
  return status;
}

}  // namespace

Result open_builtin(const char* name, const Options& options, void* memory, std::size_t memory_bytes,
                    Instance** instance) {
  return to_result(open_instance(options, memory, memory_bytes, instance, [name](Renderer* r, SceneStorage* storage) {
    const BuiltinScene* builtin = find_builtin(name);
    if (!builtin) return failure("there is no built-in scene '%.60s'", name);
    if (builtin->need() > arena_free(r->scene_arena))
      return failure("%s alone needs %zu bytes and %zu are free: give more memory", name, builtin->need(),
                     arena_free(r->scene_arena));
    builtin->build(&r->scene_arena, &r->scene);
    storage->arena_bytes = r->scene_arena.used;
    return success();
  }));
}

Result open_baked(const void* bytes, std::size_t byte_count, const Options& options, void* memory,
                  std::size_t memory_bytes, Instance** instance) {
  return to_result(open_instance(options, memory, memory_bytes, instance, [=](Renderer* r, SceneStorage*) {
    return baked_open(static_cast<const std::uint8_t*>(bytes), byte_count, &r->scene);
  }));
}

Result look(Instance* instance, const View& v) {
  Camera camera;
  camera.eye = {v.eye[0], v.eye[1], v.eye[2]};
  camera.target = {v.target[0], v.target[1], v.target[2]};
  camera.up = {v.up[0], v.up[1], v.up[2]};
  camera.vertical_fov = static_cast<float>(radians(static_cast<double>(v.vertical_fov_degrees)));
  return to_result(set_camera(&instance->renderer, camera));
}

Result render(Instance* instance, double seconds, void* pixels, int line_bytes) {
  Renderer* r = &instance->renderer;
  Status status = render_frame(r, seconds);
  if (!status.ok) return to_result(status);
  int width = static_cast<int>(r->settings.width), height = static_cast<int>(r->settings.height);
  if (line_bytes < width * instance->format.bits_per_pixel / 8)
    return to_result(failure("a row of %d pixels does not fit in %d bytes", width, line_bytes));
  pack_rows(r->image.data, width, height, 0, height, r->exposure, instance->format, Rotation::none, instance->dither,
            pixels, line_bytes);
  return Result();
}

void close(Instance* instance) {
  if (instance) stop_workers(instance->renderer.workers);
}

}  // namespace pocketray
