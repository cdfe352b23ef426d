// OpenEXR files of one part without compression, byte by byte.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pocketray {

struct ExrBytes {
  struct Channel {
    std::string name;
    int type = 1;  // 0: 32-bit integers, 1: 16-bit floats, 2: 32-bit floats
    int sampling = 1;
  };
  std::vector<Channel> channels;  // sorted by name
  std::int32_t left = 0, top = 0, right = 0, bottom = 0;
  std::uint32_t tile = 0;  // side of a tile; 0: scanlines
  char compression = 0;

  static void put(std::uint64_t value, int byte_count, std::string* bytes) {
    for (int i = 0; i < byte_count; ++i) *bytes += static_cast<char>(value >> 8 * i);
  }
  static void put_attribute(const char* name, const char* type, const std::string& value, std::string* bytes) {
    *bytes += name, *bytes += '\0', *bytes += type, *bytes += '\0';
    put(value.size(), 4, bytes), *bytes += value;
  }

  std::string header() const {
    std::string bytes, list, window, tiles;
    put(20000630, 4, &bytes), put(tile > 0 ? 0x202 : 2, 4, &bytes);
    for (const Channel& c : channels) {
      list += c.name, list += '\0';
      put(static_cast<std::uint64_t>(c.type), 4, &list), put(0, 4, &list);
      for (int axis = 0; axis < 2; ++axis) put(static_cast<std::uint64_t>(c.sampling), 4, &list);
    }
    list += '\0';
    for (std::int32_t edge : {left, top, right, bottom}) put(static_cast<std::uint32_t>(edge), 4, &window);
    put_attribute("channels", "chlist", list, &bytes);
    put_attribute("compression", "compression", std::string(1, compression), &bytes);
    put_attribute("dataWindow", "box2i", window, &bytes);
    put_attribute("displayWindow", "box2i", window, &bytes);
    put_attribute("lineOrder", "lineOrder", std::string(1, '\0'), &bytes);
    put_attribute("pixelAspectRatio", "float", std::string("\0\0\x80\x3f", 4), &bytes);
    put_attribute("screenWindowCenter", "v2f", std::string(8, '\0'), &bytes);
    put_attribute("screenWindowWidth", "float", std::string("\0\0\x80\x3f", 4), &bytes);
    put(tile, 4, &tiles), put(tile, 4, &tiles), tiles += '\0';
    if (tile > 0) put_attribute("tiles", "tiledesc", tiles, &bytes);
    return bytes += '\0';
  }

  // The file. value(channel, column, row) returns the bits of a value, counted from the window's corner.
  template <class Value>
  std::string file(const Value& value) const {
    const int width = right - left + 1, height = bottom - top + 1;
    const int across = tile > 0 ? static_cast<int>(tile) : width, down = tile > 0 ? static_cast<int>(tile) : 1;
    std::string bytes = header(), places, chunks;
    const int count = ((width + across - 1) / across) * ((height + down - 1) / down);
    for (int y = 0; y < height; y += down)
      for (int x = 0; x < width; x += across) {
        put(bytes.size() + 8 * static_cast<std::size_t>(count) + chunks.size(), 8, &places);
        std::string pixels;
        for (int row = y; row < y + down && row < height; ++row)
          for (std::size_t c = 0; c < channels.size(); ++c)
            for (int column = x; column < x + across && column < width; ++column)
              put(value(static_cast<int>(c), column, row), channels[c].type == 1 ? 2 : 4, &pixels);
        if (tile == 0) put(static_cast<std::uint32_t>(top + y), 4, &chunks);
        if (tile > 0)
          for (int number : {x / across, y / down, 0, 0}) put(static_cast<std::uint64_t>(number), 4, &chunks);
        put(pixels.size(), 4, &chunks), chunks += pixels;
      }
    return bytes + places + chunks;
  }
};

}  // namespace pocketray
