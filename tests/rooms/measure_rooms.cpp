// measure_rooms [--random N] [--seed N] [--gaps] [--noise SHARE] [--rounds N] [--patches N] [--lights] [--regions]
// [--truths DIR] [FILE...]: the table of `make rooms`. Indirect light of rooms against full light transport: relative
// errors of regions of the picture by radiosity and, on request, by instant radiosity with more and more lights.
// `--regions` prints the error of each region, `--truths` keeps what is known of a room's truth for the next time. See
// tests/radiosity/reference/room_light.h.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#ifdef POCKETRAY_HAVE_IMPORT
#include "session/model_import.h"
#endif
#include "plan/plan_scene.h"
#include "radiosity/reference/room_light.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kLightCounts[] = {64, 128, 256, 512};

// Keeps truths as raw numbers.
bool read_truth(const std::string& path, RoomLight* truth) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return false;
  truth->columns = 8, truth->rows = 6;
  bool ok = true;
  for (std::vector<double>* part : {&truth->sum, &truth->error, &truth->half[0], &truth->half[1]}) {
    part->resize(std::size_t(truth->columns) * truth->rows);
    ok = ok && std::fread(part->data(), sizeof(double), part->size(), file) == part->size();
  }
  std::fclose(file);
  return ok;
}
void write_truth(const std::string& path, const RoomLight& truth) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return;
  for (const std::vector<double>* part : {&truth.sum, &truth.error, &truth.half[0], &truth.half[1]})
    std::fwrite(part->data(), sizeof(double), part->size(), file);
  std::fclose(file);
}

void print_regions(const RoomLight& found, const RoomLight& truth) {
  for (std::uint32_t row = 0; row < truth.rows; ++row) {
    for (std::uint32_t column = 0; column < truth.columns; ++column) {
      const std::size_t i = std::size_t(row) * truth.columns + column;
      std::printf(" %+6.1f (%7.2f)", truth.sum[i] > 0 ? 100 * (found.sum[i] / truth.sum[i] - 1) : 0.0, truth.sum[i]);
    }
    std::printf("\n");
  }
}

struct Measurement {
  TruthOptions truth = {64, 8, .007};
  std::uint32_t patches = 1200;
  bool lights = false, regions = false;
  std::string truths;
  int rooms = 0, failed = 0;
  double sum_of_means = 0, worst = 0;

  RoomLight truth_of(const char* name, const Scene& scene, const Settings& settings) {
    RoomLight light;
    const std::string path = truths + "/" + name;
    if (!truths.empty() && read_truth(path, &light)) return light;
    light = true_light(scene, settings, truth);
    if (!truths.empty()) write_truth(path, light);
    return light;
  }

  void measure(const char* name, const Scene& scene) {
    const Settings settings = room_settings(64, 48);
    const RoomLight light = truth_of(name, scene, settings);
    StoredCost cost;
    const RoomLight stored = stored_light(scene, settings, patches, 2, &cost);
    const RoomErrors e = compare_light(stored, light);
    const bool holds = e.mean <= .03 && std::fabs(e.worst) <= .1;
    ++rooms, failed += !holds, sum_of_means += e.mean;
    if (std::fabs(e.worst) > std::fabs(worst)) worst = e.worst;
    std::printf("| %s | %.1f | %+.1f ± %.1f at %u, %u | %+.1f | %.1f | %u | %.2f | %.1f |", name, 100 * e.mean,
                100 * e.worst, 100 * e.worst_noise, static_cast<unsigned>(e.region % light.columns),
                static_cast<unsigned>(e.region / light.columns), 100 * e.total, 100 * e.noise, cost.patches,
                static_cast<double>(cost.bytes) / (1 << 20), cost.seconds);
    if (lights)
      for (std::uint32_t count : kLightCounts)
        std::printf(" %.1f |", 100 * compare_light(instant_light(scene, settings, count), light).mean);
    std::printf("%s\n", holds ? "" : "  <-");
    if (regions) print_regions(stored, light);
    std::fflush(stdout);
  }
};

#ifdef POCKETRAY_HAVE_IMPORT
void measure_file(const std::string& path, Measurement* m) {
  ImportedScene imported;
  const Status status = import_scene(path, ImportOptions(), &imported);
  if (!status.ok) {
    std::printf("| %s | skipped: %s |\n", path.c_str(), status.message);
    return;
  }
  if (!lights_itself(imported.scene)) {
    std::printf("| %s | no light of its own |\n", path.c_str());
    return;
  }
  m->measure(path.substr(path.rfind('/') + 1).c_str(), imported.scene);
}
#endif

}  // namespace

int main(int argc, char** argv) {
  doctest::Context context;
  context.setAsDefaultForAssertsOutOfTestCases();
  Measurement m;
  std::printf("| room | mean | worst | all light | noise | patches | MiB | s |\n|---|---|---|---|---|---|---|---|\n");
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (!std::strcmp(argv[i], "--noise") && more) {
      m.truth.noise_max = std::atof(argv[++i]);
    } else if (!std::strcmp(argv[i], "--rounds") && more) {
      m.truth.rounds_max = static_cast<std::uint32_t>(std::atoi(argv[++i]));
    } else if (!std::strcmp(argv[i], "--truths") && more) {
      m.truths = argv[++i];
    } else if (!std::strcmp(argv[i], "--regions")) {
      m.regions = true;
    } else if (!std::strcmp(argv[i], "--patches") && more) {
      m.patches = static_cast<std::uint32_t>(std::atoi(argv[++i]));
    } else if (!std::strcmp(argv[i], "--lights")) {
      m.lights = true;
    } else if (!std::strcmp(argv[i], "--random") && more) {
      const int count = std::atoi(argv[++i]);
      for (int seed = 1; seed <= count; ++seed)
        m.measure(("random " + std::to_string(seed)).c_str(), random_room(static_cast<std::uint64_t>(seed))->scene);
    } else if (!std::strcmp(argv[i], "--seed") && more) {
      const int seed = std::atoi(argv[++i]);
      m.measure(("random " + std::to_string(seed)).c_str(), random_room(static_cast<std::uint64_t>(seed))->scene);
    } else if (!std::strcmp(argv[i], "--gaps")) {
      for (bool two_sided : {true, false})
        for (float gap : {.5f, .3f, .1f, .05f, .02f, .01f, .005f, .002f, .001f}) {
          char name[64];
          std::snprintf(name, sizeof name, "lamp %g below, %s-sided", static_cast<double>(gap),
                        two_sided ? "two" : "one");
          m.measure(name, room_with_lamp(gap, two_sided)->scene);
        }
    } else {
#ifdef POCKETRAY_HAVE_IMPORT
      measure_file(argv[i], &m);
#endif
    }
  }
  std::printf("%d rooms, %d beyond 3 %% in the mean or 10 %% anywhere; mean of means %.2f %%, worst %+.1f %%\n",
              m.rooms, m.failed, m.rooms ? 100 * m.sum_of_means / m.rooms : 0.0, 100 * m.worst);
  return 0;
}
