// A sweep as a table of commas.
#pragma once
#include <string>

#include "accuracy/result.h"

namespace pocketray {

// A line of names, then one for each configuration, the baseline first. What was not measured stays empty. RFC 4180,
// with line feeds.
std::string sweep_csv(const Sweep& sweep);

}  // namespace pocketray
