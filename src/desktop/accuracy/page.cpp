#include "desktop/accuracy/page.h"

#include <algorithm>
#include <cmath>

#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/knob_list.h"
#include "desktop/accuracy/page_parts.h"
#include "desktop/accuracy/page_tables.h"
#include "desktop/accuracy/plot.h"
#include "desktop/accuracy/strip.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

std::string plot_figure(const PagePictures& pictures, const std::string& name) {
  auto found = pictures.plots.find(name);
  if (found == pictures.plots.end()) return "";
  return svg_figure(name, found->second);
}

std::string flip_scale() {
  std::string stops;
  for (int i = 0; i <= 10; ++i) {
    std::array<std::uint8_t, 3> c = flip_color(static_cast<float>(i) / 10);
    stops += format(", #%02x%02x%02x", c[0], c[1], c[2]);
  }
  return "<span class=\"scale\" style=\"background: linear-gradient(to right" + stops + ")\"></span>";
}

std::string strip_figure(const Sweep& sweep, const PagePictures& pictures, const std::string& knob) {
  auto found = pictures.strips.find(knob);
  if (found == pictures.strips.end()) return "";
  std::string rows;
  for (const Strip& strip : sweep.strips)
    if (strip.knob == knob)
      for (const StripRow& row : strip.rows)
        rows += (rows.empty() ? "" : "; ") + escaped(row.label) + " (" +
                (std::isfinite(row.bytes) ? format("%.0f bytes", row.bytes) : figure(row.ms) + " ms") + ", FLIP " +
                figure(row.flip) + ")";
  return "<figure class=\"strip\"><div class=\"box\">" + image(found->second, "Strip of " + knob) +
         "</div><figcaption>From the left: reference, setting, " + std::to_string(kDifferenceGain) +
         " × difference, FLIP from 0 " + flip_scale() + " to 1. From the top: " + rows + ".</figcaption></figure>\n";
}

// " (256 samples per pixel, own error FLIP 0.012)".
std::string samples_text(const ReferenceFigures& reference) {
  return reference.samples == 0
             ? ""
             : format(" (%u samples per pixel, own error FLIP ", reference.samples) + figure(reference.flip, 2) + ")";
}

// Keeps each option on one line: "--samples 4 --depth 2" breaks only before a "--".
std::string option_list(const std::string& options) {
  std::string list;
  for (std::size_t at = 0; at < options.size();) {
    const std::size_t next = std::min(options.find(" --", at), options.size());
    list += (at ? " <span>" : "<span>") + escaped(options.substr(at, next - at)) + "</span>";
    at = next + 1;
  }
  return list;
}

// One picture of the first screen: what it costs, how to get it and what that means.
std::string level_card(const std::string& png, const std::string& name, const std::string& figures,
                       const std::string& how, const std::string& meaning) {
  return "<figure>" + (png.empty() ? "" : image(png, name)) + "<figcaption><b>" + name + "</b>" + figures + "<code>" +
         how + "</code><small>" + meaning + "</small></figcaption></figure>\n";
}

// Shows each level of quality: its picture, time, error and options.
std::string quality_of(const Sweep& sweep, const PagePictures& pictures) {
  if (sweep.quality.empty()) return "";
  std::string cards;
  for (const LevelPicture& level : sweep.quality) {
    auto png = pictures.quality.find(level.level);
    const std::string name = escaped(level.level);
    cards += level_card(png == pictures.quality.end() ? "" : png->second, name,
                        row_link(sweep, sweep.measured[level.measured_index],
                                 "<b>" + figure(level.ms) + " ms</b> <b>FLIP " + figure(level.flip) + "</b>"),
                        "--quality " + name, level.settings.empty() ? "the defaults" : option_list(level.settings));
  }
  cards += level_card(pictures.truth_png, text_of(Judge::truth), "", "pocketray reference",
                      sweep.truth.samples ? format("%u samples per pixel", sweep.truth.samples) : "");
  return "<div class=\"tiles quality\">\n" + cards +
         "</div>\n<p>FLIP is how different a picture looks from full light "
         "transport when one flips between them: .01 is hard to see, .05 seen at once, .2 another picture. "
         "<code>--budget-ms</code> takes the best setting for a time, <code>--flip-max</code> the fastest for an "
         "error.</p>\n";
}

std::string head_of(const Sweep& sweep, const PagePictures& pictures) {
  std::string title = "What accuracy costs in time: " + escaped(sweep.scene.substr(sweep.scene.rfind('/') + 1));
  return page_begin(title) + "<header>\n<div>\n<h1>" + title + "</h1>\n<p class=\"soft\">" +
         (sweep.scene.find('/') == std::string::npos ? "" : escaped(sweep.scene) + ", ") +
         format("%u × %u pixels", sweep.width, sweep.height) + ", " + escaped(sweep.machine) + ", " +
         std::to_string(sweep.rounds) + " rounds; the baseline’s output is " + escaped(sweep.output) +
         ".</p>\n</div>\n</header>\n" + quality_of(sweep, pictures);
}

// Names both references and shows the model's, which the first screen does not have.
std::string judges_section(const Sweep& sweep, const PagePictures& pictures) {
  std::string text = "<h2>The judges</h2>\n<header>\n<div>\n<p>What a user sees is judged by <b>" +
                     std::string(text_of(Judge::truth)) + "</b>, path traced in double precision" +
                     samples_text(sweep.truth) + "; numerical settings by <b>the converged lighting model</b>" +
                     samples_text(sweep.model) +
                     ", which has no other error. Means leave out what the noise of these references adds. Pictures "
                     "share that noise, so their differences are finer than it; where even a difference is not "
                     "claimed, figures are <span class=\"weak\"><i>grey</i></span>.";
  if (std::isfinite(sweep.model_distance))
    text += " The converged model itself is FLIP " + figure(sweep.model_distance) +
            (std::isfinite(sweep.model_rmse) ? " and RMSE " + figure(sweep.model_rmse) : "") +
            " from full light transport.";
  text += "</p>\n</div>\n";
  if (!pictures.reference_png.empty())
    text += "<figure>" + image(pictures.reference_png, "The converged lighting model") +
            "<figcaption>The converged lighting model</figcaption></figure>\n";
  return text + "</header>\n";
}

// Says which knobs buy the most, in a sentence or two.
std::string answer_of(const Sweep& sweep) {
  const KnobFigures *first = nullptr, *last = nullptr;
  std::string free, idle, sent;
  auto add = [](std::string* list, const std::string& name) { *list += (list->empty() ? "" : ", ") + escaped(name); };
  for (const KnobFigures* knob : knobs_by_price(sweep)) {
    KnobEnds ends = ends_of(sweep, knob->name);
    bool claimed = gain_claimed(*knob, ends);
    if (is_paid_in_bytes(ends)) {
      sent += "<b>" + escaped(knob->name) + "</b> saves bytes from render servers, not time: " +
              row_link(sweep, *ends.worst,
                       format("%.0f of %.0f per frame for FLIP ",
                              ends.best->bytes_per_frame - ends.worst->bytes_per_frame, ends.best->bytes_per_frame) +
                           figure(gain_of(*knob, ends), 2)) +
              ". ";
    } else if (!claimed || !std::isfinite(knob->ms_per_flip)) {
      add(&idle, knob->name);
    } else if (knob->ms_per_flip <= 0) {
      add(&free, knob->name);
    } else {
      if (!first) first = knob;
      last = knob;
    }
  }
  std::string text;
  auto price = [&](const KnobFigures& knob) {
    return row_link(sweep, *ends_of(sweep, knob.name).best, figure(knob.ms_per_flip) + " ms");
  };
  if (first)
    text += "<b>" + escaped(first->name) + "</b> buys the most accuracy per millisecond: .01 of FLIP for <b>" +
            price(*first) + "</b> per frame. ";
  if (last != first) text += "<b>" + escaped(last->name) + "</b> buys the least: " + price(*last) + ". ";
  text += sent;
  if (!free.empty()) text += "Better and no slower: " + free + ". ";
  if (!idle.empty()) text += "No gain that can be claimed: " + idle + ".";
  if (!first && free.empty() && !idle.empty()) text += " A reference with more samples may show one.";
  if (text.empty()) text = "No knob was measured.";
  return "<p class=\"answer\">" + text + "</p>\n";
}

std::string knob_section(const Sweep& sweep, const PagePictures& pictures, const KnobFigures& knob) {
  std::string plot = "knob_" + file_word(knob.name), what = knob.what, slope = slope_text(knob);
  if (!what.empty() && what[0] >= 'a' && what[0] <= 'z') what[0] = static_cast<char>(what[0] - 'a' + 'A');
  std::string text = "<h2 id=\"" + file_word(knob.name) + "\">" + escaped(knob.name) + "</h2>\n<p>" + escaped(what) +
                     " <span class=\"soft\">(effect: " + escaped(knob.effect) + ")</span>.";
  if (pictures.plots.count(plot) == 0 && !slope.empty()) text += " On logarithmic scales: " + escaped(slope) + ".";
  return text + "</p>\n" + plot_figure(pictures, plot) + strip_figure(sweep, pictures, knob.name) +
         value_table(sweep, knob.name);
}

// The front by the reference that is not the judge.
std::string other_section(const Sweep& sweep, const PagePictures& pictures) {
  const Judge other = other_than(sweep.judge);
  if (!has_judged(sweep, other)) return "";
  return std::string("<h2>The front by ") + text_of(other) + "</h2>\n<p>The same pictures, judged by " +
         text_of(other) + ": " +
         (other == Judge::model ? "the numerical error of the model alone" : "the distance to the truth") + ".</p>\n" +
         pair(plot_figure(pictures, front_plot_name(sweep, other)), front_table(sweep, other));
}

// States the price of the screen's format: the error of the baseline's picture in each.
std::string format_section(const Sweep& sweep) {
  if (sweep.measured.empty() || !std::isfinite(sweep.measured.front().flip_as[0])) return "";
  std::string text;
  for (int i = 0; i < kOutputFormatCount; ++i)
    text += std::string(i ? ", " : "") + kOutputFormats[i].name + " " +
            figure(sweep.measured.front().flip_as[static_cast<std::size_t>(i)]);
  return "<p>What the format of the screen costs: the baseline’s picture is FLIP " + text +
         " from the truth. Pictures that are written have 24 bits (rgb888), and a budget judges them so.</p>\n";
}

std::string methods_section(const Sweep& sweep, const PagePictures& pictures) {
  if (methods_of(sweep).size() < 2) return "";
  return "<h2>Methods of indirect light</h2>\n<p>Each method with every combination of its own settings, at the "
         "baseline’s samples and at four, and everything else that was measured with it: its Pareto front against "
         "full light transport.</p>\n" +
         pair(plot_figure(pictures, "indirect"), method_table(sweep));
}

// Describes how scenes were baked, if they were.
std::string baked_method(const Sweep& sweep) {
  for (const KnobFigures& knob : sweep.knobs)
    if (knob.is_baked)
      return " Choices of <code>bake</code> are measured on the scene as baked with them; what is stored is the whole "
             "file, which a device loads as it is. The references show the largest textures.";
  return "";
}

// Describes how rows were sent, if they were.
std::string sent_method(const Sweep& sweep) {
  for (const Measured& m : sweep.measured)
    if (std::isfinite(m.bytes_per_frame))
      return format(
          " Bytes per frame cover all rows of a picture from a render server, without message overhead. To measure "
          "them, the camera orbits its target by %g° per frame and ends at the judged picture, the last "
          "of %u. Each picture passes through encoder and decoder, its rows predicted from the previous picture and "
          "from each other; the first, which has no predecessor, does not count. “near-lossless on” shows the "
          "decoder’s result. Devices without a server have no such setting, so it is not on the front.",
          kSentOrbitDegrees, kSentFrames);
  return "";
}

std::string method_of(const Sweep& sweep) {
  std::string notes;
  for (const std::string& note : sweep.notes) notes += "<li>" + escaped(note) + "</li>\n";
  if (!notes.empty()) notes = "<ul class=\"soft\">\n" + notes + "</ul>\n";
  return "<h2>Method</h2>\n<p class=\"soft\">FLIP (ꟻLIP): Andersson, Nilsson, Akenine-Möller, Oskarsson, "
         "Åström and Fairchild 2020, “ꟻLIP: A Difference Evaluator for Alternating Images”, at " +
         figure(sweep.pixels_per_degree) +
         " pixels per degree; the mean over the picture, after output (quantised, dithered) and before it. RMSE, "
         "relative MSE (Rousselle et al. 2011), 99th percentile, maximum, bias and PSNR are of linear light from 0 to "
         "1 before output.</p>\n<p class=\"soft\">A frame’s time covers posing, refitting, placing lights, tracing and "
         "packing, after a frame with the same settings; the cost of changing settings is excluded. Instructions cover "
         "only tracing and packing. The configurations run interleaved in random order. Ratios to the baseline are "
         "taken within a round, whose runs share the state of the machine; shown are their median and the 95 % "
         "interval of interpolated order statistics (Hettmansperger and Sheather 1986). Times are the ratio times the "
         "baseline’s median; their interval is that of the configuration’s own times and so includes the machine’s "
         "variation." +
         (sweep.rounds < 6
              ? std::string(
                    " With fewer than six rounds all intervals are ranges of the rounds, which cover less than 95 %.")
              : std::string()) +
         sent_method(sweep) + baked_method(sweep) +
         "</p>\n<p class=\"soft\">A slope is the "
         "exponent s of RMSE² = floor² + (c timeˢ)², fitted in each round to all values of a knob by least squares of "
         "relative differences, where the reference can tell the errors apart: the median of the rounds, with its 95 % "
         "interval in brackets. The interval covers only the times; the deviation of RMSE from the law is given "
         "separately. “ms per .01 FLIP” is the time from a knob’s worst end to its best divided by the gain. * marks "
         "the baseline’s value.</p>\n" +
         notes;
}

}  // namespace

std::string page_of(const Sweep& sweep, const PagePictures& pictures) {
  std::string text = head_of(sweep, pictures) + "<h2>What buys the most accuracy per millisecond</h2>\n" +
                     answer_of(sweep) + pair(price_table(sweep), plot_figure(pictures, "price")) +
                     judges_section(sweep, pictures);
  text += "<h2>The front: the least error for the time</h2>\n<p>Judged by " + std::string(text_of(sweep.judge)) +
          ". No measured configuration is both faster and more accurate, as far as the reference can tell: in order of "
          "time, a setting joins the front if it is nearer than the one before by a hundredth of the error and twice "
          "the standard "
          "error of their difference. <code>--budget-ms</code> and <code>--flip-max</code> choose from it.</p>\n" +
          pair(plot_figure(pictures, "front"), front_table(sweep, sweep.judge)) + format_section(sweep);
  text += "<p>Baked radiosity: " + escaped(radiosity_text(sweep)) + ".</p>\n";
  text += other_section(sweep, pictures) + methods_section(sweep, pictures);
  std::string links;
  for (const KnobFigures& knob : sweep.knobs)
    links += "<a href=\"#" + file_word(knob.name) + "\">" + escaped(knob.name) + "</a> ";
  if (!links.empty()) text += "<h2>Knob by knob</h2>\n<nav>" + links + "</nav>\n";
  for (const KnobFigures& knob : sweep.knobs) text += knob_section(sweep, pictures, knob);
  if (!values_of(sweep, "several").empty())
    text +=
        "<h2>Several at once</h2>\n<details><summary>Configurations that cover pairs of values of two "
        "knobs</summary>\n" +
        value_table(sweep, "several") + "</details>\n";
  return text + method_of(sweep) + kPageEnd;
}

}  // namespace pocketray
