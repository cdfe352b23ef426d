// libpocketray: render a scene into your own pixels, in memory you give. Nothing else is allocated but the threads.
//
//   static unsigned char memory[24 << 20];
//   pocketray::Instance* instance;
//   pocketray::Options options;
//   pocketray::Result result = pocketray::open_builtin("cornell", options, memory, sizeof memory, &instance);
//   if (result.ok) result = pocketray::render(instance, 0.0, pixels, 320 * 4);
//   pocketray::close(instance);
#pragma once
#include <cstddef>
#include <cstdint>

namespace pocketray {

struct Result {
  bool ok = true;
  char message[508] = {0};  // what is wrong and how to mend it
};

enum class PixelOrder { rgb565, bgr565, xrgb8888, xbgr8888, rgb888 };

struct Options {
  int width = 320, height = 240;  // pixels
  PixelOrder order = PixelOrder::xrgb8888;
  int samples_per_pixel = 1;      // 1 … 16
  int ray_depth = 8;              // 0 … 16
  int points_per_area_light = 4;  // 1 … 256
  int threads = 1;
  bool dither = false;
};

struct View {
  float eye[3], target[3], up[3];
  float vertical_fov_degrees;
};

struct Instance;  // lies in the memory given

// What is wrong with an argument, be it out of range, not a number or null, comes back as a Result; nothing aborts. An
// instance that could not be opened is null.

// Opens a built-in scene (cornell, statue, seesaw, cube, furnace), or a .pray file's bytes, which must be aligned to 64
// and outlive the instance. `memory` must too; it is all the instance ever uses.
Result open_builtin(const char* name, const Options& options, void* memory, std::size_t memory_bytes,
                    Instance** instance);
Result open_baked(const void* bytes, std::size_t byte_count, const Options& options, void* memory,
                  std::size_t memory_bytes, Instance** instance);
// Looks from elsewhere from now on.
Result look(Instance* instance, const View& view);
// Renders the scene at a time in seconds into `pixels`, `line_bytes` from row to row, row 0 on top. Times lie within
// ±10⁹ seconds.
Result render(Instance* instance, double seconds, void* pixels, int line_bytes);
// Ends its threads. The memory is the caller's again. Null is allowed.
void close(Instance* instance);

}  // namespace pocketray
