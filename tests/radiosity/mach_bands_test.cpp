#include "radiosity/mach_bands.h"

#include <doctest/doctest.h>

using namespace pocketray;

// Goal: with two patches along each side of a wall, bilinear reconstruction shows a cross on it, and Hermite patches do
// not [Bastos92] figs. 6 and 7; they are nearer to the light of many patches, too. Method: the response of lateral
// inhibition along scanlines, less that to the picture of 24 patches a side.
TEST_CASE("mach_bands_of_hermite_patches_are_weaker") {
  BandsRig rig;
  const Picture constant = rig.render(2, Reconstruction::constant), bilinear = rig.render(2, Reconstruction::bilinear),
                bicubic = rig.render(2, Reconstruction::bicubic), reference = rig.render(24, Reconstruction::bicubic);
  const Bands steps = rig.measure(constant, reference), cross = rig.measure(bilinear, reference),
              smooth = rig.measure(bicubic, reference);
  MESSAGE("bilinear and bicubic: response ", cross.rms, " and ", smooth.rms, ", RMSE ", cross.rmse, " and ",
          smooth.rmse);
  CHECK(smooth.second_difference < cross.second_difference / 8);
  CHECK(cross.second_difference < steps.second_difference / 8);
  CHECK((smooth.rms < cross.rms && cross.rms < steps.rms));
  CHECK((smooth.rmse < cross.rmse && cross.rmse < steps.rmse));
  CHECK(rig.measure(reference, reference).rms == 0);
}

// Goal: on the same walls by triangles, quadratic and cubic light shows weaker bands than linear light, and is nearer
// to that of many patches; and so it is with two triangles for each patch of a wall. Method: as above.
TEST_CASE("mach_bands_of_quadratics_and_cubics_are_weaker") {
  BandsRig rig;
  const Picture reference = rig.render(24, Reconstruction::bicubic);
  for (Pieces pieces : {Pieces::quads, Pieces::triangles}) {
    auto bands_of = [&](Reconstruction how) { return rig.measure(rig.render(2, how, pieces), reference); };
    const Bands linear = bands_of(Reconstruction::bilinear), quadratic = bands_of(Reconstruction::quadratic),
                cubic = bands_of(Reconstruction::cubic);
    CHECK(rig.value_count() > 0);
    for (const Bands* smooth : {&quadratic, &cubic}) {
      MESSAGE("response ", linear.rms, " and ", smooth->rms, ", RMSE ", linear.rmse, " and ", smooth->rmse);
      CHECK(smooth->second_difference < linear.second_difference / 4);
      CHECK(smooth->rms < linear.rms);
      CHECK(smooth->rmse < linear.rmse);
    }
  }
}
