// The dial between speed and accuracy: five levels, each a point of a front.
#pragma once
#include "plan/front.h"

namespace pocketray {

enum class QualityLevel : std::uint8_t { draft, low, medium, high, best };
constexpr int kQualityLevelCount = 5;
constexpr const char* kQualityLevelNames[kQualityLevelCount] = {"draft", "low", "medium", "high", "best"};

// Returns whether the text, terminated, names a level.
bool find_quality_level(const char* name, QualityLevel* level);

// Point of a measured front: the most accurate whose time is at most the level's quarter of the way, by ratio, from the
// fastest point to the slowest. The front must not be empty; all its errors must be known.
Candidate level_of(const Front& front, QualityLevel level);

// Where nothing was measured: settings chosen from the fronts of tests/accuracy/FIGURES.md. `effects`: those of the
// plan with automatic indirect light. Medium is the default of every setting.
Quality builtin_level(QualityLevel level, EffectMask effects);

}  // namespace pocketray
