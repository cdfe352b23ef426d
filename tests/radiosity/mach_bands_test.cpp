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
