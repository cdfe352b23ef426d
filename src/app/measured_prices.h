// Measured prices of options, for their help: figures of tests/accuracy/FIGURES.md, in its words.
#pragma once
#include <string>

namespace pocketray {

// Returns the price of an option, "--samples", or an empty text.
std::string measured_price(const std::string& option);

}  // namespace pocketray
