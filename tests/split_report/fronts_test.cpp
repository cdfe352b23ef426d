// What a frame costs besides time, and what a server is worth among many clients.
#include "desktop/split_report/fronts.h"

#include <doctest/doctest.h>

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "desktop/split_report/plot.h"
#include "support/generated_scene.h"
#include "support/scripted_client.h"

using namespace pocketray;

// Goal: a front has the points that no other beats in both, equal ones once. Method: points by hand.
TEST_CASE("fronts_have_what_no_other_beats") {
  std::vector<FrontPoint> points = {{0.0, 30, 1, false}, {0.1, 10, 4, false}, {0.2, 10, 4, false}, {0.3, 20, 2, false},
                                    {0.4, 20, 3, false}, {0.5, 40, 1, false}, {0.6, 50, 9, false}};
  mark_front(&points);
  for (const FrontPoint& p : points) CHECK(p.on_front == (p.m == 0.0 || p.m == 0.1 || p.m == 0.3));
}

// Goal: energy is that of the device's pixels, of the bytes, and of the frames that the device prepared. Method: a
// sweep by hand.
TEST_CASE("fronts_count_pixels_and_bytes") {
  SplitFigures figures;
  figures.sweep.resize(2);
  figures.sweep[0].m = 0, figures.sweep[0].ns_per_pixel = 500, figures.sweep[0].bytes = 40'000;
  figures.sweep[1].m = 1, figures.sweep[1].ns_per_pixel = 9000, figures.sweep[1].device_pixels = 1000;
  figures.sweep[1].prepared = 0.5;
  const Fronts fronts = make_fronts(figures, {7000, 1100, 6e6}, 1000);
  CHECK(fronts.energy[0].ms == doctest::Approx(0.5));
  CHECK(fronts.energy[0].cost == doctest::Approx(44));
  CHECK(fronts.energy[1].cost == doctest::Approx(10));
  CHECK(fronts.bytes[0].cost == doctest::Approx(40));
  CHECK(fronts.bytes[1].cost == 0);
  CHECK((fronts.energy[1].on_front && fronts.bytes[1].on_front));
}

// Goal: gnuplot can read the scripts of the report. Method: no text ends within a line or runs on beyond it; gnuplot
// itself, where it is installed.
TEST_CASE("fronts_and_splits_are_drawn") {
  char folder[] = "/tmp/pocketray-fronts-XXXXXX";
  REQUIRE(mkdtemp(folder) != nullptr);
  SplitFigures figures;
  for (SplitPoint* p : {&figures.chosen, &figures.best, &figures.local}) p->m = 0.1, p->ns_per_pixel = 500;
  figures.sweep = {figures.best, figures.best, figures.local};
  figures.sweep[0].m = 0, figures.sweep[0].bytes = 40'000, figures.sweep[2].m = 1, figures.sweep[2].device_pixels = 900;
  figures.local.ns_per_pixel = 9000;
  figures.paper.resize(2);
  for (PaperRow& row : figures.paper) row.scene = "a scene", row.ns_per_pixel = row.our_ns = row.bound_ns = 400;
  bool drawn[2];
  REQUIRE(draw_split(folder, {"it's a title", 1000}, figures, &drawn[0]).ok);
  REQUIRE(draw_fronts(folder, "it's a title", make_fronts(figures, {7000, 1100}, 1000),
                      {{1, 70, 0.1, 1}, {2, 90, 0.2, 2}}, &drawn[1])
              .ok);
  const bool has_gnuplot = std::system("gnuplot -V >/dev/null 2>&1") == 0;
  if (!has_gnuplot) MESSAGE("not drawn: no gnuplot");
  for (int i = 0; i < 2; ++i) {
    CHECK(drawn[i] == has_gnuplot);
    std::ifstream script(std::string(folder) + (i == 0 ? "/split.gnuplot" : "/fronts.gnuplot"));
    int lines = 0;
    for (std::string line; std::getline(script, line); ++lines) {
      CAPTURE(line);
      char open = 0;
      for (std::size_t k = 0; k < line.size(); ++k) {
        const char c = line[k];
        if (!open && (c == '\'' || c == '"')) {
          const bool after_word = k > 0 && std::isalnum(static_cast<unsigned char>(line[k - 1]));
          CHECK(!after_word);
          open = c;
        } else if (open == c) {
          open = 0;
        }
      }
      CHECK(open == 0);
    }
    CHECK(lines > 10);
  }
  std::filesystem::remove_all(folder);
}

// Goal: as clients are added to a server, [Aranha07] sec. 4, each gets less of it: frames take longer, the device's
// share grows, and nobody is slower than alone. Method: the paper's tablet and two processors.
TEST_CASE("fronts_show_what_clients_cost_each_other") {
  SplitSetup setup;
  const auto device = make_renderer(builtin_store().scenes[0].scene, Settings());
  setup.device = &device->renderer;
  setup.device_ns = 8841, setup.server_ns = 989;
  setup.line.bytes_per_second = 2'375'000, setup.line.latency_ns = 1'500'000;
  const std::vector<ClientsRow> rows = measure_clients(setup, 0.43);
  REQUIRE(rows.size() == 8);
  CHECK(rows[0].price == 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::printf("%2u clients: %.1f ms, m %.3f, price %.2f\n", rows[i].count, rows[i].ms, rows[i].m, rows[i].price);
    CHECK(rows[i].ms < 8841e-6 * 320 * 240);
    // A client's part of the server is the price's inverse: its frame at most a tenth longer than with that.
    const double part_ns = 989.0 * rows[i].count, ns = 8841 * part_ns / (8841 + part_ns);
    CHECK(rows[i].ms < 1.15 * ns * 320 * 240 * 1e-6);
    if (i == 0) continue;
    CHECK(rows[i].ms > rows[i - 1].ms);
    CHECK(rows[i].m > rows[i - 1].m);
    CHECK(rows[i].price > rows[i - 1].price);
  }
  CHECK(rows[7].price == doctest::Approx(16).epsilon(0.1));
}
