// The paper's cost function.
#include "split/closed_form.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <limits>

#include "support/hard_case.h"

using namespace pocketray;

// Goal: the closed form is the paper's. Method: [Aranha07] table 1, whose text gives T_t = 400 ns: shares to the last
// printed digit, times within 2 ns; also prints what overlapping would give.
TEST_CASE("closed_form_split_reproduces_table_1") {
  struct Row {
    const char* scene;
    int processors;
    double server_ns, device_ns, share_percent, ns_per_pixel, overlapped_ns;
  };
  const Row rows[] = {{"Cornell box", 2, 989, 8841, 13.58, 1200, 890}, {"Cornell box", 4, 585, 8841, 10.02, 886, 549},
                      {"Cornell box", 8, 325, 8841, 7.58, 669, 383},   {"Buddha", 2, 520, 6688, 12.09, 809, 482},
                      {"Buddha", 4, 390, 6688, 10.56, 706, 377},       {"Buddha", 8, 208, 6688, 8.33, 557, 377}};
  std::printf("%-12s %10s %14s %14s %18s\n", "scene", "processors", "share, paper", "time, paper",
              "share, time overlapped");
  for (const Row& row : rows) {
    PixelTimes times = {row.device_ns, row.server_ns, 400};
    ClosedSplit split = closed_form_split(times), overlapped = overlapped_split(times);
    std::printf("%-12s %10d %6.2f%% %5.2f%% %6.0f %6.0f ns %6.2f%% %6.0f ns\n", row.scene, row.processors,
                100 * split.device_share, row.share_percent, split.ns_per_pixel, row.ns_per_pixel,
                100 * overlapped.device_share, overlapped.ns_per_pixel);
    CHECK(std::fabs(100 * split.device_share - row.share_percent) <= 0.005 + 1e-9);
    CHECK(std::fabs(split.ns_per_pixel - row.ns_per_pixel) <= 2);
    CHECK(std::fabs(overlapped.ns_per_pixel - row.overlapped_ns) <= 1);
  }
}

// Goal: both sides finish together, and a server of no cost gets everything.
TEST_CASE("closed_form_split_balances_the_two_sides") {
  for (double device : {1.0, 300.0, 1e6})
    for (double server : {0.0, 1.0, 77.0, 1e5})
      for (double transfer : {0.0, 2.0, 400.0}) {
        ClosedSplit serial = closed_form_split({device, server, transfer});
        ClosedSplit both = overlapped_split({device, server, transfer});
        CHECK(serial.device_share * device == doctest::Approx((1 - serial.device_share) * (server + transfer)));
        CHECK(both.device_share * device == doctest::Approx((1 - both.device_share) * std::fmax(server, transfer)));
        CHECK(both.ns_per_pixel <= serial.ns_per_pixel);
        if (server + transfer <= 0) CHECK(serial.device_share == 0);
      }
}

// Goal: HARDCASES row 60 for the closed form. Method: every combination of invalid numbers.
TEST_CASE("hard_60_degenerate_times_closed_form_share_in_range") {
  const double inf = std::numeric_limits<double>::infinity();
  const double values[] = {0, -0.0, std::numeric_limits<double>::quiet_NaN(), inf, -inf, -1, 5e-324, 1e300, 400};
  for (double device : values)
    for (double server : values)
      for (double transfer : values)
        for (const ClosedSplit& split :
             {closed_form_split({device, server, transfer}), overlapped_split({device, server, transfer})}) {
          CHECK(split.device_share >= 0);
          CHECK(split.device_share <= 1);
          CHECK(std::isfinite(split.ns_per_pixel));
          CHECK(split.ns_per_pixel >= 0);
          if (!(server >= 0 && server < 1e300 && transfer >= 0 && transfer < 1e300)) CHECK(split.device_share == 1);
        }
  count_assertions("share in [0, 1], time finite");
}
