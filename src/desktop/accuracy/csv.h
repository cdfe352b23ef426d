// CSV (RFC 4180, with line feeds).
#pragma once
#include <string>

#include "desktop/accuracy/result.h"

namespace pocketray {

// Text as a field, quoted if needed.
std::string csv_field(const std::string& text);

// A sweep: a header line, then one line per configuration, the baseline first. Missing measurements stay empty.
std::string sweep_csv(const Sweep& sweep);

}  // namespace pocketray
