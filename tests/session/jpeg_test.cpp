// JPEG pictures.
#include "session/jpeg.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#ifdef POCKETRAY_HAVE_IMPORT
#include "desktop/import/image.h"
#endif
#include "session/picture.h"

using namespace pocketray;

// Goal: a build says whether it has JPEG. Method: a path of that kind is accepted or refused in one line.
TEST_CASE("jpeg_is_there_or_refused") {
  for (const char* path : {"a.jpg", "a.jpeg"}) {
    const Status status = check_picture_path(path);
    CHECK(status.ok == has_jpeg());
    if (!status.ok) CHECK(std::string(status.message).find("has no JPEG support: write .png") != std::string::npos);
  }
  CHECK_FALSE(check_picture_path("a.jpe").ok);
}

#ifdef POCKETRAY_HAVE_IMPORT
// Goal: a JPEG has the picture's size and, as near as the eye sees, its pixels. Method: gradients and an edge of
// colours at sizes that are no multiple of a block, read back by the importers' reader.
TEST_CASE("jpeg_is_near_the_picture") {
  if (!has_jpeg()) return;
  constexpr int kSizes[][2] = {{1, 1}, {17, 9}, {64, 48}, {320, 240}};
  for (const auto& size : kSizes) {
    CAPTURE(size[0]);
    std::vector<std::uint8_t> rgb, written;
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x)
        rgb.insert(rgb.end(), {static_cast<std::uint8_t>(x < size[0] / 2 ? 220 : 30), static_cast<std::uint8_t>(y),
                               static_cast<std::uint8_t>(200 - x / 2)});
    auto append = [](void* user, const void* bytes, std::size_t count) {
      auto* to = static_cast<std::vector<std::uint8_t>*>(user);
      to->insert(to->end(), static_cast<const std::uint8_t*>(bytes), static_cast<const std::uint8_t*>(bytes) + count);
    };
    encode_jpeg(rgb.data(), size[0], size[1], {append, &written});
    REQUIRE(written.size() > 4);
    CHECK((written[0] == 0xff && written[1] == 0xd8));
    CHECK((written[written.size() - 2] == 0xff && written.back() == 0xd9));
    Image image;
    REQUIRE(read_image(Bytes(written.begin(), written.end()), "a.jpg", 1 << 20, &image).ok);
    CHECK((image.width == static_cast<std::uint32_t>(size[0]) && image.height == static_cast<std::uint32_t>(size[1])));
    double sum = 0;
    for (std::size_t i = 0; i < image.texels.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        sum += std::pow(static_cast<double>(image.texels[i] >> (8 * c) & 255) - rgb[3 * i + c], 2);
    CHECK(std::sqrt(sum / static_cast<double>(3 * image.texels.size())) < 3);
  }
}
#endif
