// What the model learns from measurements.
#include "split/cost_model.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include "split/own_model.h"
#include "split/split_oracle.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

const double kInfinity = std::numeric_limits<double>::infinity();
const double kBad[] = {0, -0.0, std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity, -1, 5e-324, 1e300};

// Whether the split is valid and its numbers are finite.
bool is_sound(const Split& split, std::uint32_t row_count) {
  for (std::uint32_t i = 0; i < split.server_count; ++i)
    if (split.boundary[i] > split.boundary[i + 1]) return false;
  return split.boundary[split.server_count] == row_count && split.time_ns < std::uint64_t(1) << 60 &&
         split.cost < std::uint64_t(1) << 60;
}

}  // namespace

// Goal: without measurements, and without a server, all rows are the device's.
TEST_CASE("cost_model_knows_nothing_all_rows_on_the_device") {
  OwnModel own(320, 240, 2);
  CHECK(own.plan().boundary[0] == 240);
  own.model.servers[0].connected = true;
  CHECK(own.plan().boundary[0] == 240);
  for (std::uint32_t r = 0; r < 240; ++r) observe_device_row(&own.model, r, 1e6);
  end_frame(&own.model);
  CHECK(own.plan().boundary[0] == 240);
  CHECK(own.plan().time_ns == doctest::Approx(240e6));
}

// Goal: the first estimate alone gives the paper's balance, overlapped. Method: Table 1, first row, chunks of one row.
TEST_CASE("cost_model_overture_gives_the_overlapped_share") {
  OwnModel own(320, 240, 1);
  own.model.servers[0].connected = true;
  own.model.servers[0].chunk_rows = 1;
  observe_overture(&own.model, 0, {8841, 989, 400}, 0.5, 0);
  Split split = own.plan();
  CHECK(std::fabs(split.boundary[0] / 240.0 - overlapped_split({8841, 989, 400}).device_share) < 1.5 / 240);
  own.model.servers[0].connected = false;
  CHECK(own.plan().boundary[0] == 240);
}

// Goal: rows cost what was measured. Method: the lower half is three times as expensive, on either side.
TEST_CASE("cost_model_learns_what_each_row_costs") {
  OwnModel own(320, 240, 1);
  own.model.servers[0].connected = true;
  observe_overture(&own.model, 0, {1000, 250, 10}, 1, 1000);
  auto true_ns = [](std::uint32_t row) { return row < 120 ? 320e3 : 960e3; };
  for (int frame = 0; frame < 12; ++frame) {
    std::uint32_t own_rows = own.plan().boundary[0];
    for (std::uint32_t r = 0; r < own_rows; ++r) observe_device_row(&own.model, r, true_ns(r));
    for (std::uint32_t r = own_rows; r < 240; r += 8) {
      double ns = 0;
      std::uint32_t end = r + 8 < 240 ? r + 8 : 240;
      for (std::uint32_t k = r; k < end; ++k) ns += true_ns(k) / 4;
      observe_server_rows(&own.model, 0, r, end, ns, 320 * (end - r));
    }
    end_frame(&own.model);
  }
  double upper = static_cast<double>(own.model.rows[10].device_ns.value);
  CHECK(upper == doctest::Approx(320e3).epsilon(0.02));
  CHECK(static_cast<double>(own.model.rows[200].device_ns.value * own.model.servers[0].speed.value) ==
        doctest::Approx(240e3).epsilon(0.05));
  // Balance: x rows of 320 against (120 − x) of 80 and 120 of 240, all in µs: x = 96.
  CHECK(own.plan().boundary[0] >= 92);
  CHECK(own.plan().boundary[0] <= 98);
}

// Goal: a throttled device is distinguished from a slower server. Method: all rows of the device take twice as long,
// the server's take the same: the server's relative speed doubles, and it gets more rows.
TEST_CASE("cost_model_tells_a_slow_device_from_a_slow_server") {
  for (bool device : {true, false}) {
    OwnModel own(320, 240, 1);
    own.model.servers[0].connected = true;
    observe_overture(&own.model, 0, {1000, 500, 10}, 1, 1000);
    std::uint32_t before = own.plan().boundary[0];
    for (int frame = 0; frame < 6; ++frame) {
      std::uint32_t rows = own.plan().boundary[0];
      for (std::uint32_t r = 0; r < rows; ++r) observe_device_row(&own.model, r, device ? 640e3 : 320e3);
      observe_server_rows(&own.model, 0, rows, 240, (240 - rows) * (device ? 160e3 : 320e3), 320 * (240 - rows));
      end_frame(&own.model);
    }
    double speed = static_cast<double>(own.model.servers[0].speed.value);
    CHECK(speed == doctest::Approx(device ? 0.25 : 1).epsilon(0.1));
    CHECK((own.plan().boundary[0] < before) == device);
  }
}

// Goal: the model learns that unchanged rows cost next to nothing to send.
TEST_CASE("cost_model_learns_that_rows_take_no_bytes") {
  OwnModel own(320, 240, 1);
  own.model.servers[0].connected = true;
  observe_overture(&own.model, 0, {1000, 100, 1000}, 1, 1000);
  std::uint32_t before = own.plan().boundary[0];
  for (int frame = 0; frame < 4; ++frame) {
    observe_server_rows(&own.model, 0, 0, 240, 240 * 320 * 100.0, 0);
    end_frame(&own.model);
  }
  CHECK(before > 100);
  CHECK(own.plan().boundary[0] < 30);
}

// Goal: a row is expected to take the bytes that it took last, since bytes have no noise.
TEST_CASE("cost_model_expects_the_bytes_of_the_last_frame") {
  OwnModel own(320, 240, 1);
  for (double bytes : {900.0, 850.0, 10.0, 12000.0}) {
    observe_server_rows(&own.model, 0, 10, 20, 1e6, bytes);
    end_frame(&own.model);
    for (std::uint32_t r = 10; r < 20; ++r) CHECK(own.model.rows[r].bytes.value == doctest::Approx(bytes / 10));
  }
}

// Goal: a frame's measurements count once. Method: a server that was slow in one frame is not made slower by frames in
// which it sends nothing.
TEST_CASE("cost_model_counts_measurements_once") {
  OwnModel own(320, 240, 1);
  observe_overture(&own.model, 0, {1000, 100, 10}, 1, 1000);
  float speed = own.model.servers[0].speed.value, per_byte = own.model.servers[0].ns_per_byte.value;
  observe_server_rows(&own.model, 0, 0, 240, 240 * 320 * 9000.0, 320 * 240);
  observe_transfer(&own.model, 0, 1000, 1e6);
  for (int frame = 0; frame < 5; ++frame) end_frame(&own.model);
  CHECK(own.model.servers[0].speed.value == speed);
  CHECK(own.model.servers[0].ns_per_byte.value == per_byte);
}

// Goal: money and energy affect the split: λ, and a cap that is kept whenever possible.
TEST_CASE("cost_model_weighs_time_against_cost") {
  OwnModel own(320, 240, 1);
  own.model.servers[0].connected = true;
  own.model.servers[0].cost_per_megabyte = 2;
  observe_overture(&own.model, 0, {1000, 100, 10}, 1, 1000);
  Split soonest = own.plan();
  SplitWish wish;
  wish.goal = SplitGoal::time_and_cost;
  CHECK(own.plan(wish).time_ns == soonest.time_ns);
  wish.ns_per_cost = 1e12;
  CHECK(own.plan(wish).boundary[0] == 240);
  // A row costs 2e-6 · 320 units and takes the device 320 µs: worth sending below 5e8 ns per unit, not above.
  wish.ns_per_cost = 4.9e8;
  CHECK(own.plan(wish).boundary[0] == soonest.boundary[0]);
  wish.ns_per_cost = 5.1e8;
  CHECK(own.plan(wish).boundary[0] == 240);
  wish.goal = SplitGoal::time_under_cap;
  double all_cost = 240 * 320 * 2e-6;
  for (double share : {0.0, 0.1, 0.5, 2.0}) {
    wish.cap = all_cost * share * (1 + 1e-6);
    Split split = own.plan(wish);
    CHECK(split.cap_met);
    CHECK((240 - split.boundary[0]) * 320 * 2e-6 <= wish.cap);
    if (share == 0.1) CHECK(split.boundary[0] == 216);
    if (share == 2.0) CHECK(split.boundary[0] == soonest.boundary[0]);
  }
  // The device's energy alone exceeds the cap: the cheapest split has all rows on the server.
  own.model.cost_per_device_pixel = 1, own.model.servers[0].cost_per_megabyte = 1e6;
  wish.cap = 1;
  Split cheapest = own.plan(wish);
  CHECK(!cheapest.cap_met);
}

// Goal: HARDCASES row 60: whatever the input, the split lies in [0, H] and its numbers are finite. Method: every
// combination of bad and good values in the six numbers of a first estimate and a wish; then in every observation.
TEST_CASE("hard_60_degenerate_measurements_split_in_range") {
  double values[9];
  for (int i = 0; i < 8; ++i) values[i] = kBad[i];
  values[8] = 300;
  OwnModel own(4, 3, 1);
  std::uint64_t wrong = 0, count = 0;
  int step = whole_gate() ? 1 : 7;  // stride through all combinations; coprime to 9
  for (int code = 0; code < 9 * 9 * 9 * 9 * 9 * 9; code += step) {
    double v[6];
    for (int i = 0, rest = code; i < 6; ++i, rest /= 9) v[i] = values[rest % 9];
    own.reset();
    own.model.servers[0].connected = true;
    own.model.servers[0].cost_per_megabyte = v[5];
    observe_overture(&own.model, 0, {v[0], v[1], v[2]}, v[3], v[4]);
    SplitWish wish;
    wish.goal = static_cast<SplitGoal>(code / step % 3), wish.ns_per_cost = wish.cap = v[5];
    wrong += !is_sound(own.plan(wish), 3), ++count;
  }
  CHECK(wrong == 0);
  count_hard(count, wrong, "split in [0, H], finite");
}

// Goal: the same for observations frame by frame: bad numbers change nothing, so the split stays.
TEST_CASE("hard_60_degenerate_observations_split_in_range") {
  for (double bad : kBad) {
    OwnModel own(320, 240, 2);
    for (std::uint32_t s = 0; s < 2; ++s) {
      own.model.servers[s].connected = true;
      observe_overture(&own.model, s, {1000, 200, 50}, 1, 1e6);
    }
    Split before = own.plan();
    for (int frame = 0; frame < 5; ++frame) {
      for (std::uint32_t r = 0; r < 100; ++r) observe_device_row(&own.model, r, bad);
      for (std::uint32_t s = 0; s < 2; ++s) {
        observe_server_rows(&own.model, s, 100 + 70 * s, 170 + 70 * s, bad, bad);
        observe_transfer(&own.model, s, bad, 1000), observe_transfer(&own.model, s, 1000, bad);
        observe_start(&own.model, s, bad), observe_server_speed(&own.model, s, bad);
      }
      observe_server_rows(&own.model, 0, 50, 50, 100, 100);
      observe_device_start(&own.model, bad), observe_unpack(&own.model, bad, 1), observe_unpack(&own.model, 1, bad);
      observe_link(&own.model, bad, 1), observe_link(&own.model, 1, bad);
      end_frame(&own.model);
      Split split = own.plan();
      CHECK(is_sound(split, 240));
      if (!(bad >= 0 && bad < 1)) CHECK(split.boundary[0] == before.boundary[0]);
    }
  }
  count_assertions("split in [0, H], finite");
}

// Goal: a busy server gets fewer rows: at twice the price as many as at half the speed. A stated price counts in full
// for a new connection, later by a quarter of the difference a frame, and a lie as no more than the largest price.
TEST_CASE("cost_model_counts_a_server_at_its_price") {
  OwnModel own(320, 240, 1), slow(320, 240, 1);
  for (OwnModel* m : {&own, &slow}) m->model.servers[0].connected = true;
  observe_price(&own.model, 0, 2);
  observe_overture(&own.model, 0, {1000, 200, 50}, 1, 1e6);
  observe_overture(&slow.model, 0, {1000, 400, 50}, 1, 1e6);
  CHECK(own.plan().boundary[0] == slow.plan().boundary[0]);
  const ServerModel& server = own.model.servers[0];
  observe_price(&own.model, 0, 6);
  CHECK(server.price == 2);
  end_frame(&own.model);
  CHECK(server.price == 3);
  end_frame(&own.model);
  CHECK(server.price == 3.75f);
  const std::uint32_t rows = own.plan().boundary[0];
  CHECK(rows > slow.plan().boundary[0]);
  for (double lie : {std::nan(""), 0.0, -1.0, 0.5, -HUGE_VAL}) {
    observe_price(&own.model, 0, lie);
    CHECK(server.price_stated == 1);
  }
  for (double lie : {1e30, HUGE_VAL}) {
    observe_price(&own.model, 0, lie);
    CHECK(server.price_stated == kPriceMax);
  }
}

// Goal: no rows, one row, no servers.
TEST_CASE("cost_model_of_few_rows") {
  for (std::uint32_t rows : {0u, 1u, 2u})
    for (std::uint32_t servers : {0u, 1u, 8u}) {
      OwnModel own(320, rows, servers);
      for (std::uint32_t s = 0; s < servers; ++s) {
        own.model.servers[s].connected = true;
        observe_overture(&own.model, s, {1000, 200, 50}, 1, 1e3);
      }
      CHECK(is_sound(own.plan(), rows));
      end_frame(&own.model);
      CHECK(is_sound(own.plan(), rows));
    }
}

TEST_CASE("cost_model_need_is_what_it_takes") {
  std::vector<std::uint8_t> block(1 << 22);
  for (std::uint32_t rows : {0u, 1u, 240u, 8192u})
    for (std::uint32_t servers : {0u, 1u, 8u}) {
      Arena arena = make_arena("model", block.data(), block.size());
      make_cost_model(320, rows, servers, &arena);
      CHECK(arena.used == cost_model_need(rows, servers));
    }
}

// Goal: a row costs its holder the part that may have changed, and anyone else all of it; small parts do not change
// what a whole row is known to cost. Method: a server as fast as the device; shares by hand.
TEST_CASE("cost_model_prices_what_can_have_changed") {
  OwnModel own(100, 40, 1);
  own.model.servers[0].connected = true;
  own.model.servers[0].chunk_rows = 1;
  observe_overture(&own.model, 0, {1000, 1000, 1}, 1, 0);
  auto follow = [&](std::uint32_t device_rows, double part) {
    for (std::uint32_t r = 0; r < device_rows; ++r) observe_device_row(&own.model, r, 1e5 * part * 1.7, part);
    observe_server_rows(&own.model, 0, device_rows, 40, 1e5 * part * 1.7 * (40 - device_rows), 100, part);
    end_frame(&own.model);
  };
  for (std::uint32_t r = 0; r < 40; ++r) observe_device_row(&own.model, r, 1e5);
  observe_server_rows(&own.model, 0, 20, 40, 20e5, 100);
  end_frame(&own.model);
  CHECK(own.plan().boundary[0] == 20);
  for (std::uint32_t held : {4u, 20u, 36u}) {
    CAPTURE(held);
    for (int i = 0; i < 3; ++i) follow(held, 0.01);
    for (std::uint32_t r = 0; r < 40; ++r) own.model.rows[r].device_part = r < held ? 0.01f : 1;
    const SplitProblem p = make_problem(&own.model, SplitWish());
    CHECK(p.device_ns[held] == doctest::Approx(held * 1e3).epsilon(0.01));
    CHECK(p.device_ns[40] - p.device_ns[held] == doctest::Approx((40 - held) * 1e5).epsilon(0.01));
    CHECK(p.servers[0].render_ns[held] == doctest::Approx(held * 1e5).epsilon(0.01));
    CHECK(p.servers[0].render_ns[40] - p.servers[0].render_ns[held] ==
          doctest::Approx((40 - held) * 1e3).epsilon(0.01));
    CHECK(find_split(p, &own.workspace).boundary[0] == held);
  }
  end_frame(&own.model);  // the server had no rows: it holds none
  CHECK(make_problem(&own.model, SplitWish()).servers[0].render_ns[40] == doctest::Approx(40e5).epsilon(0.01));
}

// Goal: rows with the device's own light cost what they took, the whole rows' prices stay, and the other way round.
// Method: a frame of whole rows, then frames of own light that take .6 of it.
TEST_CASE("cost_model_prices_rows_of_own_light") {
  OwnModel own(320, 240, 1);
  CostModel* m = &own.model;
  m->servers[0].connected = true;
  observe_overture(m, 0, {1000, 100, 10}, 1, 1000);
  auto row_ns = [](std::uint32_t r) { return r < 120 ? 1e5 : 3e5; };
  auto frame = [&](double part, bool by_effect) {
    for (std::uint32_t r = 0; r < 240; ++r) observe_device_row(m, r, part * row_ns(r));
    end_frame(m, by_effect);
  };
  for (int i = 0; i < 3; ++i) frame(1, false);
  const SplitProblem whole = make_problem(m, SplitWish());
  const std::uint64_t whole_ns = whole.device_ns[240];
  CHECK(whole_ns == doctest::Approx(48e6).epsilon(1e-5));
  for (int i = 0; i < 4; ++i) {
    frame(0.6, true);
    CHECK(m->light.own_part.value == doctest::Approx(0.6f).epsilon(1e-5));
    CHECK(make_problem(m, SplitWish()).device_ns[240] == doctest::Approx(48e6).epsilon(1e-5));
  }
  const SplitProblem lit = make_problem(m, SplitWish(), {0.6, ~0u});
  CHECK(lit.device_ns[240] == doctest::Approx(28.8e6).epsilon(1e-5));
  CHECK(lit.device_least_ns == 0);
  frame(1, false);
  CHECK(make_problem(m, SplitWish()).device_ns[240] == doctest::Approx(48e6).epsilon(1e-5));
}

// Goal: the server that maps the light begins its rows later, by its work on the map and the map's bytes; these take
// the shared link, too; and the device waits for the map.
TEST_CASE("cost_model_counts_the_map") {
  OwnModel own(320, 240, 2);
  CostModel* m = &own.model;
  for (std::uint32_t i = 0; i < 2; ++i) {
    m->servers[i].connected = true;
    observe_overture(m, i, {1000, 100, 10}, 1, 1000);
  }
  observe_own_link(m, 5);
  const SplitProblem without = make_problem(m, SplitWish());
  const std::uint64_t start = without.servers[1].start_ns, link_start = without.link_start_ns;
  observe_map(m, 7e6, 2000, 12e6);
  const SplitProblem unasked = make_problem(m, SplitWish());
  CHECK(unasked.servers[1].start_ns == start);
  CHECK(unasked.device_least_ns == 0);
  const SplitProblem p = make_problem(m, SplitWish(), {0.5, 1});
  CHECK(p.servers[0].start_ns == start);
  CHECK(p.servers[1].start_ns == start + 7'000'000 + 2000 * 10);
  CHECK(p.link_start_ns == link_start + 2000 * 5);
  CHECK(p.device_least_ns == 12'000'000);
}
