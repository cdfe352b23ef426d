// Costs of a frame besides time: the device's energy, and bytes, which some links charge for ([Aranha07] sec. 5). A
// front has the shares that no other beats in both; which of them is best depends on the value of a millisecond.
#pragma once
#include <string>
#include <vector>

#include "desktop/split_report/split_report.h"

namespace pocketray {

// Energy of the device above idle.
struct DeviceEnergy {
  double pixel_nanojoules = 0;    // to render a pixel
  double byte_nanojoules = 0;     // to receive a byte
  double prepare_nanojoules = 0;  // to prepare a frame
};

struct FrontPoint {
  double m = 0, ms = 0, cost = 0;  // per frame; cost: millijoules or kilobytes
  bool on_front = false;
};

struct Fronts {
  std::vector<FrontPoint> energy, bytes;  // the measured shares, by m
};

// Marks the points that no other beats in both time and cost; of equal points the first.
void mark_front(std::vector<FrontPoint>* points);
// Makes the fronts from the sweep's shares.
Fronts make_fronts(const SplitFigures& figures, const DeviceEnergy& energy, std::uint32_t pixel_count);

// One server and one to 16 devices like the report's, each at its own best share: means over all their frames.
struct ClientsRow {
  std::uint32_t count = 0;
  double ms = 0, m = 0, price = 0;  // price: the highest that the server stated; 0: it got no rows
};
// Simulates them with crowd.h, with equal times for all rows. pixel_bytes: as the rows compress.
std::vector<ClientsRow> measure_clients(const SplitSetup& setup, double pixel_bytes);

// Writes fronts.csv, and fronts.gnuplot, which draws fronts.png. *drawn: whether gnuplot succeeded.
Status write_fronts_csv(const std::string& folder, const Fronts& fronts, const std::vector<ClientsRow>& clients);
Status draw_fronts(const std::string& folder, const std::string& title, const Fronts& fronts,
                   const std::vector<ClientsRow>& clients, bool* drawn);

}  // namespace pocketray
