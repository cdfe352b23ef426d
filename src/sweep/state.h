// The measurements of a sweep so far, kept in its folder so that the same command can continue.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "accuracy/sweep_plan.h"
#include "base/vec3.h"
#include "session/report.h"

namespace pocketray {

struct AccuracyState {
  Json key;                                    // name → text: everything the figures depend on
  std::uint32_t rounds = 0;                    // finished
  std::string counted;                         // how instructions are counted if not by the CPU; empty: by the CPU
  std::map<std::string, PointFigures> points;  // by knob and value; only times of finished rounds
  std::vector<std::string> references;         // names of finished pictures
  std::string begun, begun_rows;               // the unfinished picture; '1' for each of its rows in the file, else '0'
};

// Creates the folder and reads its state, or starts one with the key. Unless `restart`, fails on an unreadable state or
// one with another key.
Status open_state(const std::string& folder, const Json& key, bool restart, AccuracyState* state);
// Replaces the state file atomically.
Status save_state(const std::string& folder, const AccuracyState& state);

// Saves or loads FOLDER/NAME.pfm: linear radiance, width × height, row 0 on top.
Status save_radiance(const std::string& folder, const std::string& name, std::uint32_t width, std::uint32_t height,
                     const std::vector<Vec3>& radiance);
Status load_radiance(const std::string& folder, const std::string& name, std::uint32_t width, std::uint32_t height,
                     std::vector<Vec3>* radiance);

// Replaces FOLDER/NAME atomically.
Status save_text(const std::string& folder, const std::string& name, const std::string& text);

}  // namespace pocketray
