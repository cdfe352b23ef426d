// Exchange of light between patches: form factors and progressive refinement.
#pragma once
#include "desktop/radiosity/rays.h"
#include "session/radiosity_solver.h"

namespace pocketray {

// Fᵢⱼ: the share of what patch i sees that is patch j. As light passes sheets from behind, for those who look at them
// so, AᵢFᵢⱼ is not AⱼFⱼᵢ across sheets.
struct FormFactors {
  std::uint32_t count = 0;
  std::vector<float> rows;  // count × count
  bool is_reciprocal = true;
  float at(std::uint32_t i, std::uint32_t j) const { return rows[std::size_t(i) * count + j]; }
};

// Analytic factors times the visible share by rays; made reciprocal but for sheets, and each row summing to the share
// of `closed[i]` of the hemisphere that surfaces fill. Empty if stopped.
FormFactors find_form_factors(const SceneRays& rays, const std::vector<Patch>& patches,
                              const std::vector<double>& closed, std::uint32_t threads, const SolverProgress& progress);

// Fᵢⱼ of one patch for every j, as found from i alone. `row_there`, unless null, receives Fⱼᵢ·Aⱼ/Aᵢ as found from i.
void find_factor_row(const SceneRays& rays, const std::vector<Patch>& patches, std::uint32_t i, float* row,
                     float* row_there);

// Light as radiance; energy as radiance × area, summed over the channels.
struct Exchange {
  std::vector<Vec3d> radiance;  // leaves a patch: emitted and reflected
  std::vector<Vec3d> unshot;    // the part not yet sent to the others; negative where too much was
  std::vector<Vec3d> albedo;
  std::vector<double> area;
  double emitted = 0, absorbed = 0, escaped = 0;
  std::uint32_t shots = 0;
};

// `emission` leaves the patches before any exchange.
Exchange start_exchange(const std::vector<double>& area, const std::vector<Vec3d>& albedo,
                        const std::vector<Vec3d>& emission);
double unshot_energy(const Exchange& exchange);  // signed: emitted = absorbed + escaped + unshot
double unshot_magnitude(const Exchange& exchange);
// Shoots from the patch with the most unshot energy [Cohen et al. 1988, sec. 3]. `overshoot`: and with it what it is
// expected to receive later, from the ambient estimate [Feda, Purgathofer 1992].
void shoot(const FormFactors& factors, bool overshoot, Exchange* exchange);
// Shoots until less than `share` of the emitted energy is unshot, or shots_max times; then adds the ambient term that
// stands for the rest [Cohen et al. 1988, sec. 3.3].
void settle(const FormFactors& factors, double share, std::uint32_t shots_max, Exchange* exchange);

}  // namespace pocketray
