// pocketray compare: measures how different two pictures look.
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/accuracy/accuracy_command.h"
#include "app/accuracy/compare.h"
#include "app/options.h"
#include "desktop/accuracy/flip.h"
#include "desktop/accuracy/strip.h"
#include "session/output.h"
#include "session/report.h"
#include "session/scene_options.h"

namespace pocketray {
namespace {

struct CompareOptions {
  std::string reference, test, map, json, exposure, tone;
  bool align = false;
  double fail_above = 1;  // no ꟻLIP exceeds this
  double pixels_per_degree = kHandheldPixelsPerDegree;
};

Status read_development(const CompareOptions& o, const AnyPicture& reference, const AnyPicture& test,
                        Development* development) {
  ExposureChoice choice;
  float factor;
  RETURN_IF_ERROR(parse_exposure(o.exposure, &choice, &factor));
  const bool are_levels = !reference.is_linear && !test.is_linear, are_linear = reference.is_linear && test.is_linear;
  if (are_levels && (o.align || !o.exposure.empty() || !o.tone.empty()))
    return failure("%s changes linear light, and neither picture has any: compare a .pfm or .exr, or drop it",
                   o.align               ? "--align"
                   : !o.exposure.empty() ? "--exposure"
                                         : "--tone");
  if (!are_linear && o.align && !o.exposure.empty())
    return failure("--align finds the exposure of the linear picture: drop --exposure");
  development->measured = choice == ExposureChoice::measured;
  development->exposure = static_cast<double>(factor);
  development->aligned = o.align;
  if (!o.tone.empty()) development->tone = tone_named(o.tone.c_str());
  return success();
}

Status read_pictures(const CompareOptions& o, AnyPicture* reference, AnyPicture* test) {
  if (!o.map.empty() && !has_suffix(o.map.c_str(), ".png"))
    return failure("--map is '%.300s': the name must end in .png", o.map.c_str());
  RETURN_IF_ERROR(check_outputs({{"A", o.reference}, {"B", o.test}}, {{"--map", o.map}, {"--json", o.json}}));
  RETURN_IF_ERROR(read_picture(o.reference, reference));
  RETURN_IF_ERROR(read_picture(o.test, test));
  if (reference->width() == test->width() && reference->height() == test->height()) return success();
  return failure("%.180s has %u×%u pixels, %.180s %u×%u: compare pictures of one size", o.reference.c_str(),
                 reference->width(), reference->height(), o.test.c_str(), test->width(), test->height());
}

Status write_map(const std::string& path, const AnyPicture& reference, const Comparison& c) {
  Levels map = {reference.width(), reference.height(), {}};
  for (float error : c.flip_map)
    for (std::uint8_t level : flip_color(error)) map.rgb.push_back(level);
  std::string bytes;
  RETURN_IF_ERROR(encode_png(map, &bytes));
  return write_file(path, bytes);
}

int largest_level_difference(const Comparison& c) { return static_cast<int>(std::lround(255 * c.errors.max)); }

void print_light(const CompareOptions& o, const Comparison& c) {
  if (c.are_linear && o.align) std::printf("aligned: B × %.6g (%+.3f stops)\n", c.scale, std::log2(c.scale));
  if (c.are_linear)
    std::printf("linear light: RMSE %.6g, relative MSE %.6g, bias %+.6g, largest difference %.6g\n", c.light.rmse,
                c.light.rel_mse, c.light.bias, c.light.max);
  std::printf("%s × %.6g (%+.3f stops), as displayed:\n", !c.are_linear && o.align ? "aligned: exposure" : "exposure",
              c.exposure, std::log2(c.exposure));
}

void print_comparison(const CompareOptions& o, const Comparison& c) {
  char psnr[40];
  std::snprintf(psnr, sizeof psnr, std::isinf(c.errors.psnr) ? "infinite" : "%.2f dB", c.errors.psnr);
  if (c.has_exposure) print_light(o, c);
  std::printf("ꟻLIP %.6f (largest %.6f), RMSE %.6f, PSNR %s, largest difference %d of 255; %s of %s pixels differ\n",
              c.flip, c.flip_max, c.errors.rmse, psnr, largest_level_difference(c), grouped(c.differing_count).c_str(),
              grouped(c.flip_map.size()).c_str());
}

Json light_json(const CompareOptions& o, const Comparison& c) {
  if (!c.are_linear) return Json();
  return {{"rmse", c.light.rmse},
          {"rel_mse", c.light.rel_mse},
          {"bias", c.light.bias},
          {"largest_difference", c.light.max},
          {"aligned_scale", o.align ? Json(c.scale) : Json()}};
}

Json to_json(const CompareOptions& o, const AnyPicture& reference, const Comparison& c) {
  return {{"reference", o.reference},
          {"test", o.test},
          {"width", reference.width()},
          {"height", reference.height()},
          {"pixels_per_degree", o.pixels_per_degree},
          {"flip", c.flip},
          {"flip_max", c.flip_max},
          {"rmse", c.errors.rmse},
          {"psnr", std::isinf(c.errors.psnr) ? Json() : Json(c.errors.psnr)},
          {"largest_level_difference", largest_level_difference(c)},
          {"differing_pixels", c.differing_count},
          {"exposure", c.has_exposure ? Json(c.exposure) : Json()},
          {"linear", light_json(o, c)},
          {"map", o.map.empty() ? Json() : Json(o.map)}};
}

Status run(const CompareOptions& o) {
  AnyPicture reference, test;
  Development development;
  Comparison c;
  RETURN_IF_ERROR(read_pictures(o, &reference, &test));
  RETURN_IF_ERROR(read_development(o, reference, test, &development));
  RETURN_IF_ERROR(compare_pictures(reference, test, development, o.pixels_per_degree, &c));
  if (o.json != "-") print_comparison(o, c);
  if (!o.map.empty()) RETURN_IF_ERROR(write_map(o.map, reference, c));
  if (!o.json.empty()) RETURN_IF_ERROR(write_json(o.json, to_json(o, reference, c)));
  if (c.flip > o.fail_above)
    return failure("%.180s differs from %.180s by ꟻLIP %.6f, more than --fail-above %g", o.test.c_str(),
                   o.reference.c_str(), c.flip, o.fail_above);
  return success();
}

}  // namespace

void add_compare_command(Command program, int* exit_status) {
  auto o = std::make_shared<CompareOptions>();
  Command command = program.add_subcommand("compare", "measure how different two pictures look");
  command.add_option("A", o->reference, "the reference: .png, .jpg, .ppm, .pfm or .exr").required();
  command.add_option("B", o->test, "the picture to judge, of equal size").required();
  command.chapter("Comparison");
  command.add_option("--exposure STOPS", o->exposure, "exposure of linear light in stops, or auto")
      .default_str("0")
      .details(
          "Of light in .pfm and .exr; 0 stops make radiance 1 white. auto makes the geometric mean of A, or of B if "
          "only that "
          "is "
          "linear, middle grey.");
  command.add_option("--tone NAME", o->tone, "how linear light too bright for a display is shown")
      .one_of({kToneNames[0], kToneNames[1]})
      .default_str(kToneNames[static_cast<int>(Development().tone)])
      .details("As --tone of render, beside whose pictures of levels the light is compared.");
  command.add_flag("--align", o->align, "scale the light of B to match A, and print the factor")
      .details("Of a single linear picture, finds the exposure.");
  command.add_option("--pixels-per-degree,--ppd X", o->pixels_per_degree, "pixels per degree of visual angle")
      .range(4, 400)
      .default_str("23.6")
      .details("23.6 is a handheld's; 67 is usual for desktops.");
  command.chapter("Output");
  command.add_option("-o,--map,--output FILE", o->map, "write a picture of the ꟻLIP, .png");
  command.add_option("--fail-above X", o->fail_above, "exit with status 1 if the mean ꟻLIP exceeds X")
      .range(0, 1)
      .default_str("never");
  add_json_option(command, &o->json);
  command.everyday("Output", {"--map", "--fail-above", "--json"});
  command.everyday("Comparison", {"--exposure", "--align", "--pixels-per-degree"});
  command.footer(
      "ꟻLIP is how different two pictures look: 0 for equal ones, .01 is hard to see,\n.05 seen at once, .2 another "
      "picture.");
  command.example("pocketray compare expected.png out.png --map map.png --fail-above 0.01");
  command.example("pocketray compare reference.pfm out.exr --align");
  command.about(
      "Prints the mean ꟻLIP (Andersson et al. 2020), 0 for equal pictures and at most 1; RMSE and PSNR of the values "
      "as "
      "displayed, 1 being white; the largest difference of a channel; and the number of pixels that differ. PSNR is "
      "infinite for equal pictures (JSON: null). Alpha is ignored, and 16-bit PNGs are compared as 8 bits. The map "
      "shows "
      "ꟻLIP from black (0) through violet and orange to light yellow (1), in the perceptually even colours of magma.");
  command.about(
      "Two pictures of linear light, .pfm or .exr, are also compared in that: RMSE, relative MSE and bias, above 0 if "
      "B "
      "is too bright. Beside .png, .jpg or .ppm, linear light is first exposed: --align finds the exposure of a "
      "picture "
      "by `render`.");
  command.callback([=] { *exit_status = report(run(*o)); });
}

}  // namespace pocketray
