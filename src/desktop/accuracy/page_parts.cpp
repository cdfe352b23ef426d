#include "desktop/accuracy/page_parts.h"

#include "desktop/accuracy/page_style.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

void replace_all(std::string* text, const std::string& from, const std::string& to) {
  for (std::size_t at = text->find(from); at != std::string::npos; at = text->find(from, at + to.size()))
    text->replace(at, from.size(), to);
}

// Turns gnuplot's SVG into an element of the page: drops the file header and makes ids unique.
std::string inline_svg(const std::string& name, const std::string& file) {
  std::size_t begin = file.find("<svg");
  if (begin == std::string::npos) return "";
  std::string svg = file.substr(begin);
  std::string prefix = file_word(name) + "_";
  for (const char* mark : {"id=\"", "id='", "href='#", "href=\"#", "url(#"}) replace_all(&svg, mark, mark + prefix);
  std::size_t title = svg.find("<title>"), title_end = svg.find("</title>");
  if (title != std::string::npos && title_end != std::string::npos)
    svg.replace(title, title_end - title, "<title>" + escaped(name));
  return svg;
}

}  // namespace

std::string page_begin(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n<title>" +
         title + "</title>\n<style>" + kPageStyle + "</style>\n</head>\n<body>\n";
}

std::string svg_figure(const std::string& name, const std::string& svg) {
  std::string element = inline_svg(name, svg);
  return element.empty() ? "" : "<figure class=\"plot\">" + element + "</figure>\n";
}

std::string pair(const std::string& one, const std::string& other) {
  return "<div class=\"pair\">\n" + one + other + "</div>\n";
}

std::string image(const std::string& png, const std::string& alternative) {
  return "<img alt=\"" + escaped(alternative) + "\" src=\"data:image/png;base64," + base64(png) + "\" />";
}

}  // namespace pocketray
