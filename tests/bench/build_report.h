// Reports the cost of acceleration structures as text and JSON, and which of the project's targets are met.
#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/build_bench.h"
#include "bench/duel.h"

namespace pocketray {

void print_builds(const std::vector<BuildRow>& rows);
nlohmann::ordered_json builds_json(const std::vector<BuildRow>& rows);

// One line per target: its value, the result of each scene, whether all scenes meet it.
void print_verdicts(const std::vector<DuelRow>& duels, const std::vector<BuildRow>& builds);

}  // namespace pocketray
