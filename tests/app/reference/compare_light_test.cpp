// Comparing pictures of linear light: PFM and OpenEXR files.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "app/accuracy/compare.h"
#include "base/color.h"
#include "base/float_bits.h"
#include "desktop/accuracy/flip.h"
#include "present/image_file.h"
#include "session/exr.h"
#include "support/exr_bytes.h"
#include "support/picture_folder.h"

using namespace pocketray;

namespace {

AnyPicture constant_light(std::uint32_t width, std::uint32_t height, Vec3 radiance) {
  AnyPicture picture;
  picture.is_linear = true;
  picture.light = {width, height, std::vector<Vec3>(std::size_t{width} * height, radiance)};
  return picture;
}

Comparison compared(const AnyPicture& a, const AnyPicture& b, const Development& development) {
  Comparison c;
  Status status = compare_pictures(a, b, development, kHandheldPixelsPerDegree, &c);
  REQUIRE_MESSAGE(status.ok, status.message);
  return c;
}

ByteSink sink_to(std::string* bytes) {
  return {[](void* user, const void* part, std::size_t count) {
            static_cast<std::string*>(user)->append(static_cast<const char*>(part), count);
          },
          bytes};
}

std::string big_endian(float value) {
  std::string bytes;
  for (int i = 3; i >= 0; --i) bytes += static_cast<char>(float_bits(value) >> 8 * i);
  return bytes;
}

Status read_bytes(const PictureFolder& folder, const std::string& bytes, AnyPicture* picture) {
  save(folder / "picture", bytes);
  return read_picture(folder / "picture", picture);
}

// Refused in one line that names the file.
void check_refused(const PictureFolder& folder, const std::string& bytes, const char* why) {
  AnyPicture picture;
  Status status = read_bytes(folder, bytes, &picture);
  CAPTURE(why);
  CAPTURE(status.message);
  CHECK(!status.ok);
  CHECK(std::strstr(status.message, (folder / "picture").c_str()) == status.message);
  CHECK(std::strstr(status.message, why) != nullptr);
  CHECK(std::strchr(status.message, '\n') == nullptr);
}

}  // namespace

// Goal: figures of constant pictures are those of their radiance. Method: 0.5 and 0.4, 12 pixels: RMSE and bias by
// their difference, relative MSE with the floor of 0.01; displayed RMSE by the sRGB curve; 1.25 aligns them.
TEST_CASE("compare_light_equals_the_closed_form") {
  const AnyPicture a = constant_light(4, 3, {0.5f, 0.5f, 0.5f}), b = constant_light(4, 3, {0.4f, 0.4f, 0.4f});
  Comparison c = compared(a, b, {});
  CHECK(c.are_linear);
  CHECK(c.light.rmse == doctest::Approx(0.1).epsilon(1e-6));
  CHECK(c.light.bias == doctest::Approx(-0.1).epsilon(1e-6));
  CHECK(c.light.rel_mse == doctest::Approx(0.01 / 0.26).epsilon(1e-6));
  auto encode = [](double v) { return 1.055 * std::pow(v, 1 / 2.4) - 0.055; };
  CHECK(c.errors.rmse == doctest::Approx(encode(0.5) - encode(0.4)).epsilon(1e-5));
  CHECK(c.exposure == 1);
  CHECK(c.scale == 1);
  CHECK(c.differing_count == 12);
  CHECK((c.flip > 0 && c.flip <= c.flip_max));
  c = compared(a, b, {false, 1, true});
  CHECK(c.scale == doctest::Approx(1.25).epsilon(1e-6));
  CHECK(c.light.rmse < 1e-6);
  CHECK(c.errors.rmse < 1e-6);
  c = compared(a, b, {false, 0.5, false});
  CHECK(c.light.rmse == doctest::Approx(0.1).epsilon(1e-6));  // radiance, before exposure
  CHECK(c.errors.rmse == doctest::Approx(encode(0.25) - encode(0.2)).epsilon(1e-5));
  c = compared(a, b, {true, 1, false});
  CHECK(c.exposure == doctest::Approx(0.36).epsilon(1e-6));
  c = compared(a, a, {});
  CHECK(c.light.rmse == 0);
  CHECK(c.flip == 0);
  CHECK(c.differing_count == 0);
}

// Goal: the aligned scale minimises the squared differences. Method: a noisy multiple; a scale 1e-3 above and one below
// are worse. Pictures without common light have no scale.
TEST_CASE("compare_light_aligned_scale_is_the_best") {
  std::vector<double> a, b;
  for (int i = 0; i < 300; ++i) a.push_back(i % 17 + 0.25), b.push_back(3 * a.back() + (i % 5 - 2));
  auto squares = [&](double scale) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (scale * b[i] - a[i]) * (scale * b[i] - a[i]);
    return sum;
  };
  const double scale = aligned_scale(a, b);
  CHECK(scale == doctest::Approx(1 / 3.0).epsilon(0.05));
  CHECK(squares(scale) < squares(1.001 * scale));
  CHECK(squares(scale) < squares(0.999 * scale));
  CHECK(aligned_scale({1, 0}, {0, 1}) == 0);
  CHECK(aligned_scale({1, 1}, {0, 0}) == 0);
  CHECK(aligned_scale({1, 1}, {-1, -1}) == 0);
  Comparison c;
  const AnyPicture lit = constant_light(2, 2, {1, 1, 1}), dark = constant_light(2, 2, {0, 0, 0});
  Status status = compare_pictures(lit, dark, {false, 1, true}, kHandheldPixelsPerDegree, &c);
  CHECK(!status.ok);
  CHECK(std::strstr(status.message, "no light in common") != nullptr);
}

// Goal: light beside levels is shown as they are; aligned, its exposure is found. Method: levels of a ramp at exposure
// 2, one channel far beyond white.
TEST_CASE("compare_light_beside_levels_is_exposed_and_quantised") {
  AnyPicture light = constant_light(16, 8, {0, 0, 0}), levels;
  levels.levels = {16, 8, {}};
  for (std::size_t i = 0; i < 128; ++i) {
    light.light.radiance[i] = {static_cast<float>(i) / 256, 0.25f, 40};
    for (int c = 0; c < 3; ++c) levels.levels.rgb.push_back(srgb_level(2 * light.light.radiance[i][c]));
  }
  Comparison c = compared(levels, light, {false, 2, false});
  CHECK(c.differing_count == 0);
  CHECK(c.errors.rmse == 0);
  CHECK(!c.are_linear);
  CHECK(c.has_exposure);
  CHECK(compared(light, levels, {false, 2, false}).differing_count == 0);
  CHECK(compared(levels, light, {}).errors.rmse > 0.1);
  for (const Comparison& found : {compared(levels, light, {false, 1, true}), compared(light, levels, {false, 1, true})})
    CHECK(found.exposure == doctest::Approx(2).epsilon(2e-3));
}

// Goal: values are read as written. Method: PFM by encode_pfm(), and by hand in the other order of bytes, with a scale,
// grey, and with data behind the picture; every prefix is refused.
TEST_CASE("compare_light_reads_pfm") {
  PictureFolder folder;
  const float values[18] = {0, .5f, 1, 2, 3, 4, -1, 1e30f, 1e-40f, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  std::string ours, grey = "Pf 2 1 3.5\n" + big_endian(2) + big_endian(-4), other = "PF\n2\t3\n+0.5e+0 ";
  encode_pfm(values, 3, 2, 3, sink_to(&ours));
  for (int row = 2; row >= 0; --row)
    for (int i = 0; i < 6; ++i) other += big_endian(values[6 * row + i]);
  AnyPicture read;
  REQUIRE(read_bytes(folder, ours, &read).ok);
  CHECK(read.is_linear);
  CHECK(read.width() == 2);
  CHECK(read.height() == 3);
  CHECK(std::memcmp(read.light.radiance.data(), values, sizeof values) == 0);
  REQUIRE(read_bytes(folder, other, &read).ok);
  for (std::size_t i = 0; i < 18; ++i)
    if (i != 8) CHECK(read.light.radiance[i / 3][static_cast<int>(i % 3)] == 0.5f * values[i]);
  REQUIRE(read_bytes(folder, grey + "more", &read).ok);
  CHECK(read.light.radiance[0].z == 7);
  CHECK(read.light.radiance[1].x == -14);
  for (std::size_t count = 0; count < ours.size(); ++count) CHECK(!read_bytes(folder, ours.substr(0, count), &read).ok);
}

// Goal: a hostile PFM is refused, whatever its header promises. Method: sizes that are negative, 0, not a number, or
// whose product overflows 32 or 64 bits; scales; values; words longer than any number.
TEST_CASE("compare_light_refuses_hostile_pfm") {
  PictureFolder folder;
  const std::string pixels(64, 0);
  for (const char* size : {"-1 4", "0 1", "1 0", "65536 65537", "4294967297 1", "18446744073709551617 1", "x 1",
                           "1.5 1", "4097 4096", "1073741824 4", "nan 1"})
    check_refused(folder, "PF\n" + std::string(size) + "\n-1.0\n" + pixels, "1 to 16777216 pixels");
  for (const char* scale : {"0", "nan", "inf", "-inf", "1e999", "x", "1x", "-"})
    check_refused(folder, "PF\n1 1\n" + std::string(scale) + "\n" + pixels, "scale");
  check_refused(folder, "PF\n" + std::string(100000, '1'), "pixels");
  check_refused(folder, "PF\n1 1\n" + std::string(100000, '1'), "scale");
  check_refused(folder, "PF\n4096 4096\n-1.0\n" + pixels, "truncated");
  check_refused(folder, "PF\n1 1\n-1.0", "truncated");
  check_refused(folder, "Pf 2 1 1\n" + big_endian(1) + big_endian(std::nanf("")), "NaN, in column 1 of row 0");
  check_refused(folder, "Pf 1 2 1\n" + big_endian(1) + big_endian(-INFINITY), "infinite, in column 0 of row 0");
  check_refused(folder, "Pf 1 1 100\n" + big_endian(3e38f), "infinite");
}

// Goal: 16-bit and 32-bit channels, grey, alpha, windows away from the origin, scanlines and tiles are read. Method:
// files made byte by byte, with value 2^(place − 4), and the encoder's.
TEST_CASE("compare_light_reads_exr") {
  if (!has_exr()) {
    MESSAGE("skipped: this build has no OpenEXR");
    return;
  }
  PictureFolder folder;
  auto exponent = [](const std::string& name, int column, int row) {
    return (name == "G" ? 1 : name == "B" ? 2 : name == "A" ? 3 : 0) + 2 * column - row - 4;
  };
  using Channels = std::vector<ExrBytes::Channel>;
  for (const Channels& channels :
       {Channels{{"A"}, {"B"}, {"G"}, {"R"}}, Channels{{"B", 2}, {"G", 2}, {"R", 2}},
        Channels{{"B", 1}, {"G", 2}, {"R", 1}, {"Z", 2}, {"id", 0}}, Channels{{"Y"}}, Channels{{"A", 2}, {"Y", 2}}})
    for (std::uint32_t tile : {0u, 2u, 64u}) {
      ExrBytes exr = {channels, -3, 7, 1, 9, tile};
      const std::string bytes = exr.file([&](int c, int column, int row) {
        const auto bits = static_cast<std::uint32_t>(exponent(channels[static_cast<std::size_t>(c)].name, column, row));
        return channels[static_cast<std::size_t>(c)].type == 1 ? (bits + 15) << 10 : (bits + 127) << 23;
      });
      AnyPicture read;
      Status status = read_bytes(folder, bytes, &read);
      REQUIRE_MESSAGE(status.ok, status.message);
      REQUIRE(read.width() == 5);
      REQUIRE(read.height() == 3);
      const bool is_grey = channels.back().name == "Y";
      for (int i = 0; i < 15; ++i)
        for (int c = 0; c < 3; ++c)
          CHECK(read.light.radiance[static_cast<std::size_t>(i)][c] ==
                std::ldexp(1.0f, exponent(is_grey ? "Y" : std::string(1, "RGB"[c]), i % 5, i / 5)));
      for (std::size_t count = 0; count < bytes.size(); ++count)
        CHECK(!read_bytes(folder, bytes.substr(0, count), &read).ok);
    }
  std::vector<float> values;
  for (int i = 0; i < 3 * 40 * 33; ++i) values.push_back(static_cast<float>(i % 91) / 7);
  std::string ours;
  REQUIRE(encode_exr(values.data(), 40, 33, 120, sink_to(&ours)).ok);
  AnyPicture read;
  REQUIRE(read_bytes(folder, ours, &read).ok);
  REQUIRE(read.light.radiance.size() == 40 * 33);
  CHECK(std::memcmp(read.light.radiance.data(), values.data(), values.size() * sizeof(float)) == 0);
}

// Goal: a hostile OpenEXR file ends in one line, without a crash and without taking memory for what it only promises.
// Method: windows, tiles and channels that no picture has; every byte changed in three ways.
TEST_CASE("compare_light_refuses_hostile_exr") {
  if (!has_exr()) {
    MESSAGE("skipped: this build has no OpenEXR");
    return;
  }
  PictureFolder folder;
  auto one = [](int, int, int) { return 0x3C00u; };
  const ExrBytes good = {{{"B"}, {"G"}, {"R"}}, 0, 0, 4, 2};
  const std::string bytes = good.file(one);
  auto with = [&](auto change) {
    ExrBytes changed = good;
    change(&changed);
    return changed.header() + bytes.substr(good.header().size());
  };
  constexpr std::int32_t kMin = INT32_MIN, kMax = INT32_MAX;
  for (const auto& w : {std::vector<std::int32_t>{kMin, kMin, kMax, kMax},
                        {0, 0, kMax, 0},
                        {0, 0, 0, kMax},
                        {0, 0, 65535, 65536},
                        {0, 0, -1, 0},
                        {kMin, 0, 0, 0},
                        {3, 0, 0, 0},
                        {0, 0, 4095, 4096}})
    check_refused(folder, with([&](ExrBytes* e) { e->left = w[0], e->top = w[1], e->right = w[2], e->bottom = w[3]; }),
                  ":");
  check_refused(folder, with([](ExrBytes* e) { e->right = e->bottom = 4095; }), ":");
  for (std::uint32_t tile : {1u, 0x7FFFFFFFu, 0xFFFFFFFFu})
    check_refused(folder, with([&](ExrBytes* e) { e->tile = tile, e->right = e->bottom = 4095; }), ":");
  check_refused(folder, with([](ExrBytes* e) { e->channels.pop_back(); }), "no channels R, G and B");
  check_refused(folder, with([](ExrBytes* e) { e->channels[2].type = 0; }), "no channels R, G and B");
  check_refused(folder, with([](ExrBytes* e) { e->channels.assign(2000, {"R"}); }), ":");
  check_refused(folder, with([](ExrBytes* e) { e->channels[0].sampling = 2; }), ":");
  check_refused(folder, with([](ExrBytes* e) { e->compression = 99; }), ":");
  check_refused(folder, good.file([](int, int column, int) { return column == 3 ? 0x7E00u : 0x3C00u; }),
                "NaN, in column 3 of row 0");
  check_refused(folder, good.file([](int, int, int row) { return row == 2 ? 0xFC00u : 0x3C00u; }),
                "infinite, in column 0 of row 2");
  const AnyPicture before = constant_light(1, 1, {1, 1, 1});
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (int change : {1, 0x80, 0xFF}) {
      std::string changed = bytes;
      changed[i] = static_cast<char>(changed[i] ^ change);
      AnyPicture read = before;
      if (read_bytes(folder, changed, &read).ok)
        CHECK(read.light.radiance.size() == std::size_t{read.width()} * read.height());
    }
}
