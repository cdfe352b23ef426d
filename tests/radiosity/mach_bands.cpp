#include "radiosity/mach_bands.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "desktop/radiosity/store_light.h"

namespace pocketray {
namespace {

constexpr double kWallSide = 2;  // of the cube
constexpr int kMargin = 15;      // pixels at a wall's edges that do not count: three times the wider Gaussian

Settings settings_of(Reconstruction reconstruction) {
  Settings settings;
  settings.width = kBandsWidth, settings.height = kBandsHeight, settings.reconstruction = reconstruction;
  settings.forced_off = bit(Effect::area_light) | bit(Effect::shadow);  // stored
  return settings;
}

// The wall that a pixel shows, in closed form: the cube spans [−1, 1]³.
int wall_at(const CameraRays& camera, std::uint32_t x, std::uint32_t y) {
  const float right = 2 * (static_cast<float>(x) + 0.5f) / static_cast<float>(kBandsWidth) - 1;
  const float up = 1 - 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(kBandsHeight);
  const Vec3 d = camera.forward + camera.right * right + camera.up * up;
  int wall = -1;
  float least = 1e30f;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0) continue;
    const float t = ((d[axis] > 0 ? 1.0f : -1.0f) - camera.eye[axis]) / d[axis];
    if (t < least) least = t, wall = 2 * axis + (d[axis] > 0);
  }
  const Vec3 p = camera.eye + d * least;
  const bool is_lamp = wall == 3 && std::fabs(p.x) < 0.5f && std::fabs(p.z + 0.3f) < 0.5f;
  return is_lamp ? -1 : wall;
}

// sRGB without the steps of levels.
double displayed(const Vec3& light) {
  const double y = static_cast<double>(std::min(1.0f, 0.2126f * light.x + 0.7152f * light.y + 0.0722f * light.z));
  return y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055;
}

// The difference of two Gaussians over the pixels of a run, each of weight 1 in all.
std::vector<double> lateral_inhibition(const std::vector<double>& run) {
  auto smoothed = [&](double sigma, int at) {
    double sum = 0, weights = 0;
    const int count = static_cast<int>(run.size()), reach = static_cast<int>(3 * sigma);
    for (int i = std::max(0, at - reach); i < std::min(count, at + reach + 1); ++i) {
      const double weight = std::exp(-0.5 * (i - at) * (i - at) / (sigma * sigma));
      sum += weight * run[static_cast<std::size_t>(i)], weights += weight;
    }
    return sum / weights;
  };
  std::vector<double> response;
  for (int i = 0; i < static_cast<int>(run.size()); ++i) response.push_back(smoothed(1, i) - smoothed(5, i));
  return response;
}

// Returns the surfaces with every one stored by its triangles.
Surfaces without_grids(Surfaces surfaces) {
  surfaces.flat.clear(), surfaces.others.clear();
  for (std::uint32_t t = 0; t < surfaces.area.size(); ++t)
    if (surfaces.area[t] > 0) surfaces.others.push_back(t);
  return surfaces;
}

}  // namespace

BandsRig::BandsRig(bool total) : total_(total), cube_(build_builtin("cube")) {
  cube_->scene.info.ambient = {0, 0, 0};
  auto test = make_renderer(cube_->scene, settings_of(Reconstruction::bicubic));
  REQUIRE(begin_frame(&test->renderer, {0}).ok);
  for (std::uint32_t y = 0; y < kBandsHeight; ++y)
    for (std::uint32_t x = 0; x < kBandsWidth; ++x) walls_.push_back(wall_at(test->renderer.frame.view.camera, x, y));
}

// As solve_radiosity(), but with direct light if `total_`, and at the corners of triangles if these are wanted.
void BandsRig::solve(const FrameData& frame, const RadiosityOptions& options, Pieces pieces) {
  solution_ = RadiositySolution();
  const SolverProgress go_on = [](double) { return true; };
  PatchSolution solved(frame);
  Status status = divide_surfaces(options, &solved);
  if (status.ok) status = exchange_light(options, go_on, &solved);
  REQUIRE_MESSAGE(status.ok, status.message);
  PatchLight light = light_of(solved);
  if (total_) light.reflected = light.all;
  const LightAt light_at = [&](const Receiver& at, std::uint32_t material, bool on_grid, std::uint32_t seed) {
    const Vec3d gathered = gather(solved.rays, light, at, material, on_grid, seed);
    return total_ && gathered.x >= 0 ? gathered + light_irradiance(solved.rays, at) * (1 / kPi) : gathered;
  };
  const Surfaces surfaces = pieces == Pieces::triangles ? without_grids(solved.surfaces) : solved.surfaces;
  status = store_light(solved, surfaces, options, light_at, go_on, &solution_);
  REQUIRE_MESSAGE(status.ok, status.message);
}

std::unique_ptr<TestRenderer> BandsRig::renderer(int cells, Reconstruction reconstruction, Pieces pieces) {
  if (solved_cells_ != cells || solved_pieces_ != pieces) {
    Settings settings;
    settings.width = settings.height = 1, settings.indirect = IndirectChoice::none;
    auto test = make_renderer(cube_->scene, settings);
    REQUIRE(begin_frame(&test->renderer, {0}).ok);
    RadiosityOptions options;
    options.threads = 2;
    // Cells are as wide as patches, over this. Longest edges of triangles are at most two cells: chosen so that these
    // are between √2 and 2 of the sides wanted.
    const double sides = pieces == Pieces::triangles ? 1.2 * cells : cells;
    options.nodes_per_patch = sides * std::sqrt(24.0 / options.patch_count) / kWallSide;
    solve(test->renderer.frame, options, pieces);
    solved_cells_ = cells, solved_pieces_ = pieces;
  }
  Scene scene = cube_->scene;
  solution_.view(&scene);
  return make_renderer(scene, settings_of(reconstruction));
}

Picture BandsRig::render(int cells, Reconstruction reconstruction, Pieces pieces) {
  auto test = renderer(cells, reconstruction, pieces);
  REQUIRE(has(test->renderer.effects.mask, Effect::radiosity));
  REQUIRE(render_frame(&test->renderer, 0).ok);
  const Array<Vec3>& image = test->renderer.image;
  return Picture(image.begin(), image.end());
}

// Adds what is seen along a line of pixels, `step` apart from `at`.
void BandsRig::measure_line(const Picture& picture, const Picture& reference, std::size_t at, std::size_t step,
                            std::size_t count, Sums* sums, std::vector<double>* response) const {
  for (std::size_t begin = 0, end; begin < count; begin = end) {
    const int wall = walls_[at + begin * step];
    for (end = begin + 1; end < count && walls_[at + end * step] == wall;) ++end;
    if (wall < 0 || end - begin <= 2 * kMargin) continue;
    std::vector<double> run, wanted;
    for (std::size_t i = begin; i < end; ++i)
      run.push_back(displayed(picture[at + i * step])), wanted.push_back(displayed(reference[at + i * step]));
    const std::vector<double> seen = lateral_inhibition(run), meant = lateral_inhibition(wanted);
    for (std::size_t i = kMargin; i + kMargin < run.size(); ++i) {
      const double off = run[i] - wanted[i], band = seen[i] - meant[i], bend = run[i - 1] - 2 * run[i] + run[i + 1];
      (*response)[at + (begin + i) * step] += band;
      sums->off += off * off, sums->band += band * band, sums->bend += bend * bend, ++sums->count;
      sums->most = std::max(sums->most, std::fabs(band));
    }
  }
}

Bands BandsRig::measure(const Picture& picture, const Picture& reference) const {
  Sums sums = {};
  std::vector<double> response(walls_.size());
  for (std::size_t y = 0; y < kBandsHeight; ++y)
    measure_line(picture, reference, y * kBandsWidth, 1, kBandsWidth, &sums, &response);
  for (std::size_t x = 0; x < kBandsWidth; ++x)
    measure_line(picture, reference, x, kBandsWidth, kBandsHeight, &sums, &response);
  return {std::sqrt(sums.off / sums.count), sums.bend / sums.count, std::sqrt(sums.band / sums.count), sums.most,
          response};
}

}  // namespace pocketray
