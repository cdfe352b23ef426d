// Plots as scripts: their points, axes and labels.
#include "desktop/accuracy/plot.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/rng.h"
#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/accuracy/plot_axis.h"
#include "sample_sweep.h"

using namespace pocketray;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// Lines of a data block; -1 without one.
int points_of(const Plot& plot, const std::string& block) {
  std::size_t begin = plot.script.find("$" + block + " << EOD\n");
  if (begin == std::string::npos) return -1;
  std::size_t end = plot.script.find("EOD\n", plot.script.find('\n', begin));
  int lines = -1;
  for (std::size_t i = begin; i < end; ++i) lines += plot.script[i] == '\n';
  return lines;
}

}  // namespace

// Goal: each configuration with figures is a point, the front is marked and numbered. Method: count the data's lines;
// one configuration has no figures, another no ꟻLIP.
TEST_CASE("plot_front_has_a_point_for_all_that_was_measured") {
  Sweep sweep = sample_sweep();
  sweep.measured[1].missing = "too large";
  sweep.measured[3].truth.flip = kNotMeasured;
  Plot plot = front_plot(sweep, Judge::truth);
  CHECK(plot.name == "front");
  CHECK(points_of(plot, "knob0") == 1);  // several
  CHECK(points_of(plot, "knob1") == 3);  // samples, 5 values
  CHECK(points_of(plot, "knob2") == 4);
  CHECK(points_of(plot, "knob3") == 2);
  CHECK(points_of(plot, "knob4") == 1);  // the baseline
  REQUIRE(front_of(sweep, Judge::truth).size() > 1);
  CHECK(points_of(plot, "front") == static_cast<int>(front_of(sweep, Judge::truth).size()));
  CHECK(has(plot.script, "set label '1"));
  CHECK(has(plot.script, "the reference''s own error"));
  CHECK(has(plot.script, "set title 'Error over time, against full light transport'"));
  plot = front_plot(sweep, Judge::model);
  CHECK(plot.name == "front_model");
  CHECK(points_of(plot, "knob1") == 4);
  CHECK(has(plot.script, "set title 'Error over time, against the converged lighting model'"));
}

// Goal: each method of indirect light has a line through what no other of it beats, against full light transport
// whichever reference was chosen. Method: three methods, of one of which a configuration is beaten and another no
// choice.
TEST_CASE("plot_of_methods_has_the_front_of_each") {
  Sweep sweep = sample_sweep();
  add_methods(&sweep);
  CHECK(methods_of(sweep) == std::vector<std::string>{"radiosity", "none", "instant-radiosity"});
  std::vector<const Measured*> front = method_front(sweep, "none");
  REQUIRE(front.size() >= 2);
  for (std::size_t i = 1; i < front.size(); ++i) {
    CHECK(front[i]->ns_per_pixel.value > front[i - 1]->ns_per_pixel.value);
    CHECK(front[i]->truth.flip < front[i - 1]->truth.flip);
  }
  Plot plot = method_plot(sweep);
  CHECK(plot.name == "indirect");
  CHECK(points_of(plot, "method1") == static_cast<int>(front.size()));
  CHECK(has(plot.script, "using 1:2 title 'instant-radiosity'"));
  CHECK(has(plot.script, "the reference''s own error"));
  const std::size_t before = front.size();
  const_cast<Measured*>(front.back())->is_choice = false;
  CHECK(method_front(sweep, "none").size() == before - 1);
  sweep.judge = Judge::model;
  for (Measured& m : sweep.measured) m.model.flip = 0.5;
  CHECK(method_front(sweep, "none").size() == before - 1);
  CHECK(methods_of(sample_sweep()).empty());
}

// Goal: settings are named without the method. Method: the labels of one configuration.
TEST_CASE("plot_of_methods_names_their_settings") {
  Sweep sweep = empty_sweep();
  sweep.measured.push_back(
      sample_measured("several", "samples 4, indirect instant-radiosity, virtual-lights 256", 90, 0.03));
  add_methods(&sweep);
  CHECK(own_settings(sweep.measured.back()) == "samples 4, virtual-lights 256");
  CHECK(!has(method_plot(sweep).script, "samples 4"));  // too long
  sweep.measured.back().value = "indirect instant-radiosity, virtual-lights 256";
  CHECK(has(method_plot(sweep).script, "set label 'virtual-lights 256' at"));
}

// Goal: a knob's plot has its values with their labels, intervals, slope and theory. Method: the script's text.
TEST_CASE("plot_knob_has_its_values_slope_and_theory") {
  Sweep sweep = sample_sweep();
  sweep.measured[2].errors.rmse = kNotMeasured;
  Plot plot = knob_plot(sweep, sweep.knobs[0]);
  CHECK(plot.name == "knob_samples");
  CHECK(points_of(plot, "flip") == 5);
  CHECK(points_of(plot, "rmse") == 4);
  for (std::string text : {"set label '1*'", "set label '16'", "'samples: what samples turns'", "xerrorbars",
                           "−0.50 [−0.60, −0.40];", "Monte Carlo -1/2"})
    CHECK_MESSAGE(has(plot.script, text), text);
  CHECK(has(plot.script, "set logscale x"));
}

// Goal: knobs with a price have a bar, the others a reason. Method: a knob of each kind.
TEST_CASE("plot_price_has_a_bar_for_each_knob_with_a_price") {
  Sweep sweep = sample_sweep();
  add_knob(&sweep, "idle", 1, kNotMeasured);
  Plot plot = price_plot(sweep);
  CHECK(points_of(plot, "prices") == 2);
  CHECK(has(plot.script, "'free: better and no slower' at graph 0.0000, first 0"));
  CHECK(has(plot.script, "'0.700' at graph"));
  CHECK(has(plot.script, "'no gain that can be claimed' at graph 0.0000, first 3"));
  set_noise(0.1, &sweep);  // exceeds any gain
  CHECK(points_of(price_plot(sweep), "prices") == -1);
}

// Goal: a knob that is paid in bytes is plotted over them. Method: one beside knobs that are paid in time.
TEST_CASE("plot_of_what_is_paid_in_bytes_has_them_as_its_axis") {
  Sweep sweep = sample_sweep();
  add_sent_knob(&sweep);
  std::string script = knob_plot(sweep, sweep.knobs.back()).script;
  CHECK(has(script, "set xlabel 'kilobytes per frame from a render server'"));
  CHECK(has(script, "\n2.5 0.09 2.5 2.5\n"));
  CHECK(has(script, "\n4 0.08 4 4\n"));
  CHECK(has(knob_plot(sweep, sweep.knobs[0]).script, "set xlabel 'milliseconds per frame'"));
  CHECK(has(price_plot(sweep).script, "'paid in bytes, not in time' at graph 0.0000"));
}

// Goal: every number in a script is valid, whatever the sweep. Method: sweeps without errors, with equal ones, with one
// point and with none.
TEST_CASE("plot_scripts_hold_numbers_alone") {
  Sweep none = empty_sweep(), zero = sample_sweep(), equal = sample_sweep(), blank = empty_sweep();
  blank.measured.clear();
  add_knob(&none, "one", 1, kNotMeasured);
  add_methods(&equal);
  for (Measured& m : zero.measured) m.model.flip = m.truth.flip = 0, m.errors = PictureErrors{0, 0, 0, 0, 0, INFINITY};
  for (Measured& m : equal.measured) m.model.flip = m.truth.flip = 0.25, m.ns_per_pixel = {40, 40, 40};
  Sweep mixed = sample_sweep();
  add_methods(&mixed);
  mixed.measured[4].truth.flip = mixed.measured[4].model.flip = mixed.measured[4].errors.rmse = 0;
  mixed.measured[1].ns_per_pixel.low = -INFINITY, mixed.knobs[0].slope = {0, -INFINITY, INFINITY};
  for (const Sweep* sweep : {&none, &zero, &equal, &blank, &mixed}) {
    std::string scripts =
        front_plot(*sweep, Judge::truth).script + price_plot(*sweep).script + method_plot(*sweep).script;
    for (const KnobFigures& knob : sweep->knobs) scripts += knob_plot(*sweep, knob).script;
    for (std::string bad : {"nan", "inf", "∞", "–"}) CHECK_MESSAGE(!has(scripts, bad), bad);
  }
  CHECK(has(front_plot(mixed, Judge::model).script, "set ytics ('0' "));
}

// Goal: an axis shows every value, even zero on a logarithmic one. Method: cases.
TEST_CASE("plot_axis_shows_every_value") {
  Axis wide = axis_of({0.01, 0.5, 0}, 0, true);
  CHECK(wide.logarithmic);
  for (double v : {0.0, 0.01, 0.5}) CHECK((place_on(wide, v) > 0 && place_on(wide, v) < 1));
  CHECK(place_on(wide, 0) < place_on(wide, 0.01));
  CHECK(drawn_value(wide, 0) > 0);
  Axis limit = axis_of({0.01, 0.5}, 0.004, true);
  CHECK((limit.low < 0.004 && limit.low > 0.001));
  CHECK(axis_of({0.01, 0.5}, 0.0004, true).low > 0.005);
  Axis narrow = axis_of({4, 5}, 0, false);
  CHECK((!narrow.logarithmic && narrow.low > 3 && narrow.low < 4 && narrow.high > 5));
  CHECK(axis_of({4, 5}, 0, true).low == 0);
  Axis one = axis_of({7}, 0, false);
  CHECK(std::fabs(place_on(one, 7) - 0.5) < 1e-12);
  Axis nothing = axis_of({0, 0}, 0, true);
  CHECK((nothing.low == 0 && nothing.high == 1 && place_on(nothing, 0) == 0));
}

// Goal: labels are beside their points, within the plot and not over each other. Method: random points, from few to too
// many.
TEST_CASE("plot_labels_do_not_overlap") {
  Rng rng = make_rng(5);
  const PlotArea area = {60, 24};
  for (std::size_t count : {3u, 20u, 200u}) {
    std::vector<PlotPoint> points(count);
    for (PlotPoint& p : points) p.x = next_double(&rng), p.y = next_double(&rng);
    std::vector<Label> labels = place_labels(area, points, std::vector<std::string>(count, "samples 4"));
    REQUIRE(labels.size() == count);
    std::size_t placed = 0, over = 0, far = 0, outside = 0;
    auto left = [&](const Label& l) { return l.at.x * area.columns - 4.5 * (1 + l.align); };
    for (std::size_t i = 0; i < count; ++i) {
      if (!labels[i].placed) continue;
      ++placed;
      double x = left(labels[i]), y = labels[i].at.y * area.lines;
      outside += x < 0 || x + 9 > area.columns || y < 0.5 || y + 0.5 > area.lines;
      far += std::fabs(y - points[i].y * area.lines) > 3;
      for (std::size_t k = 0; k < i; ++k)
        over += labels[k].placed && std::fabs(left(labels[k]) - x) < 8.8 &&
                std::fabs(labels[k].at.y * area.lines - y) < 0.9;
    }
    CHECK((over == 0 && far == 0 && outside == 0));
    if (count == 3) CHECK(placed == 3);
    if (count == 20) CHECK(placed >= 15);
    if (count == 200) CHECK(placed < 150);
  }
}

// Goal: text of the sweep cannot become a command. Method: characters that end a gnuplot or shell string.
TEST_CASE("plot_text_is_quoted") {
  CHECK(gnuplot_string("it's\nso") == "'it''s so'");
  CHECK(gnuplot_lines("one two three", 7) == "'one two'.\"\\n\".'three'");
  CHECK(gnuplot_lines("one two", 7) == "'one two'");
  CHECK(gnuplot_lines("unbreakable it is", 4) == "'unbreakable'.\"\\n\".'it'.\"\\n\".'is'");
  CHECK(gnuplot_lines("", 4) == "''");
  CHECK(shell_word("it's") == "'it'\\''s'");
  Sweep sweep = empty_sweep();
  add_knob(&sweep, "a'b`c", 3, 1);
  Plot plot = knob_plot(sweep, sweep.knobs[0]);
  CHECK(plot.name == "knob_a_b_c");
  CHECK(has(plot.script, "'a''b`c: what a''b`c turns'"));
}
