#include "session/exr.h"

#include "base/check.h"

#ifdef POCKETRAY_HAVE_EXR
#include <openexr.h>

#include <algorithm>
#include <vector>

#include "base/seal.h"
#endif

namespace pocketray {

#ifdef POCKETRAY_HAVE_EXR
namespace {

// The library writes the table of chunks last, before the chunks, and pipes cannot seek: the file is made in memory.
using File = std::vector<std::uint8_t>;

std::int64_t write_at(exr_const_context_t, void* user, const void* bytes, std::uint64_t count, std::uint64_t offset,
                      exr_stream_error_func_ptr_t) {
  File& file = *static_cast<File*>(user);
  if (file.size() < offset + count) file.resize(offset + count);
  std::copy_n(static_cast<const std::uint8_t*>(bytes), count, file.begin() + static_cast<std::ptrdiff_t>(offset));
  return static_cast<std::int64_t>(count);
}

struct Pixels {
  const float* values;
  int width, height;
  std::size_t line_values;
};

exr_result_t write_head(exr_context_t file, const Pixels& p) {
  constexpr const char* kChannels[] = {"R", "G", "B"};
  int part = 0;
  exr_result_t result = exr_add_part(file, "radiance", EXR_STORAGE_SCANLINE, &part);
  if (result == EXR_ERR_SUCCESS)
    result = exr_initialize_required_attr_simple(file, part, p.width, p.height, EXR_COMPRESSION_ZIP);
  for (const char* channel : kChannels)
    if (result == EXR_ERR_SUCCESS)
      result = exr_add_channel(file, part, channel, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1);
  return result == EXR_ERR_SUCCESS ? exr_write_header(file) : result;
}

exr_result_t write_chunk(exr_context_t file, const Pixels& p, int row, bool first, exr_encode_pipeline_t* pipeline) {
  exr_chunk_info_t chunk;
  exr_result_t result = exr_write_scanline_chunk_info(file, 0, row, &chunk);
  if (result != EXR_ERR_SUCCESS) return result;
  result = first ? exr_encoding_initialize(file, 0, &chunk, pipeline) : exr_encoding_update(file, 0, &chunk, pipeline);
  if (result != EXR_ERR_SUCCESS) return result;
  for (int c = 0; c < pipeline->channel_count; ++c) {
    exr_coding_channel_info_t& channel = pipeline->channels[c];
    const int place = channel.channel_name[0] == 'R' ? 0 : channel.channel_name[0] == 'G' ? 1 : 2;
    const float* values = p.values + static_cast<std::size_t>(row) * p.line_values + place;
    channel.user_pixel_stride = 3 * sizeof(float);
    channel.user_line_stride = static_cast<std::int32_t>(p.line_values * sizeof(float));
    channel.encode_from_ptr = reinterpret_cast<const std::uint8_t*>(values);
  }
  if (first) result = exr_encoding_choose_default_routines(file, 0, pipeline);
  return result == EXR_ERR_SUCCESS ? exr_encoding_run(file, 0, pipeline) : result;
}

exr_result_t write_chunks(exr_context_t file, const Pixels& p) {
  std::int32_t rows = 0;
  exr_result_t result = exr_get_scanlines_per_chunk(file, 0, &rows);
  exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
  for (int row = 0; row < p.height && result == EXR_ERR_SUCCESS; row += rows)
    result = write_chunk(file, p, row, row == 0, &pipeline);
  exr_encoding_destroy(file, &pipeline);
  return result;
}

}  // namespace

bool has_exr() { return true; }

Status encode_exr(const float* values, int width, int height, std::size_t line_values, const ByteSink& sink) {
  CHECK(values != nullptr && sink.write != nullptr);
  CHECK(width > 0 && height > 0 && line_values >= 3 * static_cast<std::size_t>(width));
  const SealPause pause;
  File bytes;
  exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
  start.user_data = &bytes, start.write_fn = write_at;
  start.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // the result reports it
  exr_context_t file = nullptr;
  const Pixels pixels = {values, width, height, line_values};
  exr_result_t result = exr_start_write(&file, "picture", EXR_WRITE_FILE_DIRECTLY, &start);
  if (result == EXR_ERR_SUCCESS) result = write_head(file, pixels);
  if (result == EXR_ERR_SUCCESS) result = write_chunks(file, pixels);
  const exr_result_t finished = file ? exr_finish(&file) : EXR_ERR_SUCCESS;
  if (result == EXR_ERR_SUCCESS) result = finished;
  if (result != EXR_ERR_SUCCESS)
    return failure("the OpenEXR library failed: %.100s; write .pfm", exr_get_default_error_message(result));
  sink.write(sink.user, bytes.data(), bytes.size());
  return success();
}
#else
bool has_exr() { return false; }
Status encode_exr(const float*, int, int, std::size_t, const ByteSink&) {
  CHECK(has_exr());
  return success();
}
#endif

}  // namespace pocketray
