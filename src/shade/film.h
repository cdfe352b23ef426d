// The thin film over a surface (Effect::iridescence); brdf/iridescence.h has its optics. It replaces the reflectance of
// the glossy lobe and the mirror; a dielectric boundary asks for the reflectance at its own angle.
#pragma once
#include "brdf/iridescence.h"
#include "shade/surface.h"

namespace pocketray {

// Sets Surface::film. `m` has the lobes at the point without it.
void find_film(const FrameData& frame, const Ray& ray, const Material& m, Surface* s);

// Gives the lobes at the surface the film's reflectance.
void put_film_on(const Surface& s, Material* m);

// Reflectance of a boundary under the film: `reflectance` without it, at a cosine in the thinner medium.
Vec3 film_at_boundary(const SurfaceFilm& film, float ior, float reflectance, float cosine);

}  // namespace pocketray
