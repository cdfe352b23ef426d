// Mach bands that a reconstruction of radiosity shows on the walls of the built-in `cube`, as [Bastos92] figs. 6 and 7
// do: the whole light, direct light included, is stored at the corners of a few patches per wall.
#pragma once
#include <memory>
#include <vector>

#include "radiosity/solve.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"

namespace pocketray {

constexpr std::uint32_t kBandsWidth = 320, kBandsHeight = 240;

// What an eye makes of a picture along rows and columns, over the pixels of walls away from their edges; displayed
// values from 0 to 1.
struct Bands {
  double rmse;               // against the reference
  double second_difference;  // mean square
  // Of the response of lateral inhibition, less that to the reference: the difference of two Gaussians of 1 and 5
  // pixels [Rodieck 1965, "Quantitative analysis of cat retinal ganglion cell response to visual stimuli"].
  double rms, most;
  std::vector<double> response;  // less the reference's; one per pixel, rows and columns added; 0 where none counts
};

class BandsRig {
 public:
  BandsRig();
  // The walls' picture, with `cells` patches along each side of a wall.
  Picture render(int cells, Reconstruction reconstruction);
  Bands measure(const Picture& picture, const Picture& reference) const;

 private:
  std::unique_ptr<BuiltScene> cube_;
  std::vector<int> walls_;  // per pixel; −1: the lamp and its surroundings
  RadiositySolution solution_;
  int solved_cells_ = 0;

  struct Sums {
    double off, band, bend, most, count;
  };
  void measure_line(const Picture& picture, const Picture& reference, std::size_t at, std::size_t step,
                    std::size_t count, Sums* sums, std::vector<double>* response) const;
  std::unique_ptr<TestRenderer> renderer(int cells, Reconstruction reconstruction);
};

}  // namespace pocketray
