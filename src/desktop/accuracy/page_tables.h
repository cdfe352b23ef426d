// The tables of the page.
#pragma once
#include <string>

#include "desktop/accuracy/result.h"

namespace pocketray {

// A link to the configuration's row of the CSV file [RFC 7111, sec. 2.1].
std::string row_link(const Sweep& sweep, const Measured& m, const std::string& text);

// "ms per .01 FLIP" by knob, cheapest first.
std::string price_table(const Sweep& sweep);
// The settings of the front by that judge, numbered as in its plot.
std::string front_table(const Sweep& sweep, Judge judge);
// The front of each method of indirect light, as in its plot.
std::string method_table(const Sweep& sweep);
// All figures of one knob's values; for "several", those of the combined settings.
std::string value_table(const Sweep& sweep, const std::string& knob);

}  // namespace pocketray
