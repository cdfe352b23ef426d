#include <cstring>
#include <new>

#include "base/limit_list.h"
#include "engine/frame.h"
#include "engine/pocketray.h"
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

// Before they lose their sign.
Status read_options(const Options& o, Settings* s) {
  RETURN_IF_ERROR(check_limit(Quantity::width, o.width));
  RETURN_IF_ERROR(check_limit(Quantity::height, o.height));
  RETURN_IF_ERROR(check_limit(Quantity::samples, o.samples_per_pixel));
  RETURN_IF_ERROR(check_limit(Quantity::depth, o.ray_depth));
  RETURN_IF_ERROR(check_limit(Quantity::area_light_points, o.points_per_area_light));
  if (o.threads < 1 || o.threads > static_cast<int>(kThreadCountMax))
    return failure("the number of threads is %d: it must lie in 1 … %u", o.threads, kThreadCountMax);
  s->width = static_cast<std::uint32_t>(o.width);
  s->height = static_cast<std::uint32_t>(o.height);
  s->samples_per_pixel = static_cast<std::uint32_t>(o.samples_per_pixel);
  s->ray_depth = static_cast<std::uint32_t>(o.ray_depth);
  s->points_per_area_light = static_cast<std::uint32_t>(o.points_per_area_light);
  s->threads = static_cast<std::uint32_t>(o.threads);
  return success();
}

Status no_instance() { return failure("the instance is a null pointer: open one first, and look at the result"); }

template <class Load>
Status open_instance(const Options& o, void* memory, std::size_t memory_bytes, Instance** result, Load load) {
  if (!result) return failure("there is nowhere to put the instance: pass the address of a pointer");
  *result = nullptr;
  if (!memory) return failure("the memory is a null pointer: pass a block for the instance to lie in");
  constexpr std::size_t least = kArenaAlignment + arena_need(sizeof(Instance));
  if (memory_bytes < least)
    return failure("%zu bytes of memory are too few: an instance alone takes %zu", memory_bytes, least);
  Settings s;
  RETURN_IF_ERROR(read_options(o, &s));
  Arena block = make_arena("instance", memory, memory_bytes);
  Instance* instance = new (arena_allocate(&block, sizeof(Instance))) Instance;
  instance->format = to_format(o.order);
  instance->dither = o.dither;
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
    const BuiltinScene* builtin = name ? find_builtin(name) : nullptr;
    if (!name) return failure("the scene's name is a null pointer: pass cornell, or another built-in scene");
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
    if (!bytes) return failure("the scene's bytes are a null pointer: pass those of a .pray file");
    return baked_open(static_cast<const std::uint8_t*>(bytes), byte_count, &r->scene);
  }));
}

Result look(Instance* instance, const View& v) {
  if (!instance) return to_result(no_instance());
  Camera camera;
  camera.eye = {v.eye[0], v.eye[1], v.eye[2]};
  camera.target = {v.target[0], v.target[1], v.target[2]};
  camera.up = {v.up[0], v.up[1], v.up[2]};
  camera.vertical_fov = static_cast<float>(radians(static_cast<double>(v.vertical_fov_degrees)));
  return to_result(set_camera(&instance->renderer, camera));
}

Result render(Instance* instance, double seconds, void* pixels, int line_bytes) {
  if (!instance) return to_result(no_instance());
  if (!pixels) return to_result(failure("the pixels are a null pointer: pass room for the picture"));
  Renderer* r = &instance->renderer;
  int width = static_cast<int>(r->settings.width), height = static_cast<int>(r->settings.height);
  int row_bytes = width * instance->format.bits_per_pixel / 8;
  if (line_bytes < row_bytes)
    return to_result(failure("a row of %d pixels takes %d bytes and has %d: pass at least as many as line_bytes", width,
                             row_bytes, line_bytes));
  Status status = render_frame(r, seconds);
  if (!status.ok) return to_result(status);
  pack_rows(r->image.data, width, height, 0, height, r->exposure, instance->format, Rotation::none, instance->dither,
            pixels, line_bytes);
  return Result();
}

void close(Instance* instance) {
  if (instance) stop_workers(instance->renderer.workers);
}

}  // namespace pocketray
