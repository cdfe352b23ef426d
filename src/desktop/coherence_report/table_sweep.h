// Sweeps the side of the ray tables against memory, time and pixels traced. It has no row in setting_list.h: each of
// those settings trades accuracy for time, may differ from frame to frame within the planned memory, and is chosen by
// its error. The side changes the planned memory, and no picture. `accuracy` renders one moment repeatedly, for which
// no tables are kept; so the side is swept here, over a sequence.
#pragma once
#include "desktop/accuracy/plot_script.h"
#include "desktop/coherence_report/sequence_run.h"
#include "session/report.h"

namespace pocketray {

constexpr std::uint32_t kTableSides[] = {1, 2, 4, 8, 16, 32, 64, 128};

struct TableSide {
  std::uint32_t side = 0;
  std::size_t table_bytes = 0, coherence_bytes = 0;
  std::uint64_t pixels = 0;  // of all frames
  FrameFigures all;
};
struct TableSweep {
  bool papers_way = false;       // all rays in tables, because none of the scene's need them
  std::vector<TableSide> sides;  // empty: not requested
};

// Returns the figures of a finished sequence with tables of that side.
TableSide table_side(std::uint32_t side, const SequenceRun& run);

void print_table_sweep(const TableSweep& sweep);
Json table_sweep_json(const TableSweep& sweep);
std::string table_sweep_csv(const TableSweep& sweep);
std::string table_sweep_markup(const TableSweep& sweep);
std::string table_sweep_text(const TableSweep& sweep);  // the kind of rays in the tables
// Plots pixels traced, rays and CPU time over the side, with the memory of the tables.
Plot table_plot(const TableSweep& sweep);

}  // namespace pocketray
