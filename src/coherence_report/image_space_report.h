// The image-space methods in the report: for people, as JSON, as CSV, as a table and as plots.
#pragma once
#include "accuracy/plot_script.h"
#include "coherence_report/report.h"

namespace pocketray {

// A way as ratios, "ours" included.
struct ErrorRow {
  std::string name;
  double pixels = 0, rays = 0, time = 0;  // to whole frames
  double wrong = 0, wrong_shown = 0;      // of the pixels
  double wrong_most = 0;                  // of the pixels of a frame
  double flip = 0, flip_max = 0;          // mean of all pixels; of any pixel
};
// First what the program does, then each way.
std::vector<ErrorRow> error_rows(const CoherenceReport& report);

void print_image_space(const CoherenceReport& report);
Json image_space_json(const CoherenceReport& report);
std::string image_space_csv(const CoherenceReport& report);
std::string image_space_table(const CoherenceReport& report);  // markup
constexpr char kImageSpaceText[] =
    "Badt traces a random sample of the pixels again and floods around those that changed. Chapman traces frames some "
    "way apart and halves the time between where a pixel differs. Both look only at pixels and miss changes; pocketray "
    "knows what moves, and misses none.";

// Wrong pixels over pixels traced; ꟻLIP over time.
Plot wrong_plot(const CoherenceReport& report);
Plot flip_plot(const CoherenceReport& report);

}  // namespace pocketray
