// A crowd: many clients of shared servers, in virtual time. Cost model, split, scheduler and prices are the program's
// own; pixels are only counted, so a thousand clients take seconds. Client and server learn about each other only from
// messages. Simultaneous events occur in the order in which they were planned: every run is identical.
#pragma once
#include <cstdint>
#include <vector>

#include "split/split.h"

namespace pocketray {

struct CrowdServer {
  double pixel_ns = 0;                                     // its time per pixel, with all its threads
  std::uint64_t begin_ns = 0, end_ns = ~std::uint64_t(0);  // when it joins and leaves
};

struct CrowdClient {
  double pixel_ns = 0;           // on the device
  double ns_per_byte = 0;        // of its link, which its servers share
  std::uint64_t latency_ns = 0;  // one way
  std::uint64_t begin_ns = 0, end_ns = ~std::uint64_t(0);
  std::uint32_t server_count = 0;
  std::uint32_t servers[kServerCountMax] = {};  // the ones it connects to, from top to bottom of the picture
};

struct Crowd {
  std::uint32_t row_pixels = 1280, row_count = 60;  // a row is four lines of 320 × 240, for speed
  double pixel_bytes = 0.43;                        // as `cornell` compresses; 33 kB per frame
  std::vector<CrowdServer> servers;
  std::vector<CrowdClient> clients;
  std::uint64_t end_ns = 0;    // of the simulation
  std::uint64_t watch_ns = 0;  // start of the measured period
};

// A client's figures from watch_ns on.
struct CrowdFigures {
  std::uint32_t frame_count = 0;
  double frame_ns = 0;      // mean
  double device_share = 0;  // mean m
  double change = 0;        // mean of |Δm| from frame to frame
  double work_ns = 0;       // server time spent on it
};

struct CrowdReport {
  std::vector<CrowdFigures> clients;
  std::vector<double> change_by_second;  // mean |Δm| of all frames that ended in that second
  std::vector<double> price_low,
      price_high;  // per server from watch_ns on, as stated to clients with rows; 0: none
};

CrowdReport simulate_crowd(const Crowd& crowd);

// Frame times at equilibrium, where each server's price is exact and each client's share is optimal at these prices: a
// fixed point computed centrally, for a fluid without rows, chunks or turns. Servers and clients that come or go count
// as present. ns, by client.
std::vector<double> crowd_equilibrium(const Crowd& crowd);

// Jain's index of fairness [Jain et al. 1984]: (Σx)² / (n · Σx²), from 1 / n, if one has everything, to 1, if all have
// equal amounts.
double jain_index(const std::vector<double>& amounts);

}  // namespace pocketray
