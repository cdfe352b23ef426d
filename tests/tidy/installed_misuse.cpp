// What the installed library makes of arguments that it cannot use: a message for each, and no crash. The messages are
// for people who never saw the command line.
#include <pocketray/pocketray.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <limits>

namespace {

alignas(64) unsigned char memory[24 << 20];
unsigned char pixels[320 * 240 * 4];
int failures = 0;

void refused(const char* what, const pocketray::Result& result, const char* part) {
  bool fine = !result.ok && std::strstr(result.message, part) && !std::strstr(result.message, "--") &&
              !std::strchr(result.message, '\n');
  if (fine) return;
  std::printf("%s: ok %d, '%s', expected '%s' and no option\n", what, result.ok, result.message, part);
  ++failures;
}

pocketray::Result open_with(void (*change)(pocketray::Options*), std::size_t memory_bytes = sizeof memory) {
  pocketray::Options options;
  change(&options);
  pocketray::Instance* instance = nullptr;
  pocketray::Result result = pocketray::open_builtin("cube", options, memory, memory_bytes, &instance);
  pocketray::close(instance);
  return result;
}

}  // namespace

int main() {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  pocketray::Options options;
  pocketray::Instance* instance = nullptr;
  refused("null name", pocketray::open_builtin(nullptr, options, memory, sizeof memory, &instance), "name");
  refused("unknown name", pocketray::open_builtin("nothing", options, memory, sizeof memory, &instance), "no built-in");
  refused("null memory", pocketray::open_builtin("cube", options, nullptr, sizeof memory, &instance), "memory");
  refused("null instance", pocketray::open_builtin("cube", options, memory, sizeof memory, nullptr), "address");
  refused("null bytes", pocketray::open_baked(nullptr, 100, options, memory, sizeof memory, &instance), "null pointer");
  refused("no file", pocketray::open_baked(pixels, sizeof pixels, options, memory, sizeof memory, &instance), "");
  for (std::size_t bytes : {0, 1, 63, 64, 1000, 100000})
    refused("little memory", open_with([](pocketray::Options*) {}, bytes), "memory");
  refused("width", open_with([](pocketray::Options* o) { o->width = -1; }), "width is -1");
  refused("height", open_with([](pocketray::Options* o) { o->height = 8193; }), "height is 8193");
  refused("samples", open_with([](pocketray::Options* o) { o->samples_per_pixel = 0; }), "samples per pixel is 0");
  refused("depth", open_with([](pocketray::Options* o) { o->ray_depth = 17; }), "depth");
  refused("lights", open_with([](pocketray::Options* o) { o->points_per_area_light = 257; }), "area light is 257");
  refused("threads", open_with([](pocketray::Options* o) { o->threads = 0; }), "threads is 0");

  pocketray::View view = {{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 40};
  refused("look at nothing", pocketray::look(nullptr, view), "instance");
  refused("render nothing", pocketray::render(nullptr, 0, pixels, 320 * 4), "instance");
  pocketray::close(nullptr);

  pocketray::Result opened = pocketray::open_builtin("cube", options, memory, sizeof memory, &instance);
  if (!opened.ok) return std::printf("cube: %s\n", opened.message), 1;
  refused("null pixels", pocketray::render(instance, 0, nullptr, 320 * 4), "pixels");
  refused("short rows", pocketray::render(instance, 0, pixels, 320 * 4 - 1), "1280 bytes");
  refused("negative rows", pocketray::render(instance, 0, pixels, -1280), "1280 bytes");
  for (double seconds : {nan, infinity, -infinity, 2e9, -2e9, 1e30})
    refused("time", pocketray::render(instance, seconds, pixels, 320 * 4), "time in seconds");
  for (double x : {nan, infinity, -infinity, 2e18, -2e18}) {
    pocketray::View odd = view;
    odd.eye[1] = static_cast<float>(x);
    refused("eye", pocketray::look(instance, odd), "coordinate");
    odd = view;
    odd.up[2] = static_cast<float>(x);
    refused("up", pocketray::look(instance, odd), "coordinate");
    odd = view;
    odd.vertical_fov_degrees = static_cast<float>(x);
    refused("field of view", pocketray::look(instance, odd), "field of view");
  }
  pocketray::View blind = {{1, 1, 1}, {1, 1, 1}, {0, 1, 0}, 40};
  refused("no direction", pocketray::look(instance, blind), "same point");
  for (double seconds : {0.0, -1.0, 1e9, -1e9})
    if (!pocketray::render(instance, seconds, pixels, 320 * 4).ok)
      std::printf("time %g is refused\n", seconds), ++failures;
  pocketray::close(instance);
  return failures > 0;
}
