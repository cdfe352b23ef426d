#include "desktop/split_report/fronts.h"

#include <algorithm>
#include <cstdio>

#include "base/check.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/split_report/crowd.h"
#include "session/gnuplot.h"
#include "session/output.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kClientCounts[] = {1, 2, 3, 4, 6, 8, 12, 16};
constexpr std::uint32_t kCrowdRows = 60;                // maximum number of parts of a picture: whole lines each
constexpr std::uint64_t kStaggerNs = 37'000'000;        // between starts; chosen: no multiple of a frame time
constexpr double kSettleNs = 8e9, kWatchedFrames = 20;  // before measuring; of the device alone, after that

void append_line(std::string* text, const char* pattern, double a, double b, double c) {
  char line[160];
  std::snprintf(line, sizeof line, pattern, a, b, c);
  *text += line;
}

void write_data(std::string* f, const char* name, const std::vector<FrontPoint>& points) {
  for (bool front : {false, true}) {
    *f += std::string("$") + name + (front ? "_front" : "") + " << EOD\n";
    std::vector<FrontPoint> chosen;
    for (const FrontPoint& p : points)
      if (p.on_front || !front) chosen.push_back(p);
    std::sort(chosen.begin(), chosen.end(), [](const FrontPoint& a, const FrontPoint& b) { return a.ms < b.ms; });
    for (const FrontPoint& p : chosen) append_line(f, "%.6g %.6g %.4f\n", p.ms, p.cost, p.m);
    *f += "EOD\n";
  }
}

void write_front_plot(std::string* f, const char* name, const char* title, const char* unit, const char* key) {
  *f += std::string("set title '") + title + "'\nset xlabel 'milliseconds per frame, logarithmic'\nset ylabel '" +
        unit + "'\nset logscale x\nset autoscale\nset yrange [0:*]\nset key " + key + " nobox\nplot $" + name +
        " using 1:2 title 'shares measured' with points pt 7 ps 0.7 lc rgb '#aaaaaa', \\\n  $" + name +
        "_front using 1:2 title 'Pareto front, labelled with m' with linespoints pt 7 lw 2 lc rgb '#d62728', \\\n  $" +
        name + "_front using 1:2:(sprintf(' %.2f', $3)) notitle with labels left offset 0.3,0.6 font ',8'\n";
}

void write_clients_plot(std::string* f, const std::vector<ClientsRow>& clients) {
  *f += "$clients << EOD\n";
  for (const ClientsRow& row : clients) append_line(f, "%.0f %.6g %.4f\n", row.count, row.ms, row.m);
  *f +=
      "EOD\nset title 'One server, many clients'\nset xlabel 'clients'\nset ylabel 'milliseconds per frame'\n"
      "unset logscale x\nset autoscale\nset yrange [0:*]\nset y2range [0:1]\nset y2tics\nset ytics nomirror\n"
      "set y2label \"m: the device's share of the rows\"\nset key bottom right nobox\n"
      "plot $clients using 1:2 title 'frame time' with linespoints pt 7 lw 2 lc rgb '#d62728', \\\n"
      "  $clients using 1:3 axes x1y2 title 'm' with linespoints pt 5 lw 2 lc rgb '#1f6fb4'\n";
}

}  // namespace

void mark_front(std::vector<FrontPoint>* points) {
  for (std::size_t i = 0; i < points->size(); ++i) {
    FrontPoint* p = &(*points)[i];
    p->on_front = true;
    for (std::size_t k = 0; k < points->size(); ++k) {
      const FrontPoint& q = (*points)[k];
      const bool no_worse = q.ms <= p->ms && q.cost <= p->cost, better = q.ms < p->ms || q.cost < p->cost;
      if (k != i && no_worse && (better || k < i)) p->on_front = false;
    }
  }
}

Fronts make_fronts(const SplitFigures& figures, const DeviceEnergy& energy, std::uint32_t pixel_count) {
  CHECK_GT(pixel_count, 0u);
  CHECK(energy.pixel_nanojoules >= 0 && energy.byte_nanojoules >= 0);
  Fronts fronts;
  for (const SplitPoint& p : figures.sweep) {
    const double ms = p.ns_per_pixel * pixel_count * 1e-6;
    const double nanojoules = p.device_pixels * energy.pixel_nanojoules + p.bytes * energy.byte_nanojoules +
                              p.prepared * energy.prepare_nanojoules;
    fronts.energy.push_back({p.m, ms, nanojoules * 1e-6, false});
    fronts.bytes.push_back({p.m, ms, p.bytes * 1e-3, false});
  }
  mark_front(&fronts.energy), mark_front(&fronts.bytes);
  return fronts;
}

std::vector<ClientsRow> measure_clients(const SplitSetup& setup, double pixel_bytes) {
  CHECK(pixel_bytes > 0 && setup.device_ns > 0 && setup.server_ns > 0);
  const std::uint32_t width = setup.device->settings.width, height = setup.device->settings.height;
  const std::uint32_t lines = (height + kCrowdRows - 1) / kCrowdRows;
  Crowd crowd;
  crowd.row_pixels = width * lines, crowd.row_count = (height + lines - 1) / lines;
  crowd.pixel_bytes = pixel_bytes;
  crowd.servers.resize(1);
  crowd.servers[0].pixel_ns = setup.server_ns;
  CrowdClient c;
  c.pixel_ns = setup.device_ns;
  c.ns_per_byte = setup.line.bytes_per_second > 0 ? 1e9 / static_cast<double>(setup.line.bytes_per_second) : 1e-3;
  c.latency_ns = setup.line.latency_ns;
  c.server_count = 1;
  const double alone_ns = setup.device_ns * crowd.row_pixels * crowd.row_count;
  crowd.watch_ns = static_cast<std::uint64_t>(kSettleNs + kWatchedFrames * alone_ns);
  crowd.end_ns = crowd.watch_ns + static_cast<std::uint64_t>(kSettleNs + kWatchedFrames * alone_ns);
  std::vector<ClientsRow> rows;
  for (std::uint32_t count : kClientCounts) {
    while (crowd.clients.size() < count) {
      c.begin_ns = kStaggerNs * crowd.clients.size();
      crowd.clients.push_back(c);
    }
    const CrowdReport report = simulate_crowd(crowd);
    ClientsRow row;
    row.count = count;
    for (const CrowdFigures& figures : report.clients) {
      CHECK_GT(figures.frame_count, 0u);
      row.ms += figures.frame_ns * 1e-6 / count, row.m += figures.device_share / count;
    }
    row.price = report.price_high[0];
    rows.push_back(row);
  }
  return rows;
}

Status write_fronts_csv(const std::string& folder, const Fronts& fronts, const std::vector<ClientsRow>& clients) {
  std::string text = "front,m,ms_per_frame,cost\n";
  for (const FrontPoint& p : fronts.energy)
    if (p.on_front) append_line(&text, "millijoules,%.5f,%.4f,%.4f\n", p.m, p.ms, p.cost);
  for (const FrontPoint& p : fronts.bytes)
    if (p.on_front) append_line(&text, "kilobytes,%.5f,%.4f,%.4f\n", p.m, p.ms, p.cost);
  for (const ClientsRow& row : clients) append_line(&text, "clients,%.5f,%.4f,%.0f\n", row.m, row.ms, row.count);
  return write_file(folder + "/fronts.csv", text);
}

Status draw_fronts(const std::string& folder, const std::string& title, const Fronts& fronts,
                   const std::vector<ClientsRow>& clients, bool* drawn) {
  std::string text = "set terminal pngcairo size 1500,560 font 'sans,11' noenhanced\nset output 'fronts.png'\n";
  write_data(&text, "energy", fronts.energy), write_data(&text, "bytes", fronts.bytes);
  text +=
      "set multiplot layout 1,3 title " + gnuplot_lines(title, 180) + " font 'sans,13'\nset grid lc rgb '#dddddd'\n";
  write_front_plot(&text, "energy", "Time against energy", "millijoules per frame, above idle", "top left");
  write_front_plot(&text, "bytes", "Time against price", "kilobytes per frame, which a link may charge for",
                   "bottom left");
  write_clients_plot(&text, clients);
  text += "unset multiplot\n";
  RETURN_IF_ERROR(write_file(folder + "/fronts.gnuplot", text));
  *drawn = run_gnuplot(folder, {"fronts.gnuplot"});
  return success();
}

}  // namespace pocketray
