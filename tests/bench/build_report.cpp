#include "bench/build_report.h"

#include <cstdio>

namespace pocketray {
namespace {

std::string cell(double value, int decimals) {
  if (value < 0) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

// null if not measured
nlohmann::ordered_json figure(double value) {
  return value < 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(value);
}

}  // namespace

void print_builds(const std::vector<BuildRow>& rows) {
  std::printf(
      "\nstructures: CPU ms to build and to refit; bytes per triangle of structure + mesh; two threads against one;\n"
      "primary/shadow/bounce rays per second against our default; ns per pixel of a whole frame at 320x240\n");
  std::printf("%-10s %-21s %9s %8s %15s %8s %8s %15s %9s\n", "scene", "structure", "triangles", "build",
              "bytes/triangle", "refit", "2 thr.", "speed", "frame");
  for (const BuildRow& r : rows) {
    std::string bytes = cell(r.accel_bytes_per_triangle, 1) + " + " + cell(r.mesh_bytes_per_triangle, 1);
    std::string speed =
        r.speed[0] < 0 ? "-" : cell(r.speed[0], 2) + "/" + cell(r.speed[1], 2) + "/" + cell(r.speed[2], 2);
    std::printf("%-10s %-21s %9u %8s %15s %8s %8s %15s %9s\n", r.scene.c_str(), r.builder.c_str(), r.triangles,
                cell(r.build_ms, 2).c_str(), bytes.c_str(), cell(r.refit_ms, 2).c_str(), cell(r.two_threads, 2).c_str(),
                speed.c_str(), cell(r.frame_ns_per_pixel, 0).c_str());
  }
  std::fflush(stdout);
}

nlohmann::ordered_json builds_json(const std::vector<BuildRow>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BuildRow& r : rows)
    list.push_back({{"scene", r.scene},
                    {"builder", r.builder},
                    {"triangles", r.triangles},
                    {"build_ms", figure(r.build_ms)},
                    {"accel_bytes_per_triangle", r.accel_bytes_per_triangle},
                    {"mesh_bytes_per_triangle", r.mesh_bytes_per_triangle},
                    {"refit_ms", figure(r.refit_ms)},
                    {"two_threads", figure(r.two_threads)},
                    {"primary_speed", figure(r.speed[0])},
                    {"shadow_speed", figure(r.speed[1])},
                    {"bounce_speed", figure(r.speed[2])},
                    {"frame_ns_per_pixel", figure(r.frame_ns_per_pixel)}});
  return list;
}

}  // namespace pocketray
