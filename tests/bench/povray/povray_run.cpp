#include "bench/povray/povray_run.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "base/color.h"

namespace pocketray {
namespace {

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// "Trace Time:       0 hours  0 minutes  2 seconds (2.304 seconds)" and, below it,
// "              using 1 thread(s) with 2.290 CPU-seconds total".
Status read_trace_time(const std::string& log, double* seconds) {
  std::size_t line = log.find("Trace Time:");
  std::size_t text = line == std::string::npos ? line : log.find("thread(s) with ", line);
  if (text != std::string::npos && std::sscanf(log.c_str() + text, "thread(s) with %lf CPU-seconds", seconds) == 1)
    return success();
  return failure("POV-Ray's log does not say how long it traced");
}

// The next number of a PPM header, after blanks and comments; 0 if there is none.
std::uint32_t next_number(const std::string& bytes, std::size_t* at) {
  while (*at < bytes.size() && (std::isspace(static_cast<unsigned char>(bytes[*at])) || bytes[*at] == '#'))
    *at = bytes[*at] == '#' ? std::min(bytes.find('\n', *at), bytes.size()) : *at + 1;
  std::uint32_t number = 0;
  for (; *at < bytes.size() && std::isdigit(static_cast<unsigned char>(bytes[*at])) && number < 1u << 16; ++*at)
    number = number * 10 + static_cast<std::uint32_t>(bytes[*at] - '0');
  return number;
}

Status read_ppm(const std::string& path, std::uint32_t width, std::uint32_t height, std::vector<Vec3>* image) {
  std::string bytes = read_text(path);
  std::size_t at = 2, need = std::size_t(3) * width * height;
  bool fits = bytes.compare(0, 2, "P6") == 0 && next_number(bytes, &at) == width && next_number(bytes, &at) == height &&
              next_number(bytes, &at) == 255 && bytes.size() >= at + 1 + need;
  if (!fits) return failure("%s is not the requested picture", path.c_str());
  const char* level = bytes.data() + at + 1;
  for (std::size_t i = 0; i < need; i += 3) {
    auto linear = [&](std::size_t k) { return srgb_to_linear(static_cast<std::uint8_t>(level[i + k])); };
    image->push_back({linear(0), linear(1), linear(2)});
  }
  return success();
}

}  // namespace

Status run_povray(const std::string& program, const std::string& scene_path, std::uint32_t width, std::uint32_t height,
                  PovrayPicture* picture) {
  std::string ppm = scene_path + ".ppm", log = scene_path + ".log";
  std::string command = program + " +I'" + scene_path + "' +O'" + ppm + "' +FP +W" + std::to_string(width) + " +H" +
                        std::to_string(height) + " +WT1 -A -D -J -V File_Gamma=sRGB >'" + log + "' 2>&1";
  if (std::system(command.c_str()) != 0) return failure("%s failed; its log is %s", program.c_str(), log.c_str());
  RETURN_IF_ERROR(read_trace_time(read_text(log), &picture->trace_seconds));
  picture->image.clear();
  return read_ppm(ppm, width, height, &picture->image);
}

}  // namespace pocketray
