#include "desktop/accuracy/strip.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/check.h"
#include "desktop/accuracy/text.h"
#include "present/hud.h"
#include "present/png_file.h"

namespace pocketray {
namespace {

constexpr int kPanelWidth = 320;       // minimum: smaller pictures are magnified,
constexpr int kPanelHeightMax = 2560;  // up to this height
constexpr int kGap = 6, kTextScale = 3, kTextColumns = 12;

// Wraps text at `columns` characters; a longer word gets its own line.
std::vector<std::string> wrapped(const std::string& text, std::size_t columns) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = std::min(text.find(' ', at), text.size());
    std::string word = text.substr(at, end - at);
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > columns) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back() += word;
    at = end + 1;
  }
  return lines;
}

std::vector<std::string> row_text(const StripRow& row) {
  std::vector<std::string> lines = wrapped(row.label, kTextColumns);
  std::string price = std::isfinite(row.bytes) ? format("%.0f bytes", row.bytes) : format("%.4g ms", row.ms);
  for (std::string line : {std::string(), price, format("FLIP %.4f", row.flip)}) lines.push_back(line);
  return lines;
}

void draw_text(Levels* strip, int column, int row, const std::vector<std::string>& text) {
  Canvas canvas = {strip->rgb.data(),
                   static_cast<int>(3 * strip->width),
                   kRgb888,
                   static_cast<int>(strip->width),
                   static_cast<int>(strip->height),
                   Rotation::none};
  std::vector<const char*> lines;
  for (const std::string& line : text) lines.push_back(line.c_str());
  draw_text_box(canvas, column, row, kTextScale, lines.data(), static_cast<int>(lines.size()));
}

// Draws `color(pixel, levels)` for each pixel of a picture, magnified.
template <class Color>
void draw_panel(Levels* strip, int column, int row, int zoom, int width, int height, Color color) {
  for (int y = 0; y < height * zoom; ++y)
    for (int x = 0; x < width * zoom; ++x) {
      std::size_t pixel = static_cast<std::size_t>(y / zoom * width + x / zoom);
      std::size_t at = static_cast<std::size_t>(row + y) * strip->width + static_cast<std::size_t>(column + x);
      color(pixel, &strip->rgb[3 * at]);
    }
}

void draw_row(Levels* strip, const StripLayout& at, int top, const Levels& reference, const StripRow& row) {
  int width = static_cast<int>(reference.width), height = static_cast<int>(reference.height);
  auto panel = [&](int index, auto color) {
    draw_panel(strip, at.panel_column[index], top, at.zoom, width, height, color);
  };
  panel(0, [&](std::size_t i, std::uint8_t* out) { std::copy_n(&reference.rgb[3 * i], 3, out); });
  panel(1, [&](std::size_t i, std::uint8_t* out) { std::copy_n(&row.picture.rgb[3 * i], 3, out); });
  panel(2, [&](std::size_t i, std::uint8_t* out) {
    for (std::size_t c = 0; c < 3; ++c)
      out[c] = static_cast<std::uint8_t>(
          std::min(255, kDifferenceGain * std::abs(row.picture.rgb[3 * i + c] - reference.rgb[3 * i + c])));
  });
  panel(3, [&](std::size_t i, std::uint8_t* out) {
    std::array<std::uint8_t, 3> color = flip_color(row.flip_map[i]);
    std::copy_n(color.data(), 3, out);
  });
  draw_text(strip, at.text_column, top, row_text(row));
}

}  // namespace

std::array<std::uint8_t, 3> flip_color(float error) {
  // matplotlib's map at multiples of 1/10; interpolated linearly.
  constexpr std::uint8_t kMagma[11][3] = {{0, 0, 4},       {20, 14, 54},    {59, 15, 112},  {100, 26, 128},
                                          {140, 41, 129},  {183, 55, 121},  {222, 73, 104}, {247, 112, 92},
                                          {254, 159, 109}, {254, 207, 146}, {252, 253, 191}};
  float place = 10 * std::min(std::max(error, 0.0f), 1.0f);
  int below = std::min(static_cast<int>(place), 9);
  std::array<std::uint8_t, 3> color = {};
  for (std::size_t c = 0; c < 3; ++c) {
    float from = kMagma[below][c], to = kMagma[below + 1][c];
    color[c] = static_cast<std::uint8_t>(from + (to - from) * (place - static_cast<float>(below)) + 0.5f);
  }
  return color;
}

StripLayout strip_layout(const Levels& reference, const Strip& strip) {
  CHECK(reference.width > 0 && reference.height > 0);
  StripLayout at;
  at.zoom = std::min((kPanelWidth - 1) / static_cast<int>(reference.width) + 1,
                     std::max(1, kPanelHeightMax / static_cast<int>(reference.height)));
  std::size_t columns = kTextColumns, lines = 0;
  for (const StripRow& row : strip.rows) {
    std::vector<std::string> text = row_text(row);
    for (const std::string& line : text) columns = std::max(columns, line.size());
    lines = std::max(lines, text.size());
  }
  int panel_width = at.zoom * static_cast<int>(reference.width);
  for (int i = 0; i < 4; ++i) at.panel_column[i] = kGap + i * (panel_width + kGap);
  at.text_column = kGap + 4 * (panel_width + kGap);
  at.width = at.text_column + text_box_width(static_cast<int>(columns), kTextScale) + kGap;
  int panel_height =
      std::max(at.zoom * static_cast<int>(reference.height), text_box_height(static_cast<int>(lines), kTextScale));
  at.first_row = text_box_height(1, kTextScale) + kGap;
  at.row_step = panel_height + kGap;
  at.height = at.first_row + static_cast<int>(strip.rows.size()) * at.row_step;
  return at;
}

Levels draw_strip(const Levels& reference, const Strip& strip) {
  StripLayout at = strip_layout(reference, strip);
  Levels result;
  result.width = static_cast<std::uint32_t>(at.width), result.height = static_cast<std::uint32_t>(at.height);
  result.rgb.resize(std::size_t{3} * result.width * result.height);
  CHECK_EQ(reference.rgb.size(), std::size_t(3) * reference.width * reference.height);
  const std::string headings[4] = {"reference", "setting", format("%dx difference", kDifferenceGain), "FLIP map"};
  for (int i = 0; i < 4; ++i) draw_text(&result, at.panel_column[i], 0, {headings[i]});
  for (std::size_t i = 0; i < strip.rows.size(); ++i) {
    const StripRow& row = strip.rows[i];
    CHECK_EQ(row.picture.rgb.size(), reference.rgb.size());
    CHECK_EQ(3 * row.flip_map.size(), reference.rgb.size());
    draw_row(&result, at, at.first_row + static_cast<int>(i) * at.row_step, reference, row);
  }
  return result;
}

Status encode_png(const Levels& picture, std::string* bytes) {
  int width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
  CHECK_EQ(picture.rgb.size(), std::size_t(3) * picture.width * picture.height);
  std::vector<std::uint8_t> block(encode_png_need(width) + kArenaAlignment);
  Arena arena = make_arena("picture", block.data(), block.size());
  bytes->clear();
  auto append = [](void* user, const void* data, std::size_t count) {
    static_cast<std::string*>(user)->append(static_cast<const char*>(data), count);
  };
  return encode_png(picture.rgb.data(), width, height, &arena, {append, bytes});
}

}  // namespace pocketray
