// A sweep as one page of HTML that needs nothing else.
#pragma once
#include <map>
#include <string>

#include "accuracy/result.h"

namespace pocketray {

// What is shown on the page, each by a name: a strip by its knob's, a plot by its own. What is absent is not shown.
struct PagePictures {
  std::string reference_png;                  // bytes
  std::map<std::string, std::string> strips;  // bytes of PNG
  std::map<std::string, std::string> plots;   // text of SVG, as gnuplot writes it
};

// Well formed as XML, too. The same for the same sweep and pictures.
std::string page_of(const Sweep& sweep, const PagePictures& pictures);

}  // namespace pocketray
