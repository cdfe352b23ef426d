// Parts of pages: the frame, plots, pictures.
#pragma once
#include <string>

namespace pocketray {

// Everything before the body's first element, and after its last. `title` is markup.
std::string page_begin(const std::string& title);
constexpr char kPageEnd[] = "</body>\n</html>\n";

// gnuplot's SVG as part of the page; `name` must be unique in it. Empty if `svg` is not SVG.
std::string svg_figure(const std::string& name, const std::string& svg);
// A PNG file's bytes as part of the page.
std::string image(const std::string& png, const std::string& alternative);
// Side by side if there is room.
std::string pair(const std::string& one, const std::string& other);

}  // namespace pocketray
