// Environments from pictures and from the sky.
#include "desktop/import/environment.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

#include "base/color.h"
#include "base/fmath.h"
#include "base/rng.h"
#include "brdf/brdf_list.h"
#include "indirect/environment.h"

using namespace pocketray;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes header(const std::string& size, const std::string& lines = "FORMAT=32-bit_rle_rgbe\n") {
  const std::string text = "#?RADIANCE\n" + lines + "\n" + size + "\n";
  return Bytes(text.begin(), text.end());
}
void add(Bytes* to, const Bytes& more) { to->insert(to->end(), more.begin(), more.end()); }

// 16 × 2 pixels: a row by components, in runs and literal parts, and a row as it is, with a repetition.
Bytes small_picture() {
  Bytes bytes = header("-Y 2 +X 16");
  add(&bytes, {2, 2, 0, 16});
  for (std::uint8_t c = 0; c < 3; ++c) add(&bytes, {128 + 15, static_cast<std::uint8_t>(10 * c), 1, 200});
  add(&bytes, {16, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136});
  add(&bytes, {100, 50, 25, 129, 1, 1, 1, 14, 9, 8, 7, 0});
  return bytes;
}

Status decode(const Bytes& bytes) {
  RadiancePicture picture;
  return decode_radiance(bytes, &picture);
}

Vec3d random_direction(Rng* rng) {
  const double z = 2 * next_double(rng) - 1, phi = 2 * kPi * next_double(rng), sine = std::sqrt(1 - z * z);
  return {sine * det_cos(phi), sine * det_sin(phi), z};
}

// A picture in memory as a file; removed at the end.
struct File {
  std::string path;
  File(const char* name, const Bytes& bytes) : path(name) {
    std::FILE* file = std::fopen(name, "wb");
    REQUIRE(file != nullptr);
    CHECK(std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size());
    std::fclose(file);
  }
  ~File() { std::remove(path.c_str()); }
};

std::string read_error(const std::string& name) {
  ImportedEnvironment environment;
  return read_environment(name, &environment).message;
}
bool mentions(const std::string& text, const char* what) { return text.find(what) != std::string::npos; }

Vec3d smooth(const Vec3d& d) { return {1 + d.x, 2 + d.y * d.y, std::fmax(0, d.z) * 3}; }

}  // namespace

// Goal: both codings of Radiance pictures are read, with the exposure undone. Method: pixels known by hand; 2^(e − 136)
// times mantissa plus a half.
TEST_CASE("environment_radiance_pictures_are_read") {
  RadiancePicture picture;
  Status status = decode_radiance(small_picture(), &picture);
  REQUIRE_MESSAGE(status.ok, status.message);
  REQUIRE(picture.pixels.size() == 32);
  CHECK(picture.pixels[0] == Vec3{0.5f, 10.5f, 20.5f});
  CHECK(picture.pixels[14] == Vec3{0.5f, 10.5f, 20.5f});
  CHECK(picture.pixels[15] == Vec3{200.5f, 200.5f, 200.5f});
  for (std::size_t x : {16u, 20u, 30u}) CHECK(picture.pixels[x] == Vec3{100.5f, 50.5f, 25.5f} * (1 / 128.0f));
  CHECK(is_zero(picture.pixels[31]));
  Bytes exposed = header("-Y 1 +X 1", "EXPOSURE=2\nSOFTWARE=test\nEXPOSURE=4\n");
  add(&exposed, {0, 1, 2, 136});
  status = decode_radiance(exposed, &picture);
  REQUIRE_MESSAGE(status.ok, status.message);
  CHECK(picture.pixels[0] == Vec3{0.5f / 8, 1.5f / 8, 2.5f / 8});
}

// Goal: hostile pictures are refused in a line, without much memory. Method: every truncation, every byte changed to
// its opposite, sizes of nothing and of too much, runs beyond their row.
TEST_CASE("environment_radiance_pictures_that_are_damaged_are_refused") {
  const Bytes whole = small_picture();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    cut.shrink_to_fit();
    const Status status = decode(cut);
    CHECK_FALSE(status.ok);
    CHECK(status.message[0] != 0);
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    Bytes changed = whole;
    changed[i] = static_cast<std::uint8_t>(~changed[i]);
    RadiancePicture picture;
    if (decode_radiance(changed, &picture).ok) CHECK(picture.pixels.size() == 32);
  }
  for (const char* size : {"-Y 0 +X 4", "-Y 4 +X 0", "-Y 16385 +X 1", "-Y 16384 +X 16384", "-Y 99999999999 +X 1",
                           "+Y 4 +X 4", "-Y 4 +X 4 x", "-Y -4 +X 4", ""})
    CHECK_FALSE(decode(header(size)).ok);
  CHECK(mentions(decode(header("-Y 8192 +X 8192")).message, "row 0 of 8192"));
  CHECK_FALSE(decode(header("-Y 1 +X 1", "FORMAT=32-bit_rle_xyze\n")).ok);
  for (const char* exposure : {"EXPOSURE=0\n", "EXPOSURE=nan\n", "EXPOSURE=-1\n", "EXPOSURE=1e99\n"})
    CHECK_FALSE(decode(header("-Y 1 +X 1", exposure)).ok);
  for (const Bytes& row : {Bytes{2, 2, 0, 16, 128 + 17, 1}, Bytes{2, 2, 0, 16, 0, 1}, Bytes{1, 1, 1, 2},
                           Bytes{5, 5, 5, 128, 1, 1, 1, 16}}) {
    Bytes bytes = header("-Y 1 +X 16");
    add(&bytes, row);
    bytes.resize(bytes.size() + 200, 9);
    CHECK_FALSE(decode(bytes).ok);
  }
}

// Goal: what cannot be an environment is told in one line that names it.
TEST_CASE("environment_names_that_mean_nothing_are_told") {
  CHECK(mentions(read_error("no-such-file.hdr"), "no-such-file.hdr"));
  for (const char* sky : {"sky:", "sky:x", "sky:30,", "sky:30,3,4", "sky:30 ", "sky:nan"})
    CHECK(mentions(read_error(sky), "write sky:ELEVATION,TURBIDITY"));
  for (const char* sky : {"sky:-1", "sky:91"}) CHECK(mentions(read_error(sky), "must lie in 0 … 90"));
  for (const char* sky : {"sky:30,1", "sky:30,11"}) CHECK(mentions(read_error(sky), "must lie in 2 … 10"));
  const File text("environment-text.hdr", {'h', 'e', 'l', 'l', 'o'});
  CHECK(mentions(read_error(text.path), "environment-text.hdr"));
  Bytes cut = small_picture();
  cut.resize(cut.size() - 3);
  const File short_file("environment-cut.hdr", cut);
  CHECK(mentions(read_error(short_file.path), "environment-cut.hdr is cut short"));
  ImportedEnvironment environment;
  CHECK_FALSE(make_environment(
                  8, 1,
                  [](const Vec3d&) {
                    return Vec3d{1e30, 0, 0};
                  },
                  &environment)
                  .ok);
}

// Goal: a picture's directions: −Z in the middle, +X to its right, +Y on top, seamless behind. Method: a picture whose
// colours name the directions of its pixels.
TEST_CASE("environment_pictures_lie_around_the_scene") {
  constexpr int kWidth = 128, kHeight = 64;
  Bytes bytes = header("-Y 64 +X 128");
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double phi = 2 * kPi * ((x + 0.5) / kWidth - 0.5), theta = kPi * (y + 0.5) / kHeight;
      const double d[3] = {det_sin(theta) * det_sin(phi), det_cos(theta), -det_sin(theta) * det_cos(phi)};
      for (double value : d) bytes.push_back(static_cast<std::uint8_t>(127.5 + 120 * value));
      bytes.push_back(129);
    }
  const File file("environment-directions.hdr", bytes);
  ImportedEnvironment environment;
  const Status status = read_environment(file.path, &environment);
  REQUIRE_MESSAGE(status.ok, status.message);
  CHECK(environment.lights.empty());
  CHECK(environment.info.side == 64);
  Scene scene;
  scene.environment_info = {&environment.info, 1};
  scene.environment_texels = {environment.texels.data(), static_cast<std::uint32_t>(environment.texels.size())};
  REQUIRE(environment.texels.size() == environment_texel_count(64, 64));
  Rng rng = make_rng(1);
  for (int i = 0; i < 3000; ++i) {
    Vec3d d = random_direction(&rng);
    if (i % 3 == 0) d.x *= 1e-3, d.z = std::fabs(d.z), d = normalize(d);  // the picture's edge
    const Vec3 found = environment_radiance(scene, {float(d.x), float(d.y), float(d.z)});
    for (int c = 0; c < 3; ++c) CHECK(std::fabs(double(found[c]) * 128 - (127.5 + 120 * d[c])) < 5);
  }
}

// Goal: the nine coefficients give the irradiance of smooth light to 1 %, of the sky to a tenth of its mean
// [Ramamoorthi & Hanrahan 2001 state 9 % at most, 1 % in the mean, for low-frequency light]. Method: numeric
// integration.
TEST_CASE("environment_irradiance_is_the_integral") {
  const Sky sky;
  for (bool is_sky : {false, true}) {
    auto radiance = [&](const Vec3d& d) { return is_sky ? sky_radiance(sky, d) : smooth(d); };
    ImportedEnvironment environment;
    REQUIRE(make_environment(64, 2, radiance, &environment).ok);
    constexpr int kSide = 200;
    for (const Vec3d& n : {Vec3d{0, 1, 0}, Vec3d{0, -1, 0}, Vec3d{0.6, 0, 0.8}, normalize(Vec3d{-1, 1, 1})}) {
      Vec3d sum = {0, 0, 0};
      for (int i = 0; i < kSide * kSide; ++i) {
        const Vec3d p = from_octahedral(2 * (i % kSide + 0.5) / kSide - 1, 2 * (i / kSide + 0.5) / kSide - 1);
        const double square = dot(p, p), cosine = dot(p, n) / std::sqrt(square);
        if (cosine > 0)
          sum += radiance(p / std::sqrt(square)) * (cosine * 4 / (kSide * kSide * square * std::sqrt(square)));
      }
      const Vec3d found = environment_irradiance(environment.info, n);
      const double mean = max_component(to_double(environment.mean));
      for (int c = 0; c < 3; ++c) {
        CAPTURE(is_sky);
        CHECK(std::fabs(found[c] - sum[c] / kPi) <= (is_sky ? 0.1 : 0.02) * mean);
      }
    }
  }
}

// Goal: the levels hold what a GGX lobe reflects to a viewer along the normal. Method: the lobe's own samples, weighted
// by the cosine [Karis 2013], of smooth light and of light with an edge.
TEST_CASE("environment_levels_are_the_lobes_means") {
  for (bool has_edge : {false, true}) {
    auto radiance = [&](const Vec3d& d) { return has_edge ? Vec3d{d.x > 0.2 ? 1.0 : 0.0, 1, 2} : smooth(d); };
    ImportedEnvironment environment;
    REQUIRE(make_environment(128, 2, radiance, &environment).ok);
    Scene scene;
    scene.environment_info = {&environment.info, 1};
    scene.environment_texels = {environment.texels.data(), static_cast<std::uint32_t>(environment.texels.size())};
    Rng rng = make_rng(9);
    for (int level = 0; level < kGlossLevelCount; ++level)
      for (const Vec3d& n :
           {Vec3d{0, 1, 0}, Vec3d{1, 0, 0}, normalize(Vec3d{0.3, -0.9, 0.2}), normalize(Vec3d{1, 1, -1})}) {
        Material m;
        const float r = kGlossRoughness[level];
        m.roughness = r * r, m.grazing = 1;
        // The first samples are those of light scattered once.
        const double once = double(kGgxBrdf.albedo(m, {1, 1, 1}, 1).once.x) * (1 - 1e-6);
        Vec3d sum = {0, 0, 0};
        double weights = 0;
        for (int i = 0; i < 20000; ++i) {
          const Vec3d d = kGgxBrdf.sample(m, {n, {0, 0, 0}}, n, once * next_double(&rng), next_double(&rng));
          // Visible normals at normal incidence are distributed as all are: D n·h.
          const double cosine = dot(d, n);
          if (cosine > 0) sum += radiance(d) * cosine, weights += cosine;
        }
        const Vec3 found = environment_gloss(scene, {float(n.x), float(n.y), float(n.z)}, m.roughness);
        CAPTURE(level);
        CAPTURE(has_edge);
        for (int c = 0; c < 3; ++c) CHECK(std::fabs(double(found[c]) - sum[c] / weights) <= 0.03);
      }
  }
}

// Goal: an even picture becomes an even environment: every texel the same, and the mean.
TEST_CASE("environment_of_an_even_function_is_even") {
  ImportedEnvironment environment;
  REQUIRE(make_environment(
              32, 2,
              [](const Vec3d&) {
                return Vec3d{1, 0.5, 0.25};
              },
              &environment)
              .ok);
  for (std::uint32_t texel : environment.texels) CHECK(environment_texel(texel) == Vec3{1, 0.5f, 0.25f});
  for (int c = 0; c < 3; ++c) CHECK(environment.mean[c] == doctest::Approx(Vec3{1, 0.5f, 0.25f}[c]).epsilon(1e-6));
  for (int i = 1; i < 9; ++i) CHECK(max_component(abs(environment.info.irradiance[i])) < 2e-3f);
  REQUIRE(make_environment(
              8, 1,
              [](const Vec3d&) {
                return Vec3d{0x1p30, std::nan(""), -1};
              },
              &environment)
              .ok);
  CHECK(environment.info.scale > 1);
  CHECK(environment_texel(environment.texels[5]) * environment.info.scale == Vec3{0x1p30f, 0, 0});
}

// Goal: the sky is that of the model. Method: zenith luminance and chromaticity of app. A.2 at turbidity 3 and 45°,
// worked out by hand; brighter around the sun than opposite, blue above, redder near the horizon when the sun is low;
// the sun dimmer and redder the lower it is.
TEST_CASE("environment_sky_follows_preetham") {
  const Sky sky;
  const Vec3d zenith = sky_radiance(sky, {0, 1, 0});
  // χ = (4/9 − 3/120)·π/2 = .658858; (4.0453·3 − 4.9710) tan χ − .2155·3 + 2.4192 = 7.3215 kcd/m².
  CHECK(0.2126 * zenith.x + 0.7152 * zenith.y + 0.0722 * zenith.z == doctest::Approx(7.3215 / 30).epsilon(0.01));
  CHECK(zenith.z > 1.5 * zenith.x);
  const Light sun = sun_of(sky);
  const Vec3d to_sun = -to_double(sun.direction);
  CHECK(to_sun.y == doctest::Approx(std::sqrt(0.5)).epsilon(1e-6));
  const Vec3d opposite = {-to_sun.x, to_sun.y, -to_sun.z};
  CHECK(sky_radiance(sky, to_sun).y > 2 * sky_radiance(sky, opposite).y);
  Sky low, hazy;
  low.elevation = 3, hazy.turbidity = 8;
  const Light low_sun = sun_of(low);
  CHECK(low_sun.intensity.y < 0.5f * sun.intensity.y);
  CHECK(low_sun.intensity.z / low_sun.intensity.x < 0.5f * sun.intensity.z / sun.intensity.x);
  CHECK(sun_of(hazy).intensity.y < sun.intensity.y);
  CHECK(sun.intensity.y > 2);
  CHECK(sun.intensity.y < 4);
  Rng rng = make_rng(2);
  for (double elevation : {0.0, 1.0, 45.0, 90.0})
    for (double turbidity : {2.0, 10.0})
      for (int i = 0; i < 500; ++i) {
        const Vec3d found = sky_radiance({elevation, turbidity}, random_direction(&rng));
        for (int c = 0; c < 3; ++c) CHECK((found[c] >= 0 && found[c] < 100));
      }
}
