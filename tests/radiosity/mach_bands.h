// Mach bands that a reconstruction of radiosity shows on the walls of the built-in `cube`, as [Bastos92] figs. 6 and 7
// do: the whole light, direct light included, is stored at the corners of a few patches per wall.
#pragma once
#include <memory>
#include <vector>

#include "scene/builtin_helpers.h"
#include "session/radiosity_solver.h"
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

enum class Pieces { quads, triangles };

class BandsRig {
 public:
  // `total`: direct light is stored, too, as [Bastos92] has it; otherwise pictures show indirect light alone.
  explicit BandsRig(bool total = true);
  // The walls' picture, with `cells` patches along each side of a wall; or with triangles, those halved at their
  // longest sides until these are the diagonals of such patches, or the sides of these.
  Picture render(int cells, Reconstruction reconstruction, Pieces pieces = Pieces::quads);
  // Of the last solution, on all walls.
  std::size_t value_count() const { return solution_.nodes.size() + solution_.values.size(); }
  Bands measure(const Picture& picture, const Picture& reference) const;

 private:
  bool total_;
  std::unique_ptr<BuiltScene> cube_;
  std::vector<int> walls_;  // per pixel; −1: the lamp and its surroundings
  RadiositySolution solution_;
  int solved_cells_ = 0;
  Pieces solved_pieces_ = Pieces::quads;

  struct Sums {
    double off, band, bend, most, count;
  };
  void measure_line(const Picture& picture, const Picture& reference, std::size_t at, std::size_t step,
                    std::size_t count, Sums* sums, std::vector<double>* response) const;
  void solve(const FrameData& frame, const RadiosityOptions& options, Pieces pieces);
  std::unique_ptr<TestRenderer> renderer(int cells, Reconstruction reconstruction, Pieces pieces);
};

}  // namespace pocketray
