#include "bench/duel_report.h"

#include <cstdio>

namespace pocketray {

void print_duel_header() {
  std::printf("million rays per second on one thread; ratio: ours/Embree, median (10th … 90th percentile)\n");
  std::printf("%-10s %-7s %-8s %-6s %-21s %8s %8s %7s %17s %9s\n", "scene", "rays", "size", "isa", "embree mode",
              "ours", "embree", "ratio", "spread", "differ %");
}

void print_duel_rows(const std::vector<DuelRow>& rows) {
  for (const DuelRow& r : rows)
    std::printf("%-10s %-7s %-8s %-6s %-21s %8.2f %8.2f %7.2f   (%5.2f … %5.2f) %9.4f\n", r.scene.c_str(),
                r.rays.c_str(), r.size.c_str(), r.isa.c_str(), r.embree_mode.c_str(), r.ours_mrays, r.embree_mrays,
                r.ratio, r.ratio_low, r.ratio_high, r.differing_share * 100);
  std::fflush(stdout);
}

nlohmann::ordered_json duel_json(const std::vector<DuelRow>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const DuelRow& r : rows)
    list.push_back({{"scene", r.scene},
                    {"rays", r.rays},
                    {"size", r.size},
                    {"isa", r.isa},
                    {"embree_mode", r.embree_mode},
                    {"ours_mrays", r.ours_mrays},
                    {"embree_mrays", r.embree_mrays},
                    {"ratio", r.ratio},
                    {"ratio_low", r.ratio_low},
                    {"ratio_high", r.ratio_high}});
  return list;
}

}  // namespace pocketray
