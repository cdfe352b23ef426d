// A sweep as one self-contained HTML page.
#pragma once
#include <map>
#include <string>

#include "desktop/accuracy/result.h"

namespace pocketray {

// Pictures of the page by name: strips by knob, plots by their own name. Missing ones are omitted.
struct PagePictures {
  std::string reference_png, truth_png;        // bytes
  std::map<std::string, std::string> quality;  // bytes of PNG, by level
  std::map<std::string, std::string> strips;   // bytes of PNG
  std::map<std::string, std::string> plots;    // text of SVG, as gnuplot writes it
};

// The page is also well-formed XML, and deterministic for a given sweep and pictures.
std::string page_of(const Sweep& sweep, const PagePictures& pictures);

}  // namespace pocketray
