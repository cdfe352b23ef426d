// The page, and the report as a whole.
#include "desktop/accuracy/page.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "desktop/accuracy/report.h"
#include "desktop/accuracy/text.h"
#include "sample_sweep.h"

using namespace pocketray;

namespace {

bool gnuplot(const std::string& folder, const std::vector<std::string>& scripts) {
  std::string command = "cd " + folder + " && gnuplot";
  for (const std::string& script : scripts) command += " " + script;
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

Status write_whole(const std::string& path, const std::string& bytes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return failure("%.300s cannot be written", path.c_str());
  bool ok = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  return std::fclose(file) == 0 && ok ? success() : failure("%.300s cannot be written", path.c_str());
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A fault in the markup: tags not closed in order, attributes without quotes, stray characters. Empty: none.
std::string markup_fault(const std::string& page) {
  std::vector<std::string> open;
  for (std::size_t at = page.find('<'); at < page.size(); at = page.find('<', at)) {
    std::size_t end = page.find('>', at);
    if (end == std::string::npos) return "'<' without '>'";
    std::string tag = page.substr(at + 1, end - at - 1);
    at = end;
    if (tag[0] == '!') continue;
    std::string name = tag.substr(0, tag.find_first_of(" \n/", tag[0] == '/'));
    if (tag[0] == '/') {
      if (open.empty() || "/" + open.back() != name) return tag + " closes " + (open.empty() ? "nothing" : open.back());
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
    for (std::size_t i = tag.find('='), quotes = 0; i < tag.size() && quotes < 1; i = tag.find('=', i + 1)) {
      std::size_t value = tag.find_first_not_of(' ', i + 1);
      if (tag[value] != '"' && tag[value] != '\'') return "no quote in " + tag;
      i = tag.find(tag[value], value + 1);
      if (i == std::string::npos) return "open quote in " + tag;
    }
  }
  return open.empty() ? "" : open.back() + " is not closed";
}

// The text between the tags, without the style.
std::string text_of(const std::string& page) {
  std::string text;
  for (std::size_t at = page.find("</style>"); at < page.size();) {
    std::size_t open = std::min(page.find('<', at), page.size());
    text += page.substr(at, open - at) + " ";
    at = std::min(page.find('>', open), page.size() - 1) + 1;
  }
  return text;
}
bool has_word(const std::string& text, const std::string& word) {
  auto letter = [&](std::size_t i) { return i < text.size() && std::isalpha(static_cast<unsigned char>(text[i])); };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    if (!letter(at - 1) && !letter(at + word.size())) return true;
  return false;
}

struct Folder {
  char path[64] = "/tmp/pocketray_report_XXXXXX";
  Folder() { REQUIRE(mkdtemp(path)); }
  ~Folder() { CHECK(std::system(("rm -r '" + std::string(path) + "'").c_str()) == 0); }
};
std::string content(const std::string& path) {
  std::string bytes;
  if (std::FILE* file = std::fopen(path.c_str(), "rb")) {
    for (int c; (c = std::fgetc(file)) != EOF;) bytes += static_cast<char>(c);
    std::fclose(file);
  }
  return bytes;
}

}  // namespace

// Goal: the markup's checker sees faults. Method: one of each.
TEST_CASE("page_markup_checker_finds_faults") {
  CHECK(markup_fault("<a b=\"1\"><c d='x' /></a>") == "");
  for (std::string bad : {"<a>", "<a></b>", "</a>", "<a b=1></a>", "<a b=\"1></a>", "<a"})
    CHECK_MESSAGE(markup_fault(bad) != "", bad);
}

// Goal: numbers read well and text is text. Method: cases.
TEST_CASE("page_text_is_for_readers") {
  CHECK(figure(0.0421) == "0.0421");
  CHECK(figure(1) == "1.00");
  CHECK(figure(-12.34) == "−12.3");
  CHECK(figure(123.4) == "123");
  CHECK(figure(99.99) == "100");
  CHECK(figure(0.00001234) == "1.23e-5");
  CHECK(figure(0) == "0");
  CHECK(figure(NAN) == "–");
  CHECK(figure(INFINITY) == "∞");
  CHECK(figure(-INFINITY) == "−∞");
  CHECK(escaped("<a href=\"x\">'&\n") == "&lt;a href=&quot;x&quot;&gt;&#39;&amp; ");
  CHECK(base64("") == "");
  CHECK(base64("f") == "Zg==");
  CHECK(base64("fo") == "Zm8=");
  CHECK(base64("foo\xff") == "Zm9v/w==");
}

// Goal: the page is well-formed, complete and self-contained. Method: a made-up sweep with markup in its texts.
TEST_CASE("page_is_well_formed_and_shows_each_knob") {
  Sweep sweep = sample_sweep();
  add_knob(&sweep, "<b>&\"it's\"", 3, 5);
  sweep.scene = "a<b", sweep.model_distance = 0.2, sweep.notes = {"fog & mist are left out"};
  sweep.measured.back().missing = "takes > 64 MB";
  PagePictures pictures;
  pictures.reference_png = "png", pictures.strips["samples"] = "strip";
  pictures.plots["front"] =
      "<?xml version=\"1.0\"?>\n<svg viewBox=\"0 0 1 1\"><title>Gnuplot</title><g id='gpDot'/>"
      "<use xlink:href='#gpDot'/></svg>\n";
  std::string page = page_of(sweep, pictures);
  CHECK(markup_fault(page) == "");
  for (std::string part : {"width=device-width", "a&lt;b", "id=\"samples\"", "id=\"area-lights\"", "id=\"normals\"",
                           "&lt;b&gt;&amp;&quot;it&#39;s", "not measured: takes &gt; 64 MB",
                           "data:image/png;base64,cG5n", "data:image/png;base64,c3RyaXA=", "front_gpDot'/>",
                           "#front_gpDot", "Andersson", "<li>fog &amp; mist are left out</li>", "samples 2, normals 2",
                           "512", "prefers-color-scheme: dark", "FLIP 0.200"})
    CHECK_MESSAGE(has(page, part), part);
  // Each figure leads to its row, counted from the header.
  CHECK(has(page, "<th><a href=\"accuracy.csv#row=3\">1*</a></th>"));
  CHECK(has(page, "<th class=\"name\"><span><a href=\"accuracy.csv#row=2\">baseline</a></span></th>"));
  for (std::string part : {"<b>&\"", "http://", "https://", "<?xml", "Gnuplot"}) CHECK_MESSAGE(!has(page, part), part);
  CHECK(page == page_of(sweep, pictures));
  CHECK(page.size() < 100000);
}

// Goal: the first screen shows what each level of quality sets and gets, beside the truth. Method: two levels, one with
// its picture; a sweep without levels.
TEST_CASE("page_opens_with_what_to_set") {
  Sweep sweep = sample_sweep();
  sweep.quality = {{"low", "--samples 1 --depth 2", 12.5, 0.25, sample_picture(4, 3, 0), 0},
                   {"best", "", 480, 0.0625, sample_picture(4, 3, 1), 4}};
  PagePictures pictures;
  pictures.quality["low"] = "png", pictures.truth_png = "truth";
  const std::string page = page_of(sweep, pictures);
  CHECK(markup_fault(page) == "");
  CHECK(has(page,
            "<b>low</b><a href=\"accuracy.csv#row=2\"><b>12.5 ms</b> <b>FLIP 0.250</b></a><code>--quality low</code>"
            "<small><span>--samples 1</span> <span>--depth 2</span></small>"));
  CHECK(has(page,
            "<b>best</b><a href=\"accuracy.csv#row=6\"><b>480 ms</b> <b>FLIP 0.0625</b></a>"
            "<code>--quality best</code><small>the defaults</small>"));
  CHECK(has(page, "<b>full light transport</b><code>pocketray reference</code><small>256 samples per pixel</small>"));
  CHECK(page.find("--quality low") < page.find("What a user sees"));
  CHECK(!has(page_of(sample_sweep(), {}), "--quality"));
}

// Goal: the page begins with the knob that buys the most and claims nothing finer than the reference can tell. Method:
// knobs with known prices; then a reference whose error exceeds any gain.
TEST_CASE("page_answers_what_buys_the_most") {
  Sweep sweep = sample_sweep();
  std::string page = page_of(sweep, {});
  CHECK(has(page,
            "<b>area-lights</b> buys the most accuracy per millisecond: .01 of FLIP for <b><a "
            "href=\"accuracy.csv#row=11\">0.700 ms</a></b> per frame"));
  CHECK(has(page, "<b>samples</b> buys the least: <a href=\"accuracy.csv#row=7\">2.40 ms</a>"));
  CHECK(has(page, "Better and no slower: normals."));
  CHECK(page.find("buys the most") < page.find("id=\"samples\""));
  CHECK(!has(page, "<td class=\"weak\">"));
  set_noise(0.1, &sweep);
  page = page_of(sweep, {});
  CHECK(has(page, "No gain that can be claimed: "));
  CHECK(has(page, "A reference with more samples may show one."));
  CHECK(!has(page, "buys the most accuracy per millisecond:"));
  CHECK(has(page, "<tr class=\"weak\">"));
  sweep.model.rmse = 0.02;
  CHECK(has(page_of(sweep, {}), "<td class=\"weak\"><i>0.0640</i></td>"));
}

// Goal: the page explains its times and intervals. Method: a value timed with another tracer; few rounds.
TEST_CASE("page_says_what_was_timed_and_how_surely") {
  Sweep sweep = sample_sweep();
  std::string page = page_of(sweep, {});
  CHECK(has(page, "posing, refitting, placing lights, tracing and packing"));
  CHECK(has(page, "The interval covers only the times"));
  CHECK(!has(page, "fewer than six rounds"));
  sweep.measured[2].note = "time of <another> tracer", sweep.rounds = 5;
  page = page_of(sweep, {});
  CHECK(has(page, "<small>time of &lt;another&gt; tracer</small>"));
  CHECK(has(page, "fewer than six rounds"));
}

// Goal: what saves bytes and not time is told in bytes, with how they were counted. Method: a knob whose ends differ in
// bytes; a page without one.
TEST_CASE("page_tells_what_is_paid_in_bytes") {
  Sweep sweep = sample_sweep();
  CHECK(!has(page_of(sweep, {}), "ytes per frame"));
  add_sent_knob(&sweep);
  std::string page = page_of(sweep, {});
  CHECK(markup_fault(page) == "");
  CHECK(has(page,
            "<b>near-lossless</b> saves bytes from render servers, not time: <a href=\"accuracy.csv#row=15\">1500 of "
            "4000 per frame for FLIP 0.010</a>."));
  CHECK(!has(page, "No gain that can be claimed"));
  CHECK(has(page, "<th>bytes per frame</th>"));
  CHECK(has(page, "<td>2500</td>"));
  CHECK(has(page, "2500 bytes, FLIP 0.0900"));
  CHECK(has(page, "orbits its target by 1° per frame"));
  CHECK(has(page, "the last of 8."));
}

// Goal: choices of `bake` are told with what they store and how long they take, and radiosity in one line. Method: a
// knob of such choices; a page without one.
TEST_CASE("page_tells_what_bakes_store") {
  Sweep sweep = sample_sweep();
  std::string page = page_of(sweep, {});
  CHECK(!has(page, "<th>stored</th>"));
  CHECK(!has(page, "Choices of <code>bake</code>"));
  CHECK(has(page, "<p>Baked radiosity: bake --radiosity is not predicted.</p>"));
  add_knob(&sweep, "texture-max", 2, kNotMeasured);
  sweep.knobs.back().is_baked = true;
  Measured &less = sweep.measured[sweep.measured.size() - 2], &more = sweep.measured.back();
  less.stored_bytes = 1 << 19, less.bake_seconds = 0.25, more.stored_bytes = 3 << 20;
  sweep.radiosity = {"", 3.14, 1 << 20, 2e6, 0.061, 0.217};
  page = page_of(sweep, {});
  CHECK(markup_fault(page) == "");
  CHECK(has(page, "<th>stored</th>"));
  CHECK(has(page, "<td>0.50 MiB</td><td>0.25</td>"));
  CHECK(has(page, "<td>3.00 MiB</td><td>–</td>"));
  CHECK(has(page, "ms, 0.50 MiB, FLIP"));
  CHECK(has(page, "Choices of <code>bake</code>"));
  CHECK(has(page, "would take 3.1 s here, store 1.00 MiB"));
}

// Goal: the page shows the front against both kinds of reference and the methods of indirect light, if it knows them.
// Method: pages with and without them.
TEST_CASE("page_shows_either_reference_and_each_method") {
  Sweep sweep = sample_sweep();
  for (Measured& m : sweep.measured) m.model.flip = kNotMeasured;
  CHECK(!has(page_of(sweep, {}), "The front by the converged"));
  sweep = sample_sweep();
  CHECK(!has(page_of(sweep, {}), "Methods of indirect light"));
  add_methods(&sweep);
  PagePictures pictures;
  pictures.plots["indirect"] = "<svg viewBox=\"0 0 1 1\"></svg>\n";
  std::string page = page_of(sweep, pictures);
  CHECK(markup_fault(page) == "");
  CHECK(has(page, "Judged by full light transport"));
  CHECK(has(page, "(256 samples per pixel, own error FLIP 0.030)"));
  CHECK(has(page, "<h2>The front by the converged lighting model</h2>"));
  CHECK(!has(page, "What the format of the screen costs"));
  CHECK(has(page, "Methods of indirect light"));
  CHECK(has(page, "<tr><th>none</th><td class=\"name\">"));
  sweep.measured[0].flip_as = {0.21, 0.205, 0.19};
  CHECK(has(page_of(sweep, pictures), "FLIP rgb565 0.210, rgb565-dithered 0.205, rgb888 0.190 from the truth"));
  sweep.judge = Judge::model;
  CHECK(has(page_of(sweep, pictures), "<h2>The front by full light transport</h2>"));
}

// Goal: every sweep produces all files, and missing figures do not appear as numbers. Method: a complete sweep; one
// knob with one value, without errors, without figures; an empty one.
TEST_CASE("report_has_no_gaps") {
  Sweep whole = sample_sweep(), zero = empty_sweep(), missing = sample_sweep(), nothing = empty_sweep();
  add_methods(&whole);
  add_knob(&zero, "only", 1, kNotMeasured);
  for (Measured& m : zero.measured)
    m.model.flip = m.truth.flip = m.flip_before = 0, m.errors = PictureErrors{0, 0, 0, 0, 0, INFINITY};
  for (Measured& m : missing.measured) m.missing = "no memory";
  missing.knobs[0].slope = {0, -INFINITY, INFINITY};
  nothing.measured.clear(), nothing.reference_picture = {};

  for (const Sweep* sweep : {&whole, &zero, &missing, &nothing}) {
    CAPTURE(sweep->measured.size());
    Folder folder;
    bool drawn = false;
    Status status = write_report(folder.path, *sweep, write_whole, gnuplot, &drawn);
    REQUIRE_MESSAGE(status.ok, status.message);
    CHECK(drawn == (std::system("gnuplot -V >/dev/null 2>&1") == 0));
    std::vector<std::string> plots = {"/front", "/price"};
    if (has_judged(*sweep, Judge::model)) plots.push_back("/front_model");
    if (sweep == &whole) plots.push_back("/indirect");
    for (const KnobFigures& knob : sweep->knobs) {
      plots.push_back("/knob_" + knob.name);
      CHECK(has(content(folder.path + ("/strip_" + knob.name) + ".png"), "PNG"));
    }
    for (const std::string& plot : plots) {
      CHECK(has(content(folder.path + plot + ".gnuplot"), "set terminal svg"));
      if (drawn) CHECK(has(content(folder.path + plot + ".png"), "PNG"));
      if (drawn) CHECK(has(content(folder.path + plot + ".svg"), "</svg>"));
    }
    std::string page = content(folder.path + std::string("/index.html"));
    CHECK(markup_fault(page) == "");
    CHECK(page.size() < 2000000);
    for (std::string word : {"nan", "inf", "NaN", "-nan"}) CHECK_MESSAGE(!has_word(text_of(page), word), word);
    std::size_t drawings = 0;
    for (std::size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1)) ++drawings;
    CHECK(drawings == (drawn ? plots.size() : 0));
  }
}

// Goal: a strip begins with the picture that its knob is judged by.
TEST_CASE("report_draws_strips_beside_their_judge") {
  Sweep sweep = sample_sweep();
  sweep.truth_picture = sample_picture(32, 24, 99);
  sweep.knobs[0].judge = Judge::truth;
  Sweep other = sweep;
  other.truth_picture = sample_picture(32, 24, 7);
  Folder one, two;
  bool drawn = false;
  const auto draws_nothing = [](const std::string&, const std::vector<std::string>&) { return false; };
  REQUIRE(write_report(one.path, sweep, write_whole, draws_nothing, &drawn).ok);
  REQUIRE(write_report(two.path, other, write_whole, draws_nothing, &drawn).ok);
  auto strip = [](const Folder& folder, const Sweep& of, int knob) {
    return content(folder.path + ("/strip_" + of.knobs[static_cast<std::size_t>(knob)].name) + ".png");
  };
  CHECK(strip(one, sweep, 0) != strip(two, other, 0));
  CHECK(strip(one, sweep, 1) == strip(two, other, 1));
}

// Goal: a missing folder is reported in one line.
TEST_CASE("report_names_a_folder_it_cannot_write_to") {
  bool drawn = true;
  Status status = write_report("/nonexistent/folder", sample_sweep(), write_whole, gnuplot, &drawn);
  CHECK(!status.ok);
  CHECK(!drawn);
  CHECK(has(status.message, "/nonexistent/folder/"));
  CHECK(!has(status.message, "\n"));
}
