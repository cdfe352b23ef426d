// What structures cost, for people and for programs, and which figures that the project set itself are reached.
#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/build_bench.h"
#include "bench/duel.h"

namespace pocketray {

void print_builds(const std::vector<BuildRow>& rows);
nlohmann::ordered_json builds_json(const std::vector<BuildRow>& rows);

// One line a target: what is wanted, what each scene gives, whether all scenes reach it.
void print_verdicts(const std::vector<DuelRow>& duels, const std::vector<BuildRow>& builds);

}  // namespace pocketray
