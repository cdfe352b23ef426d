#include "desktop/accuracy/report.h"

#include <cstdio>

#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/page.h"
#include "desktop/accuracy/plot.h"
#include "desktop/accuracy/strip.h"
#include "desktop/accuracy/text.h"
#include "present/png_file.h"

namespace pocketray {
namespace {

std::string read_file(const std::string& path) {
  std::string bytes;
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) return bytes;
  char part[4096];
  for (std::size_t count; (count = std::fread(part, 1, sizeof part, file)) > 0;) bytes.append(part, count);
  std::fclose(file);
  return bytes;
}

// The picture that the strip's knob is judged by.
const Levels& reference_of(const Sweep& sweep, const Strip& strip) {
  for (const KnobFigures& knob : sweep.knobs)
    if (knob.name == strip.knob && knob.judge == Judge::truth) return sweep.truth_picture;
  return sweep.reference_picture;
}

Status write_strips(const std::string& folder, const Sweep& sweep, const WriteFile& write, PagePictures* pictures) {
  if (!sweep.reference_picture.rgb.empty())
    RETURN_IF_ERROR(encode_png(sweep.reference_picture, &pictures->reference_png));
  if (!sweep.truth_picture.rgb.empty()) RETURN_IF_ERROR(encode_png(sweep.truth_picture, &pictures->truth_png));
  for (const LevelPicture& level : sweep.quality)
    RETURN_IF_ERROR(encode_png(level.picture, &pictures->quality[level.level]));
  for (const Strip& strip : sweep.strips) {
    std::string* png = &pictures->strips[strip.knob];
    RETURN_IF_ERROR(encode_png(draw_strip(reference_of(sweep, strip), strip), png));
    RETURN_IF_ERROR(write(folder + "/strip_" + file_word(strip.knob) + ".png", *png));
  }
  return success();
}

}  // namespace

Status draw_plots(const std::string& folder, const std::vector<Plot>& plots, const WriteFile& write,
                  const DrawScripts& draw, std::map<std::string, std::string>* svgs, bool* drawn) {
  std::vector<std::string> scripts;
  for (const Plot& plot : plots) {
    scripts.push_back(plot.name + ".gnuplot");
    RETURN_IF_ERROR(write(folder + "/" + scripts.back(), plot.script));
  }
  *drawn = draw(folder, scripts);
  if (*drawn)
    for (const Plot& plot : plots) (*svgs)[plot.name] = read_file(folder + "/" + plot.name + ".svg");
  return success();
}

Status write_report(const std::string& folder, const Sweep& sweep, const WriteFile& write, const DrawScripts& draw,
                    bool* drawn) {
  *drawn = false;
  PagePictures pictures;
  RETURN_IF_ERROR(write_strips(folder, sweep, write, &pictures));
  std::vector<Plot> plots = {front_plot(sweep, sweep.judge), price_plot(sweep)};
  const Judge other = other_than(sweep.judge);
  if (has_judged(sweep, other)) plots.push_back(front_plot(sweep, other));
  if (methods_of(sweep).size() > 1) plots.push_back(method_plot(sweep));
  for (const KnobFigures& knob : sweep.knobs) plots.push_back(knob_plot(sweep, knob));
  RETURN_IF_ERROR(draw_plots(folder, plots, write, draw, &pictures.plots, drawn));
  return write(folder + "/index.html", page_of(sweep, pictures));
}

}  // namespace pocketray
