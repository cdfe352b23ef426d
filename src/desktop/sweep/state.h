// Measurements of a sweep so far, kept in its folder so that the same command can continue.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desktop/accuracy/sum_up.h"
#include "session/report.h"

namespace pocketray {

struct AccuracyState {
  Json key;                                    // name → text: everything the figures depend on
  std::uint32_t rounds = 0;                    // finished
  std::string counted;                         // how instructions are counted, if not by the CPU; empty: by the CPU
  std::map<std::string, PointFigures> points;  // by knob and value; times of finished rounds only
  std::vector<std::string> references;         // names of finished pictures
};

// Creates the folder and reads its state, or starts a new one with the key. Unless `restart`, fails on an unreadable
// state or one with another key.
Status open_state(const std::string& folder, const Json& key, bool restart, AccuracyState* state);
// Replaces the state file atomically.
Status save_state(const std::string& folder, const AccuracyState& state);

// Replaces FOLDER/NAME atomically.
Status save_text(const std::string& folder, const std::string& name, const std::string& text);

}  // namespace pocketray
