// The image-space methods in the report: for people, as JSON, as CSV, as a table and as plots.
#pragma once
#include "desktop/accuracy/plot_script.h"
#include "desktop/coherence_report/report.h"

namespace pocketray {

// A variant as ratios, "ours" included.
struct ErrorRow {
  std::string name;
  double pixels = 0, rays = 0, time = 0;  // relative to whole frames
  double wrong = 0, wrong_shown = 0;      // fraction of the pixels
  double wrong_most = 0;                  // fraction of a frame's pixels
  double flip = 0, flip_max = 0;          // mean over all pixels; maximum of any pixel
};
// First what the program does, then each variant.
std::vector<ErrorRow> error_rows(const CoherenceReport& report);

void print_image_space(const CoherenceReport& report);
Json image_space_json(const CoherenceReport& report);
std::string image_space_csv(const CoherenceReport& report);
std::string image_space_table(const CoherenceReport& report);  // markup
constexpr char kImageSpaceText[] =
    "Badt retraces a random sample of the pixels and floods around those that changed. Chapman traces frames some "
    "distance apart and halves the time between them where a pixel differs. Both look only at pixels and miss changes; "
    "pocketray knows what moves, and misses none.";

// Plots wrong pixels over pixels traced; ꟻLIP over time.
Plot wrong_plot(const CoherenceReport& report);
Plot flip_plot(const CoherenceReport& report);

}  // namespace pocketray
