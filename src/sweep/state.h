// What a sweep has measured so far, kept in its folder so that the same command goes on where it was stopped.
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
  Json key;                                    // name → text: everything that the figures depend on
  std::uint32_t rounds = 0;                    // that are whole
  std::string counted;                         // how instructions are counted where the CPU does not; empty: it does
  std::map<std::string, PointFigures> points;  // by knob and value; times of whole rounds alone
  std::vector<std::string> references;         // pictures that are whole, by name
  std::string begun, begun_rows;               // one that is not; of its rows '1' for those in its file, else '0'
};

// Makes the folder and reads its state, or starts one with the key. Refuses, unless `restart`, a state with another key
// and one that cannot be read; the message says how to mend it.
Status open_state(const std::string& folder, const Json& key, bool restart, AccuracyState* state);
// Replaces the state in the folder as a whole.
Status save_state(const std::string& folder, const AccuracyState& state);

// A picture of the folder: linear radiance, width × height, row 0 on top, as FOLDER/NAME.pfm.
Status save_radiance(const std::string& folder, const std::string& name, std::uint32_t width, std::uint32_t height,
                     const std::vector<Vec3>& radiance);
Status load_radiance(const std::string& folder, const std::string& name, std::uint32_t width, std::uint32_t height,
                     std::vector<Vec3>* radiance);

// Replaces a file of the folder by text.
Status save_text(const std::string& folder, const std::string& name, const std::string& text);

}  // namespace pocketray
