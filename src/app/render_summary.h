// The printed summary of `pocketray render`.
#pragma once
#include "app/coherent_sequence.h"
#include "app/render_options.h"
#include "session/report.h"

namespace pocketray {

struct RenderSummary {
  const RenderOptions* options;
  const Renderer* renderer;
  PixelBox box;                                // the pixels that were traced and written
  const Servers* servers = nullptr;            // null: none
  const Budget* budget = nullptr;              // null: none
  const CoherentSequence* coherent = nullptr;  // null: frames were traced whole
  std::vector<std::string> files;              // written; not empty
  std::uint32_t frame_count = 0;
  double trace_ms = 0;   // over all frames
  std::string aov_line;  // explains the colours of an AOV; empty: none
};

void print_summary(const RenderSummary& summary);
Json to_json(const RenderSummary& summary);

}  // namespace pocketray
