// Reads OpenEXR. Sizes and counts come from the file: each is checked before memory is taken for it.
#include "session/exr.h"

#include "base/check.h"

#ifdef POCKETRAY_HAVE_EXR
#include <openexr.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#endif

namespace pocketray {

#ifdef POCKETRAY_HAVE_EXR
namespace {

constexpr std::size_t kBlockBytesMax = std::size_t{256} << 20;  // for the library: a chunk, or the table of chunks
constexpr int kChannelCountMax = 1024;

struct Input {
  const std::uint8_t* bytes;
  std::size_t byte_count;
};

std::int64_t read_at(exr_const_context_t, void* user, void* to, std::uint64_t count, std::uint64_t offset,
                     exr_stream_error_func_ptr_t) {
  const Input& input = *static_cast<const Input*>(user);
  if (offset >= input.byte_count) return 0;
  const std::uint64_t read = std::min<std::uint64_t>(count, input.byte_count - offset);
  std::memcpy(to, input.bytes + offset, static_cast<std::size_t>(read));
  return static_cast<std::int64_t>(read);
}

void* allocate(std::size_t byte_count) { return byte_count > kBlockBytesMax ? nullptr : std::malloc(byte_count); }

// Closes the file at the end of the scope.
struct OpenFile {
  exr_context_t context = nullptr;
  ~OpenFile() {
    if (context) exr_finish(&context);
  }
};
struct Pipeline {
  exr_const_context_t context;
  exr_decode_pipeline_t state = {};
  bool is_begun = false;
  ~Pipeline() {
    if (is_begun) exr_decoding_destroy(context, &state);
  }
};

struct Layout {
  exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
  exr_attr_box2i_t window = {};
  std::int64_t width = 0, height = 0;
  std::uint32_t tile_width = 0, tile_height = 0;
  bool is_grey = false;
};

Status library_failure(exr_result_t result) {
  if (result == EXR_ERR_FEATURE_NOT_IMPLEMENTED)
    return failure("is compressed in a way that the OpenEXR library cannot read: save it with ZIP");
  return failure("cannot be decoded (%.100s): write it again", exr_get_default_error_message(result));
}
#define RETURN_IF_REFUSED(call)                                    \
  do {                                                             \
    const exr_result_t result = (call);                            \
    if (result != EXR_ERR_SUCCESS) return library_failure(result); \
  } while (0)

const exr_attr_chlist_entry_t* find_channel(const exr_attr_chlist_t& list, const char* name) {
  for (int i = 0; i < list.num_channels; ++i)
    if (std::strcmp(list.entries[i].name.str, name) == 0) return &list.entries[i];
  return nullptr;
}

Status check_channels(exr_const_context_t context, bool* is_grey) {
  const exr_attr_chlist_t* list = nullptr;
  RETURN_IF_REFUSED(exr_get_channels(context, 0, &list));
  const char* names[] = {"R", "G", "B"};
  *is_grey = !find_channel(*list, "R") && find_channel(*list, "Y");
  if (*is_grey) std::fill(std::begin(names), std::end(names), "Y");
  for (const char* name : names) {
    const exr_attr_chlist_entry_t* channel = find_channel(*list, name);
    if (!channel || channel->pixel_type == EXR_PIXEL_UINT)
      return failure("has no channels R, G and B of floats in its first part: export these");
  }
  if (list->num_channels > kChannelCountMax || (*is_grey && (find_channel(*list, "RY") || find_channel(*list, "BY"))))
    return failure("has more than %d channels, or chroma: export R, G and B alone", kChannelCountMax);
  for (int i = 0; i < list->num_channels; ++i)
    if (list->entries[i].x_sampling != 1 || list->entries[i].y_sampling != 1)
      return failure("has a channel of fewer samples than pixels: export R, G and B alone");
  return success();
}

Status read_layout(exr_const_context_t context, const Input& input, std::size_t pixel_count_max, Layout* layout) {
  exr_compression_t compression;
  RETURN_IF_REFUSED(exr_get_compression(context, 0, &compression));
  if (compression == EXR_COMPRESSION_B44 || compression == EXR_COMPRESSION_B44A)  // OpenEXRCore 3.1.5 misreads both
    return library_failure(EXR_ERR_FEATURE_NOT_IMPLEMENTED);
  RETURN_IF_REFUSED(exr_get_storage(context, 0, &layout->storage));
  if (layout->storage != EXR_STORAGE_SCANLINE && layout->storage != EXR_STORAGE_TILED)
    return failure("has several samples per pixel (deep data): export one colour per pixel");
  RETURN_IF_REFUSED(exr_get_data_window(context, 0, &layout->window));
  layout->width = std::int64_t{layout->window.max.x} - layout->window.min.x + 1;
  layout->height = std::int64_t{layout->window.max.y} - layout->window.min.y + 1;
  const std::int64_t limit = static_cast<std::int64_t>(pixel_count_max);
  if (layout->width < 1 || layout->height < 1 || layout->width > limit || layout->height > limit / layout->width)
    return failure("does not have 1 to %zu pixels: write it again, or scale it down", pixel_count_max);
  if (layout->storage == EXR_STORAGE_TILED) {
    exr_tile_level_mode_t levels;
    exr_tile_round_mode_t rounding;
    RETURN_IF_REFUSED(
        exr_get_tile_descriptor(context, 0, &layout->tile_width, &layout->tile_height, &levels, &rounding));
    if (layout->tile_width < 1 || layout->tile_height < 1) return library_failure(EXR_ERR_FILE_BAD_HEADER);
  }
  std::int32_t chunk_count = 0;
  RETURN_IF_REFUSED(exr_get_chunk_count(context, 0, &chunk_count));
  constexpr std::size_t kPlaceBytes = 8;  // of each chunk in the table
  if (chunk_count < 1 || static_cast<std::size_t>(chunk_count) > input.byte_count / kPlaceBytes)
    return failure("is truncated: write it again");
  return check_channels(context, &layout->is_grey);
}

// Decodes a chunk of rows or a tile to `first`, the place of its first pixel.
Status decode_chunk(const Input& input, const Layout& layout, const exr_chunk_info_t& chunk, Vec3* first, Pipeline* p) {
  if (chunk.packed_size > input.byte_count || chunk.unpacked_size > kBlockBytesMax)
    return library_failure(EXR_ERR_CORRUPT_CHUNK);
  RETURN_IF_REFUSED(p->is_begun ? exr_decoding_update(p->context, 0, &chunk, &p->state)
                                : exr_decoding_initialize(p->context, 0, &chunk, &p->state));
  const bool begins = !p->is_begun;
  p->is_begun = true;
  for (int c = 0; c < p->state.channel_count; ++c) {
    exr_coding_channel_info_t& channel = p->state.channels[c];
    const char* names = layout.is_grey ? "Y" : "RGB";
    const char* name =
        channel.channel_name[0] && !channel.channel_name[1] ? std::strchr(names, channel.channel_name[0]) : nullptr;
    channel.decode_to_ptr = name ? reinterpret_cast<std::uint8_t*>(&(*first)[static_cast<int>(name - names)]) : nullptr;
    channel.user_bytes_per_element = sizeof(float);
    channel.user_data_type = EXR_PIXEL_FLOAT;
    channel.user_pixel_stride = sizeof(Vec3);
    channel.user_line_stride = static_cast<std::int32_t>(sizeof(Vec3) * static_cast<std::size_t>(layout.width));
  }
  if (begins) RETURN_IF_REFUSED(exr_decoding_choose_default_routines(p->context, 0, &p->state));
  RETURN_IF_REFUSED(exr_decoding_run(p->context, 0, &p->state));
  return success();
}

// Makes room for the rows before `row_end`. The size grows by doubling, but never beyond the picture's.
void make_room(const Layout& layout, std::int64_t row_end, std::vector<Vec3>* pixels) {
  CHECK_LE(row_end, layout.height);
  const std::size_t count = static_cast<std::size_t>(layout.width * row_end);
  const std::size_t all = static_cast<std::size_t>(layout.width * layout.height);
  if (count > pixels->capacity()) pixels->reserve(std::min(all, std::max(count, 2 * pixels->capacity())));
  pixels->resize(count);
}

Status decode_scanlines(const Input& input, const Layout& layout, exr_const_context_t context,
                        std::vector<Vec3>* pixels) {
  Pipeline pipeline = {context};
  std::int32_t rows = 0;
  RETURN_IF_REFUSED(exr_get_scanlines_per_chunk(context, 0, &rows));
  if (rows < 1) return library_failure(EXR_ERR_FILE_BAD_HEADER);
  for (std::int64_t row = 0; row < layout.height; row += rows) {
    exr_chunk_info_t chunk;
    RETURN_IF_REFUSED(exr_read_scanline_chunk_info(context, 0, static_cast<int>(layout.window.min.y + row), &chunk));
    const std::int64_t row_count = std::min<std::int64_t>(rows, layout.height - row);
    if (chunk.width != layout.width || chunk.height != row_count) return library_failure(EXR_ERR_CORRUPT_CHUNK);
    make_room(layout, row + row_count, pixels);
    RETURN_IF_ERROR(
        decode_chunk(input, layout, chunk, pixels->data() + static_cast<std::size_t>(row * layout.width), &pipeline));
  }
  return success();
}

Status decode_tiles(const Input& input, const Layout& layout, exr_const_context_t context, std::vector<Vec3>* pixels) {
  Pipeline pipeline = {context};
  const std::int64_t tile_width = layout.tile_width, tile_height = layout.tile_height;
  for (std::int64_t row = 0, y = 0; row < layout.height; row += tile_height, ++y)
    for (std::int64_t column = 0, x = 0; column < layout.width; column += tile_width, ++x) {
      exr_chunk_info_t chunk;
      RETURN_IF_REFUSED(exr_read_tile_chunk_info(context, 0, static_cast<int>(x), static_cast<int>(y), 0, 0, &chunk));
      const std::int64_t row_count = std::min(tile_height, layout.height - row);
      if (chunk.width != std::min(tile_width, layout.width - column) || chunk.height != row_count)
        return library_failure(EXR_ERR_CORRUPT_CHUNK);
      make_room(layout, row + row_count, pixels);
      RETURN_IF_ERROR(decode_chunk(input, layout, chunk,
                                   pixels->data() + static_cast<std::size_t>(row * layout.width + column), &pipeline));
    }
  return success();
}

}  // namespace

Status decode_exr(const std::uint8_t* bytes, std::size_t byte_count, std::size_t pixel_count_max, std::uint32_t* width,
                  std::uint32_t* height, std::vector<Vec3>* pixels) {
  CHECK(bytes != nullptr && width != nullptr && height != nullptr && pixels != nullptr);
  CHECK(pixel_count_max > 0 && pixel_count_max <= std::size_t{1} << 27);  // a row's bytes fit the library's int
  Input input = {bytes, byte_count};
  exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
  start.user_data = &input, start.read_fn = read_at;
  start.size_fn = [](exr_const_context_t, void* user) {
    return static_cast<std::int64_t>(static_cast<const Input*>(user)->byte_count);
  };
  start.alloc_fn = allocate, start.free_fn = std::free;
  start.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // the result reports it
  start.max_image_width = start.max_image_height = static_cast<int>(pixel_count_max);
  start.max_tile_width = start.max_tile_height = static_cast<int>(pixel_count_max);
  OpenFile file;
  RETURN_IF_REFUSED(exr_start_read(&file.context, "picture", &start));
  Layout layout;
  RETURN_IF_ERROR(read_layout(file.context, input, pixel_count_max, &layout));
  pixels->clear();
  RETURN_IF_ERROR(layout.storage == EXR_STORAGE_TILED ? decode_tiles(input, layout, file.context, pixels)
                                                      : decode_scanlines(input, layout, file.context, pixels));
  CHECK_EQ(pixels->size(), static_cast<std::size_t>(layout.width * layout.height));
  if (layout.is_grey)
    for (Vec3& pixel : *pixels) pixel = {pixel.x, pixel.x, pixel.x};
  *width = static_cast<std::uint32_t>(layout.width), *height = static_cast<std::uint32_t>(layout.height);
  return success();
}
#else
Status decode_exr(const std::uint8_t*, std::size_t, std::size_t, std::uint32_t*, std::uint32_t*, std::vector<Vec3>*) {
  CHECK(has_exr());
  return success();
}
#endif

}  // namespace pocketray
