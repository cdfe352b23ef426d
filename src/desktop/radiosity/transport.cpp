#include "desktop/radiosity/transport.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kClose = 0.4;  // of the distance up to which patches are near: they touch, or face each other

double sum_of(const Vec3d& v) { return v.x + v.y + v.z; }

// Returns the radiance that all unshot light would add everywhere if spread evenly, with all its reflections.
Vec3d ambient_estimate(const Exchange& e) {
  Vec3d unshot = {0, 0, 0}, reflected = {0, 0, 0}, result = {0, 0, 0};
  double area = 0;
  for (std::size_t i = 0; i < e.area.size(); ++i)
    unshot += e.unshot[i] * e.area[i], reflected += e.albedo[i] * e.area[i], area += e.area[i];
  for (int axis = 0; axis < 3; ++axis) result[axis] = std::max(0.0, unshot[axis] / (area - reflected[axis]));
  return result;
}

// Averages Aᵢ·Fᵢⱼ with Aⱼ·Fⱼᵢ, each found from points of its first patch, so that the smaller one's is the better; then
// a few rounds of scaling rows to their sums.
// `there`: Fⱼᵢ·Aⱼ/Aᵢ as found from i, at the place of Fᵢⱼ; empty if it is no other.
void make_consistent(const std::vector<Patch>& patches, const std::vector<double>& closed,
                     const std::vector<float>& there, FormFactors* f) {
  const std::uint32_t n = f->count;
  CHECK(there.empty() || there.size() == f->rows.size());
  const std::vector<float>& opposite = there.empty() ? f->rows : there;
  std::vector<double> scale(n);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < i; ++j) {
      const std::size_t ij = std::size_t(i) * n + j, ji = std::size_t(j) * n + i;
      const double a = patches[i].area, b = patches[j].area, own = b * b / (a * a + b * b);
      const double to_i =
                       own * static_cast<double>(f->rows[ij]) * a + (1 - own) * static_cast<double>(opposite[ji]) * b,
                   to_j =
                       own * static_cast<double>(opposite[ij]) * a + (1 - own) * static_cast<double>(f->rows[ji]) * b;
      f->rows[ij] = static_cast<float>(to_i), f->rows[ji] = static_cast<float>(to_j);
    }
  std::vector<double> wanted(n);
  for (int round = 0; round < 24; ++round) {
    for (std::uint32_t i = 0; i < n; ++i) {
      double sum = 0;
      for (std::uint32_t j = 0; j < n; ++j) sum += static_cast<double>(f->at(i, j));
      if (round == 0) wanted[i] = credible_sum(sum / patches[i].area, closed[i], kPatchSamples * kPatchRays);
      scale[i] = sum > 0 ? std::sqrt(wanted[i] * patches[i].area / sum) : 0;
    }
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < n; ++j) f->rows[std::size_t(i) * n + j] *= static_cast<float>(scale[i] * scale[j]);
  }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) f->rows[std::size_t(i) * n + j] /= static_cast<float>(patches[i].area);
}

}  // namespace

void find_factor_row(const SceneRays& rays, const std::vector<Patch>& patches, std::uint32_t i, float* row,
                     float* row_there) {
  CHECK(i < patches.size() && row != nullptr);
  const Backs backs = rays.has_sheets ? Backs::of_bodies_hide : Backs::hide;
  for (std::uint32_t j = 0; j < patches.size(); ++j) {
    if (i == j) continue;
    const Vec3d way = patches[j].centre - patches[i].centre;
    const double near = 3 * (patches[i].radius + patches[j].radius);
    const bool is_near = dot(way, way) < near * near, is_close = dot(way, way) < kClose * kClose * near * near;
    double sum = 0, sum_there = 0;
    int samples = 0;
    const int count = is_close ? static_cast<int>(patches[i].light_samples.size()) : kPatchSamples;
    for (int k = 0; k < count; k += is_near ? 1 : 2) {
      const PatchSample& at = is_close ? patches[i].light_samples[static_cast<std::size_t>(k)] : patches[i].samples[k];
      const Receiver from = {at.point, at.normal, patches[i].lift};
      const double factor = patch_form_factor(at.point, at.normal, patches[j]);
      ++samples;
      if (!(factor > 0)) continue;
      const VisibleShare share =
          visible_share(rays, from, patches[j], factor, i + j + static_cast<std::uint32_t>(k), backs);
      sum += factor * share.here, sum_there += factor * share.there;
    }
    row[j] = static_cast<float>(sum / samples);
    if (row_there) row_there[j] = static_cast<float>(sum_there / samples);
  }
}

FormFactors find_form_factors(const SceneRays& rays, const std::vector<Patch>& patches,
                              const std::vector<double>& closed, std::uint32_t threads,
                              const SolverProgress& progress) {
  CHECK_EQ(patches.size(), closed.size());
  FormFactors f;
  f.count = static_cast<std::uint32_t>(patches.size());
  f.rows.assign(std::size_t(f.count) * f.count, 0);
  std::vector<float> there(rays.has_sheets ? f.rows.size() : 0);
  f.is_reciprocal = there.empty();
  std::atomic<std::uint32_t> done{0};
  std::atomic<bool> stop{false};
  parallel_for(f.count, threads, [&](std::uint32_t i) {
    if (stop) return;
    const std::size_t row = std::size_t(i) * f.count;
    find_factor_row(rays, patches, i, &f.rows[row], there.empty() ? nullptr : &there[row]);
    if (!progress(static_cast<double>(++done) / f.count)) stop = true;
  });
  if (stop) return {};
  make_consistent(patches, closed, there, &f);
  return f;
}

Exchange start_exchange(const std::vector<double>& area, const std::vector<Vec3d>& albedo,
                        const std::vector<Vec3d>& emission) {
  CHECK(area.size() == albedo.size() && area.size() == emission.size());
  Exchange e;
  e.area = area, e.albedo = albedo, e.radiance = e.unshot = emission;
  for (std::size_t i = 0; i < area.size(); ++i) e.emitted += sum_of(emission[i]) * area[i];
  return e;
}

double unshot_energy(const Exchange& e) {
  double sum = 0;
  for (std::size_t i = 0; i < e.area.size(); ++i) sum += sum_of(e.unshot[i]) * e.area[i];
  return sum;
}

double unshot_magnitude(const Exchange& e) {
  double sum = 0;
  for (std::size_t i = 0; i < e.area.size(); ++i)
    sum += (std::fabs(e.unshot[i].x) + std::fabs(e.unshot[i].y) + std::fabs(e.unshot[i].z)) * e.area[i];
  return sum;
}

void shoot(const FormFactors& factors, bool overshoot, Exchange* e) {
  CHECK_EQ(factors.count, e->area.size());
  std::uint32_t brightest = 0;
  double most = -1;
  for (std::uint32_t i = 0; i < factors.count; ++i) {
    const Vec3d& u = e->unshot[i];
    const double energy = (std::fabs(u.x) + std::fabs(u.y) + std::fabs(u.z)) * e->area[i];
    if (energy > most) most = energy, brightest = i;
  }
  // Light sent too early is only taken back.
  const Vec3d early =
      overshoot && sum_of(e->unshot[brightest]) > 0 ? e->albedo[brightest] * ambient_estimate(*e) : Vec3d{0, 0, 0};
  const Vec3d sent = e->unshot[brightest] + early;
  e->unshot[brightest] = -early;
  double arrived = 0;
  for (std::uint32_t j = 0; j < factors.count; ++j) {
    const double share = factors.is_reciprocal
                             ? static_cast<double>(factors.at(brightest, j))
                             : static_cast<double>(factors.at(j, brightest)) * e->area[j] / e->area[brightest];
    if (!(share > 0)) continue;
    const Vec3d received = sent * (share * e->area[brightest] / e->area[j]);  // what j sees of it
    const Vec3d reflected = e->albedo[j] * received;
    e->radiance[j] += reflected, e->unshot[j] += reflected;
    e->absorbed += sum_of(received - reflected) * e->area[j];
    arrived += share;
  }
  e->escaped += sum_of(sent) * e->area[brightest] * (1 - arrived);
  ++e->shots;
}

void settle(const FormFactors& factors, double share, std::uint32_t shots_max, Exchange* e) {
  double left = unshot_magnitude(*e);
  // Overshooting pays while much is left; near the end it would only move light to and fro.
  while (e->shots < shots_max && left > share * e->emitted) {
    shoot(factors, left > 0.05 * e->emitted, e);
    left = unshot_magnitude(*e);
  }
  const Vec3d ambient = ambient_estimate(*e);
  for (std::size_t i = 0; i < e->area.size(); ++i) e->radiance[i] += e->albedo[i] * ambient;
}

}  // namespace pocketray
