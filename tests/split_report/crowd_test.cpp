// Many clients of many servers: each client's own best split, at the prices that servers state, balances their load.
#include "desktop/split_report/crowd.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/rng.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

// Between low and high, each factor as likely as another.
double draw(Rng* rng, double low, double high) { return low * std::pow(high / low, next_double(rng)); }

struct CrowdShape {
  std::uint32_t clients, servers, connections;  // connections: of each client, at most
  double seconds, watched;                      // watched: of these, at the end
};

// Handhelds of all speeds, links from a slow to a fast radio, servers of one to sixteen cores. A half of the clients
// starts at once, the others within the first quarter.
Crowd draw_crowd(const CrowdShape& shape, Rng* rng) {
  Crowd crowd;
  crowd.end_ns = static_cast<std::uint64_t>(shape.seconds * kSecond);
  crowd.watch_ns = static_cast<std::uint64_t>((shape.seconds - shape.watched) * kSecond);
  for (std::uint32_t i = 0; i < shape.servers; ++i) {
    CrowdServer server;
    server.pixel_ns = draw(rng, 60, 1000);
    crowd.servers.push_back(server);
  }
  for (std::uint32_t i = 0; i < shape.clients; ++i) {
    CrowdClient c;
    c.pixel_ns = draw(rng, 2000, 40'000);
    c.ns_per_byte = draw(rng, 100, 2000);
    c.latency_ns = static_cast<std::uint64_t>(draw(rng, 5e5, 1e7));
    if (i % 2) c.begin_ns = static_cast<std::uint64_t>(next_double(rng) * static_cast<double>(crowd.end_ns) / 4);
    while (c.server_count < std::min(shape.connections, shape.servers)) {
      const std::uint32_t server = next_u32(rng) % shape.servers;
      if (std::find(c.servers, c.servers + c.server_count, server) == c.servers + c.server_count)
        c.servers[c.server_count++] = server;
    }
    crowd.clients.push_back(c);
  }
  return crowd;
}

struct Verdict {
  double over = 0;                      // mean frame time over the equilibrium's, less 1
  double fairness = 0;                  // Jain's index of the equilibrium's frame time over the measured one
  double change = 0, worst_change = 0;  // of m from frame to frame: mean of all clients, of the worst one
  double swing = 0;                     // of the worst server's price, highest over lowest
  double gain = 0;                      // mean of the device's time alone over the frame's
  int settled = 0;                      // second from which on m changes by less than 2 % a frame
};

// `there`: the crowd as it is in the end.
Verdict judge(const Crowd& crowd, const Crowd& there, const char* name) {
  const CrowdReport report = simulate_crowd(crowd);
  const std::vector<double> best = crowd_equilibrium(there);
  Verdict v;
  std::vector<double> parts;
  double sum = 0, best_sum = 0;
  for (std::size_t i = 0; i < crowd.clients.size(); ++i) {
    const CrowdFigures& f = report.clients[i];
    REQUIRE(f.frame_count > 0);
    sum += f.frame_ns, best_sum += best[i];
    parts.push_back(best[i] / f.frame_ns);
    v.change += f.change / static_cast<double>(crowd.clients.size());
    v.worst_change = std::max(v.worst_change, f.change);
    v.gain += crowd.clients[i].pixel_ns * crowd.row_pixels * crowd.row_count / f.frame_ns /
              static_cast<double>(crowd.clients.size());
  }
  v.over = sum / best_sum - 1, v.fairness = jain_index(parts);
  for (std::size_t i = 0; i < crowd.servers.size(); ++i)
    if (report.price_low[i] > 0) v.swing = std::max(v.swing, report.price_high[i] / report.price_low[i]);
  for (std::size_t second = 0; second < report.change_by_second.size(); ++second)
    if (report.change_by_second[second] >= 0.02) v.settled = static_cast<int>(second) + 1;
  std::printf(
      "%-40s frames %.1f %% over the equilibrium's, fairness %.4f; m moves by %.2f %% a frame, at most %.2f %%, "
      "by less than 2 %% from second %d; price swings %.2f-fold; %.2f times as fast as alone\n",
      name, 100 * v.over, v.fairness, 100 * v.change, 100 * v.worst_change, v.settled, v.swing, v.gain);
  return v;
}
Verdict judge(const Crowd& crowd, const char* name) { return judge(crowd, crowd, name); }

// Clients that are all alike, start together and have the same servers: whatever one does, all do.
Crowd make_herd(std::uint32_t clients, std::uint32_t servers, double device_ns, double server_ns, double seconds) {
  Crowd crowd;
  crowd.end_ns = static_cast<std::uint64_t>(seconds * kSecond), crowd.watch_ns = crowd.end_ns / 2;
  crowd.servers.resize(servers);
  for (CrowdServer& server : crowd.servers) server.pixel_ns = server_ns;
  CrowdClient c;
  c.pixel_ns = device_ns, c.ns_per_byte = 200, c.latency_ns = 2'000'000, c.server_count = servers;
  for (std::uint32_t i = 0; i < servers; ++i) c.servers[i] = i;
  crowd.clients.assign(clients, c);
  return crowd;
}

}  // namespace

// Goal: a thousand unequal clients of fifty unequal servers settle, without oscillation, near the equilibrium, and each
// as near as the others. Method: over the last third, shares move by less than 2 % a frame, on average and of every
// client; frames take at most 10 % longer than at prices that are true; Jain's index of what each gets of that.
TEST_CASE("crowd_of_a_thousand_clients_settles") {
  Rng rng = make_rng(16);
  const CrowdShape shape = {1000u / kEffortDivisor, std::max(2u, 50u / kEffortDivisor), 3, 24, 8};
  const Verdict v = judge(draw_crowd(shape, &rng), "1,000 clients, 50 servers");
  CHECK(v.settled <= 12);
  CHECK(v.change < 0.002);
  CHECK(v.worst_change < 0.02);
  CHECK(v.over < 0.1);
  CHECK(v.fairness > 0.98);
}

// Goal: so do small crowds of any shape.
TEST_CASE("crowd_small_ones_settle") {
  for (std::uint64_t seed = 1; seed <= std::uint64_t(effort(12)); ++seed) {
    Rng rng = make_rng(seed);
    const CrowdShape shape = {1 + next_u32(&rng) % 60, 1 + next_u32(&rng) % 8, 1 + next_u32(&rng) % 4, 24, 8};
    char name[80];
    std::snprintf(name, sizeof name, "%u clients, %u servers, %u of them each", shape.clients, shape.servers,
                  std::min(shape.connections, shape.servers));
    const Verdict v = judge(draw_crowd(shape, &rng), name);
    CHECK(v.change < 0.005);
    CHECK(v.worst_change < 0.02);
    CHECK(v.over < 0.1);
    CHECK(v.fairness > 0.95);
  }
}

// Goal: clients that all answer the same price alike do not make it swing. Method: herds of identical clients. Quick
// frames are many in the server's moving average; where one frame is longer than that, a client's inertia settles the
// share.
TEST_CASE("crowd_of_identical_clients_does_not_swing") {
  struct Case {
    std::uint32_t clients, servers;
    double device_ns, server_ns, seconds, swing_max;
  };
  const Case cases[] = {
      {4, 3, 500, 200, 20, 1.5}, {16, 2, 1000, 200, 20, 2}, {40, 3, 1000, 1000, 20, 3}, {4, 2, 60'000, 8000, 300, 20}};
  for (const Case& c : cases) {
    char name[80];
    std::snprintf(name, sizeof name, "%u alike, %u servers, %.0f and %.0f ns", c.clients, c.servers, c.device_ns,
                  c.server_ns);
    const Verdict v = judge(make_herd(c.clients, c.servers, c.device_ns, c.server_ns, c.seconds), name);
    CHECK(v.worst_change < 0.02);
    CHECK(v.swing < c.swing_max);
    CHECK(v.over < 0.1);
  }
}

// Goal: a crowd follows servers that leave and come. Method: of six servers, the first leaves, and the last comes,
// after a third of the time; in the last third frames are near the equilibrium of those that are there.
TEST_CASE("crowd_follows_servers_that_come_and_go") {
  Rng rng = make_rng(5);
  Crowd crowd = draw_crowd({40, 6, 4, 24, 8}, &rng), there = crowd;
  crowd.servers[0].end_ns = crowd.servers[5].begin_ns = crowd.end_ns / 3;
  there.servers[0].pixel_ns = 1e9;
  const Verdict v = judge(crowd, there, "servers that come and go");
  CHECK(v.worst_change < 0.02);
  CHECK(v.over < 0.1);
  CHECK(v.fairness > 0.95);
}
