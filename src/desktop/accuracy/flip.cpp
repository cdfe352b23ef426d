#include "desktop/accuracy/flip.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Color {
  double x = 0, y = 0, z = 0;
};

struct Plane {
  std::size_t width = 0, height = 0;
  std::vector<double> values;
  Plane(std::size_t w, std::size_t h) : width(w), height(h), values(w * h) {}
};

// ---- Colour spaces: linear sRGB of the standard's primaries, CIE XYZ, YCxCz, L*a*b*. White is (1, 1, 1) in sRGB.

double linear_of_srgb(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

Color xyz_of_linear(const Color& c) {
  constexpr double d = 24577794, e = 12288897, f = 73733382;
  return {(10135552 * c.x + 8788810 * c.y + 4435075 * c.z) / d, (2613072 * c.x + 8788810 * c.y + 887015 * c.z) / e,
          (1425312 * c.x + 8788810 * c.y + 70074185 * c.z) / f};
}
Color linear_of_xyz(const Color& c) {
  return {3.241003275 * c.x - 1.537398934 * c.y - 0.498615861 * c.z,
          -0.969224334 * c.x + 1.875930071 * c.y + 0.041554224 * c.z,
          0.055639423 * c.x - 0.204011202 * c.y + 1.057148933 * c.z};
}
const Color& white() {
  static const Color white = xyz_of_linear({1, 1, 1});
  return white;
}
Color over_white(const Color& xyz) { return {xyz.x / white().x, xyz.y / white().y, xyz.z / white().z}; }

Color ycxcz_of_linear(const Color& linear) {
  Color n = over_white(xyz_of_linear(linear));
  return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}
Color linear_of_ycxcz(const Color& c) {
  double y = (c.x + 16) / 116, x = y + c.y / 500, z = y - c.z / 200;
  return linear_of_xyz({x * white().x, y * white().y, z * white().z});
}
// L*a*b* with the chroma of dark colours reduced for the Hunt effect (sec. 4.1, eq. 5).
Color hunt_lab_of_linear(const Color& linear) {
  auto f = [](double t) {
    constexpr double delta = 6.0 / 29;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  };
  Color n = over_white(xyz_of_linear(linear));
  double x = f(n.x), y = f(n.y), z = f(n.z), lightness = 116 * y - 16;
  return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}
double hyab(const Color& a, const Color& b) { return std::fabs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

// ---- Filters. All are sums of separable filters; border pixels are repeated outwards.

// Convolves along one axis: `line_count` lines, `line_step` apart, of `count` pixels, `step` apart.
void convolve_lines(const std::vector<double>& in, const std::vector<double>& filter, std::size_t count,
                    std::size_t step, std::size_t line_count, std::size_t line_step, std::vector<double>* out) {
  std::ptrdiff_t radius = static_cast<std::ptrdiff_t>(filter.size() / 2);
  std::ptrdiff_t last = static_cast<std::ptrdiff_t>(count) - 1;
  for (std::size_t line = 0; line < line_count; ++line)
    for (std::ptrdiff_t at = 0; at <= last; ++at) {
      double sum = 0;
      for (std::ptrdiff_t i = -radius; i <= radius; ++i) {
        std::size_t from = static_cast<std::size_t>(std::min(std::max<std::ptrdiff_t>(at + i, 0), last));
        sum += in[line * line_step + from * step] * filter[static_cast<std::size_t>(i + radius)];
      }
      (*out)[line * line_step + static_cast<std::size_t>(at) * step] = sum;
    }
}

Plane convolve(const Plane& in, const std::vector<double>& along_x, const std::vector<double>& along_y) {
  CHECK(along_x.size() % 2 == 1 && along_y.size() % 2 == 1);  // filters have a middle
  Plane middle(in.width, in.height), out(in.width, in.height);
  convolve_lines(in.values, along_x, in.width, 1, in.height, in.width, &middle.values);
  convolve_lines(middle.values, along_y, in.height, in.width, in.width, 1, &out.values);
  return out;
}

template <class Function>
std::vector<double> taps(int radius, Function value) {
  std::vector<double> result;
  for (int i = -radius; i <= radius; ++i) result.push_back(value(static_cast<double>(i)));
  return result;
}
double sum(const std::vector<double>& values) {
  double total = 0;
  for (double v : values) total += v;
  return total;
}
void scale_to(std::vector<double>* values, double total) {
  double factor = total / sum(*values);
  for (double& v : *values) v *= factor;
}

// Table 1: the contrast sensitivity of each channel, as Gaussians in space: a √(π/b) exp(-π² d²/b), d in degrees.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity kAchromatic = {1, 0.0047, 0, 1e-5}, kRedGreen = {1, 0.0053, 0, 1e-5},
                      kBlueYellow = {34.1, 0.04, 13.5, 0.025};

// Returns one channel as seen from a distance (sec. 4.1, eq. 3).
Plane see(const Plane& channel, const Sensitivity& s, double pixels_per_degree) {
  // Three standard deviations of the widest Gaussian of all channels.
  int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * pixels_per_degree));
  auto gaussian = [&](double b) {
    return taps(radius, [&](double x) {
      double degrees = x / pixels_per_degree;
      return std::exp(-kPi * kPi * degrees * degrees / b);
    });
  };
  // Weights of both Gaussians over the plane, then each along one axis.
  std::vector<double> first = gaussian(s.b1), second = gaussian(s.b2);
  double weight1 = s.a1 * std::sqrt(kPi / s.b1) * sum(first) * sum(first);
  double weight2 = s.a2 * std::sqrt(kPi / s.b2) * sum(second) * sum(second);
  scale_to(&first, 1), scale_to(&second, 1);
  Plane out = convolve(channel, first, first);
  if (weight2 > 0) {
    Plane other = convolve(channel, second, second);
    for (std::size_t i = 0; i < out.values.size(); ++i)
      out.values[i] = (weight1 * out.values[i] + weight2 * other.values[i]) / (weight1 + weight2);
  }
  return out;
}

struct Seen {
  Plane lightness, red_green, blue_yellow;  // YCxCz
};
Seen ycxcz_of_srgb(const std::vector<float>& srgb, std::size_t width, std::size_t height) {
  Seen seen = {{width, height}, {width, height}, {width, height}};
  for (std::size_t i = 0; i < width * height; ++i) {
    auto linear = [&](std::size_t c) { return linear_of_srgb(std::min(std::max<double>(srgb[3 * i + c], 0), 1.0)); };
    Color c = ycxcz_of_linear({linear(0), linear(1), linear(2)});
    seen.lightness.values[i] = c.x, seen.red_green.values[i] = c.y, seen.blue_yellow.values[i] = c.z;
  }
  return seen;
}

// ---- The colour pipeline (sec. 4.1).

std::vector<Color> perceived(const Seen& picture, double pixels_per_degree) {
  Plane y = see(picture.lightness, kAchromatic, pixels_per_degree);
  Plane cx = see(picture.red_green, kRedGreen, pixels_per_degree);
  Plane cz = see(picture.blue_yellow, kBlueYellow, pixels_per_degree);
  std::vector<Color> result(y.values.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    Color linear = linear_of_ycxcz({y.values[i], cx.values[i], cz.values[i]});
    auto clamp = [](double v) { return std::min(std::max(v, 0.0), 1.0); };
    result[i] = hunt_lab_of_linear({clamp(linear.x), clamp(linear.y), clamp(linear.z)});
  }
  return result;
}

// Raises errors to the power q_c, with large ones compressed into the last 1 - p_t of the scale (eq. 7).
double color_error(const Color& a, const Color& b) {
  constexpr double qc = 0.7, pc = 0.4, pt = 0.95;
  static const double largest = std::pow(hyab(hunt_lab_of_linear({0, 1, 0}), hunt_lab_of_linear({0, 0, 1})), qc);
  double error = std::pow(hyab(a, b), qc), knee = pc * largest;
  return error < knee ? pt / knee * error : pt + (error - knee) / (largest - knee) * (1 - pt);
}

// ---- The feature pipeline (sec. 4.2): edges and points of the lightness.

struct Features {
  std::vector<double> edge, point;
};
Features find_features(const Plane& lightness, double pixels_per_degree) {
  constexpr double kFeatureWidth = 0.082;  // degrees
  double deviation = 0.5 * kFeatureWidth * pixels_per_degree;
  int radius = static_cast<int>(std::ceil(3 * deviation));
  auto gaussian = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
  std::vector<double> smooth = taps(radius, gaussian);
  scale_to(&smooth, 1);
  std::vector<double> first = taps(radius, [&](double x) { return -x * gaussian(x); });
  std::vector<double> second =
      taps(radius, [&](double x) { return (x * x / (deviation * deviation) - 1) * gaussian(x); });
  for (std::vector<double>* filter : {&first, &second}) {  // positive weights sum to 1 and negative ones to -1
    double positive = 0, negative = 0;
    for (double v : *filter) (v > 0 ? positive : negative) += std::fabs(v);
    for (double& v : *filter) v /= v > 0 ? positive : negative;
  }
  Plane normalized = lightness;
  for (double& v : normalized.values) v = (v + 16) / 116;
  auto magnitude = [&](const std::vector<double>& filter) {
    Plane x = convolve(normalized, filter, smooth), y = convolve(normalized, smooth, filter);
    std::vector<double> result(x.values.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = std::hypot(x.values[i], y.values[i]);
    return result;
  };
  return {magnitude(first), magnitude(second)};
}

}  // namespace

std::vector<float> flip_errors(const std::vector<float>& reference, const std::vector<float>& test, std::size_t width,
                               std::size_t height, double pixels_per_degree) {
  CHECK_EQ(reference.size(), 3 * width * height);
  CHECK_EQ(test.size(), 3 * width * height);
  CHECK(width > 0 && height > 0);
  CHECK_GT(pixels_per_degree, 0);
  Seen a = ycxcz_of_srgb(reference, width, height), b = ycxcz_of_srgb(test, width, height);
  std::vector<Color> color_a = perceived(a, pixels_per_degree), color_b = perceived(b, pixels_per_degree);
  Features feature_a = find_features(a.lightness, pixels_per_degree);
  Features feature_b = find_features(b.lightness, pixels_per_degree);
  std::vector<float> errors(width * height);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    // Eq. 10 with q_f = 1/2, and eq. 11.
    double difference =
        std::max(std::fabs(feature_a.edge[i] - feature_b.edge[i]), std::fabs(feature_a.point[i] - feature_b.point[i]));
    double feature = std::sqrt(difference / std::sqrt(2.0));
    errors[i] = static_cast<float>(std::pow(color_error(color_a[i], color_b[i]), 1 - feature));
  }
  return errors;
}

}  // namespace pocketray
