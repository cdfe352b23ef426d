// The file that keeps a sweep's measurements.
#include <cmath>
#include <cstring>
#include <limits>

#include "desktop/sweep/state.h"
#include "sweep/folder.h"

using namespace pocketray;

// Goal: damaged files are refused in one line. Method: the state cut off at many lengths and with bytes changed.
TEST_CASE("accuracy_refuses_damaged_files") {
  Folder folder;
  AccuracyState state, read;
  Json key = {{"scene", "cube"}, {"samples", 4}};
  REQUIRE(open_state(folder.path, key, false, &state).ok);
  state.rounds = 2;
  state.references = {"reference-model-1"};
  PointFigures f;
  f.has_errors = true;
  f.errors.psnr = std::numeric_limits<double>::infinity();
  f.truth = {0.0625, {0.125f}, {0.25f}}, f.model = {0.0625, {0.5f, 0.375f}, {0.5f, 0.625f}};
  f.flip_as = {0.0625, 0.0625, 0.0625};
  f.ns_per_pixel = {12.25, 1e9 / 3};
  state.points["samples 4"] = f;
  f.instructions_per_pixel = 7654.5, f.bytes_per_frame = 4321.5;
  f.stored_bytes = 87654.5, f.bake_seconds = 34.125;
  state.points["samples 9"] = f;
  state.counted = "by hand";
  REQUIRE(save_state(folder.path, state).ok);
  REQUIRE(open_state(folder.path, key, false, &read).ok);
  CHECK(read.rounds == 2);
  CHECK(read.references == state.references);
  CHECK(read.points.at("samples 4").ns_per_pixel == f.ns_per_pixel);
  CHECK(std::isinf(read.points.at("samples 4").errors.psnr));
  CHECK(std::isnan(read.points.at("samples 4").instructions_per_pixel));
  CHECK(read.points.at("samples 9").instructions_per_pixel == 7654.5);
  CHECK(std::isnan(read.points.at("samples 4").bytes_per_frame));
  CHECK(read.points.at("samples 9").bytes_per_frame == 4321.5);
  CHECK(std::isnan(read.points.at("samples 4").stored_bytes));
  CHECK(read.points.at("samples 9").stored_bytes == 87654.5);
  CHECK(read.points.at("samples 9").bake_seconds == 34.125);
  CHECK(read.points.at("samples 9").truth.flip == 0.0625);
  CHECK(read.points.at("samples 9").truth.other == f.truth.other);
  CHECK(read.points.at("samples 9").model.one == f.model.one);
  CHECK(read.points.at("samples 9").flip_as == f.flip_as);
  CHECK(read.counted == "by hand");

  platform::LoadedFile file;
  platform::FileError error;
  REQUIRE(platform::load_file(folder.file("accuracy.state").c_str(), &file, &error));
  std::string text(reinterpret_cast<const char*>(file.bytes), file.byte_count);
  platform::unload_file(&file);
  for (std::size_t length = 0; length + 3 < text.size(); length += 7) {
    REQUIRE(save_text(folder.path, "accuracy.state", text.substr(0, length)).ok);
    Status status = open_state(folder.path, key, false, &read);
    CHECK_FALSE(status.ok);
    CHECK(std::string(status.message).find("--restart") != std::string::npos);
  }
  const std::pair<const char*, const char*> senseless[] = {
      {"12.25", "1e300"}, {"12.25", "-1.0"},   {"12.25", "\"none\""}, {"12.25", "0"},      {"7654.5", "1e300"},
      {"7654.5", "-1.0"}, {"4321.5", "1e300"}, {"4321.5", "-1.0"},    {"87654.5", "-1.0"}, {"34.125", "1e300"},
      {"0.0625", "1.5"},  {"0.375", "1.5"},    {"0.375", ""}};
  for (const auto& change : senseless) {
    const char *figure = change.first, *other = change.second;
    CAPTURE(other);
    std::string changed = text;
    std::size_t at = changed.find(figure);
    REQUIRE(at != std::string::npos);
    REQUIRE(save_text(folder.path, "accuracy.state", changed.replace(at, std::strlen(figure), other)).ok);
    Status status = open_state(folder.path, key, false, &read);
    CHECK_FALSE(status.ok);
    CHECK(std::string(status.message).find("--restart") != std::string::npos);
  }
  for (std::size_t at = 0; at < text.size(); at += 3) {  // any result is fine, but no crash
    std::string changed = text;
    changed[at] = changed[at] == '9' ? '"' : '9';
    REQUIRE(save_text(folder.path, "accuracy.state", changed).ok);
    Status status = open_state(folder.path, key, false, &read);
    CHECK((status.ok || std::string(status.message).find("--restart") != std::string::npos));
  }
}
