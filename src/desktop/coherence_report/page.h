// The report's folder: a self-contained page, its plots and pictures, and the figures as files.
#pragma once
#include "desktop/coherence_report/report.h"

namespace pocketray {

// Writes index.html, report.json and frames.csv, with the paper's way also frames_papers_way.csv; rays.png, time.png
// and their gnuplot scripts; retraced-NNNN.png for the frames of the paper's figure. *drawn: whether gnuplot drew the
// plots. With the image-space methods also image_space.csv, wrong.png and flip.png; with table sides tables.csv and
// tables.png.
Status write_coherence_report(const std::string& folder, const CoherenceReport& report, bool* drawn);

}  // namespace pocketray
