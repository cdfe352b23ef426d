// A sweep as CSV.
#pragma once
#include <string>

#include "accuracy/result.h"

namespace pocketray {

// A header line, then one line per configuration, the baseline first. Missing measurements stay empty. RFC 4180, with
// line feeds.
std::string sweep_csv(const Sweep& sweep);

}  // namespace pocketray
