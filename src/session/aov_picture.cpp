#include "session/aov_picture.h"

#include <algorithm>
#include <cstdio>

#include "base/check.h"
#include "base/color.h"
#include "session/report.h"

namespace pocketray {
namespace {

Vec3 linear(const std::uint8_t levels[3]) {
  return {srgb_to_linear(levels[0]), srgb_to_linear(levels[1]), srgb_to_linear(levels[2])};
}

Vec3 color_of(Aov aov, const Vec3& value, float most, const Box& range) {
  std::uint8_t levels[3];
  switch (aov) {
    case Aov::position: {
      const Vec3 size = extent(range), from = value - range.low;
      if (is_zero(value)) return value;
      return {size.x > 0 ? from.x / size.x : 0, size.y > 0 ? from.y / size.y : 0, size.z > 0 ? from.z / size.z : 0};
    }
    case Aov::normal:
      return is_zero(value) ? value : (value + Vec3{1, 1, 1}) * 0.5f;
    case Aov::triangle:
      if (is_zero(value)) return value;
      color_of_number(static_cast<std::uint32_t>(value.x), levels);
      return linear(levels);
    case Aov::cost:
      viridis(most > 0 ? value.x / most : 0, levels);
      return linear(levels);
    default:
      return most > 0 ? value * (1 / most) : value;
  }
}

// Calls visit() with every pixel of the box.
template <class Visit>
void for_each_pixel(const PixelBox& box, Renderer* renderer, Visit visit) {
  for (int y = box.top; y < box.top + box.height; ++y) {
    Vec3* row = renderer->image.data + static_cast<std::size_t>(y) * renderer->settings.width;
    for (int x = box.left; x < box.left + box.width; ++x) visit(&row[x]);
  }
}

}  // namespace

AovPicture color_aov(Aov aov, const PixelBox& box, Renderer* renderer) {
  CHECK(aov != Aov::none && renderer->image.data != nullptr);
  float most = 0;
  Box range = empty_box();
  for_each_pixel(box, renderer, [&](Vec3* p) {
    most = std::max(most, max_component(*p));
    if (!is_zero(*p)) range = merge(range, *p);
  });
  for_each_pixel(box, renderer, [&](Vec3* p) { *p = color_of(aov, *p, most, range); });
  renderer->view.exposure = 1, renderer->settings.tone = Tone::clip;
  AovPicture picture;
  const int width = box.height >= 3 * kLegendHeight ? box.width : 0;  // it hides at most a third of the picture
  char high[24];
  std::snprintf(high, sizeof high, "%.6g", static_cast<double>(most));
  if (aov == Aov::cost) {
    picture.legend = make_scale_legend("cost", "0", high, "boxes and triangles", width);
    std::snprintf(picture.told, sizeof picture.told,
                  "  cost: dark violet is 0, yellow %s boxes and triangles visited by all rays of a pixel", high);
  }
  if (aov == Aov::normal) {
    picture.legend = make_text_legend("normal: x, y, z as red, green, blue", width);
    std::snprintf(picture.told, sizeof picture.told,
                  "  normal: x, y, z as red, green, blue, each dark at -1, bright at 1");
  }
  if (aov == Aov::triangle) {
    picture.legend = make_text_legend("triangle: one colour each", width);
    std::snprintf(picture.told, sizeof picture.told,
                  "  triangle: one colour each; .pfm and .exr have their numbers, plus 1");
  }
  if (aov == Aov::position) {
    picture.legend = make_text_legend("position: x, y, z as red, green, blue", width);
    std::snprintf(picture.told, sizeof picture.told,
                  "  position: x, y, z as red, green, blue, over what is seen; .pfm and .exr have the coordinates");
  }
  if (aov == Aov::depth)
    std::snprintf(picture.told, sizeof picture.told,
                  "  depth: white is %s scene units away; .pfm and .exr have the distances", high);
  return picture;
}

}  // namespace pocketray
