// Reports the comparison as text and JSON.
#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/duel.h"

namespace pocketray {

void print_duel_header();
void print_duel_rows(const std::vector<DuelRow>& rows);
nlohmann::ordered_json duel_json(const std::vector<DuelRow>& rows);

}  // namespace pocketray
