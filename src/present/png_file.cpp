#include "present/png_file.h"

#if defined(POCKETRAY_HAVE_PNG)
#include <png.h>

#include <csetjmp>

#include "base/check.h"
#endif

namespace pocketray {

#if defined(POCKETRAY_HAVE_PNG)
namespace {

// zlib's window and memory level, chosen for devices: 2^(kWindowBits + 2) + 2^(kMemoryLevel + 9) bytes (zlib.h) instead
// of 256 KiB.
constexpr int kWindowBits = 13, kMemoryLevel = 7;
constexpr std::size_t kDeflateBytes = (1u << (kWindowBits + 2)) + (1u << (kMemoryLevel + 9));

struct Encoder {
  Arena* arena;
  ByteSink sink;
  char message[128];
};

Encoder* encoder_of(void* pointer) { return static_cast<Encoder*>(pointer); }

png_voidp take(png_structp png, png_alloc_size_t bytes) {
  return arena_try_allocate(encoder_of(png_get_mem_ptr(png))->arena, bytes);
}
void give_back(png_structp, png_voidp) {}  // the arena's mark frees everything at once

void write(png_structp png, png_bytep bytes, png_size_t count) {
  const ByteSink& sink = encoder_of(png_get_io_ptr(png))->sink;
  sink.write(sink.user, bytes, count);
}
void flush(png_structp) {}

[[noreturn]] void fail(png_structp png, png_const_charp message) {
  Encoder* encoder = encoder_of(png_get_error_ptr(png));
  std::snprintf(encoder->message, sizeof encoder->message, "%s", message);
  png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

// Everything between setjmp and the jumps back to it; none of its locals is used afterwards.
bool encode(png_structp png, png_infop info, const std::uint8_t* rgb, int width, int height) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, png_get_error_ptr(png), write, flush);
  png_set_compression_window_bits(png, kWindowBits);
  png_set_compression_mem_level(png, kMemoryLevel);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_PAETH);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  for (int row = 0; row < height; ++row)
    png_write_row(png, rgb + 3 * static_cast<std::size_t>(row) * static_cast<std::size_t>(width));
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

std::size_t encode_png_need(int width) {
  // Measured by tests/present/image_file_test.cpp: the structures and buffers of libpng, and those of zlib besides its
  // tables.
  constexpr std::size_t kStructures = 32 << 10;
  return kDeflateBytes + kStructures + 4 * arena_need(3 * static_cast<std::size_t>(width) + 16);
}

Status encode_png(const std::uint8_t* rgb, int width, int height, Arena* arena, const ByteSink& sink) {
  CHECK(rgb != nullptr && arena != nullptr && sink.write != nullptr);
  CHECK(width > 0 && height > 0);
  std::size_t mark = arena_mark(*arena);
  Encoder encoder = {arena, sink, ""};
  png_structp png =
      png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &encoder, fail, ignore_warning, &encoder, take, give_back);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  bool done = info && encode(png, info, rgb, width, height);
  if (png) png_destroy_write_struct(&png, &info);
  arena_release(arena, mark);
  if (done) return success();
  return failure("cannot write a PNG: %s (needs %zu bytes of memory, %zu are free in the %s arena)",
                 encoder.message[0] ? encoder.message : "out of memory", encode_png_need(width), arena_free(*arena),
                 arena->name);
}

#else

std::size_t encode_png_need(int) { return 0; }

Status encode_png(const std::uint8_t*, int, int, Arena*, const ByteSink&) {
  return failure("built without libpng: write .ppm or .pfm instead");
}

#endif

}  // namespace pocketray
