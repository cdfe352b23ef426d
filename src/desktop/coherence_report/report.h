// A coherence report: for people, as JSON and as CSV.
#pragma once
#include <string>

#include "desktop/coherence_report/image_space_run.h"
#include "desktop/coherence_report/table_sweep.h"

namespace pocketray {

struct CoherenceReport {
  std::string scene, machine;  // "seesaw"; "2 threads, avx512"
  Settings settings;
  bool is_papers_scene = false;
  SequenceRun ours;
  SequenceRun papers_way;     // no frames: not rendered
  ImageSpaceRun image_space;  // no frames: not requested
  TableSweep tables;
};

// [Jevans92, table 2]: ratios of the coherence algorithm to the traditional one.
struct PaperRatio {
  std::uint32_t frame;
  double rays, time;
};
constexpr PaperRatio kPaperRatios[] = {{0, 1, 1.171},         {1, 0.3984, 0.6248},   {75, 0.4765, 0.7719},
                                       {150, 0.1914, 0.3220}, {200, 0.0312, 0.0694}, {350, 0.0273, 0.0656}};
constexpr PaperRatio kPaperEntire = {351, 0.1935, 0.2672};  // of 351 frames

// A row of the table: a frame of kTableFrames, or the entire sequence.
struct TableRow {
  std::string name;  // "75"
  FrameFigures figures;
  std::uint64_t pixels = 0;           // total of the frames
  const PaperRatio* paper = nullptr;  // null: not the paper's scene, or not its sequence
};
std::vector<TableRow> table_rows(const SequenceRun& run, bool is_papers_scene);

// Describes the paper's way and how it is compared.
std::string papers_way_text(const Settings& settings);
constexpr char kPaperText[] =
    "Jevans 1992, Table 2: its sequence at 640 x 480 on its machine. It counts a ray for each pixel traced, so compare "
    "its rays with the pixels.";

// "frame 0: there is no last frame"; one line for each run of frames with a common reason.
std::vector<std::string> whole_frames(const SequenceRun& run);

void print_report(const CoherenceReport& report);
Json report_json(const CoherenceReport& report);
// A header line, then one line per frame.
std::string frames_csv(const SequenceRun& run);

}  // namespace pocketray
