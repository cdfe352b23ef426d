// Texts from the command line or from files: options, the state of a sweep, output of valgrind.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "base/check.h"
#include "fuzz/fuzz.h"
#include "plan/plan_effects.h"
#include "session/open_scene.h"

#if defined(POCKETRAY_HAVE_ACCURACY)
#include "desktop/accuracy/callgrind.h"
#include "desktop/sweep/state.h"
#endif

POCKETRAY_FUZZ_TARGET(fuzz_text)

namespace pocketray {
namespace {

#if defined(POCKETRAY_HAVE_ACCURACY)
// A folder for this process, removed at exit.
struct Folder {
  std::string path;
  Folder() {
    char name[] = "/tmp/pocketray-fuzz-XXXXXX";
    CHECK(mkdtemp(name) != nullptr);
    path = name;
  }
  ~Folder() {
    std::remove((path + "/accuracy.state").c_str());
    rmdir(path.c_str());
  }
};

// Reads or refuses a state file; writes an accepted one back.
void read_state(const std::string& text) {
  static Folder folder;
  std::ofstream(folder.path + "/accuracy.state", std::ios::binary) << text;
  AccuracyState state, again;
  if (!open_state(folder.path, Json::object(), false, &state).ok) return;
  ++fuzz_counts.states;
  CHECK(save_state(folder.path, state).ok);
  CHECK(open_state(folder.path, Json::object(), false, &again).ok);
  CHECK_EQ(again.points.size(), state.points.size());
}

bool read_dump(const std::string& text) {
  std::uint64_t instructions;
  return read_callgrind_dump(text, &instructions);
}
#else
void read_state(const std::string&) {}
bool read_dump(const std::string&) { return false; }
#endif

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

void fuzz_text(const std::uint8_t* bytes, std::size_t byte_count) {
  if (byte_count == 0) return;
  std::string text(bytes + 1, bytes + byte_count);
  std::uint32_t width, height;
  std::size_t size;
  ExposureChoice exposure;
  float factor = 0;
  Camera camera;
  Settings settings;
  switch (bytes[0] % 7) {
    case 0:
      fuzz_counts.texts += parse_size(text, &width, &height).ok;
      return;
    case 1:
      if (!parse_bytes(text, &size).ok) return;
      CHECK(size >= 65536);
      break;
    case 2:
      if (!parse_camera(text, &camera).ok) return;
      CHECK(is_finite(camera.eye) && is_finite(camera.target) && is_finite(camera.up));
      break;
    case 3:
      if (!parse_exposure(text, &exposure, &factor).ok) return;
      CHECK(std::isfinite(factor) && factor > 0);
      break;
    case 4:
      if (!parse_effects(text.c_str(), &settings).ok) return;
      CHECK((settings.forced_on & settings.forced_off) == 0);
      break;
    case 5:
      if (!read_dump(text)) return;
      break;
    default:
      return read_state(text);
  }
  ++fuzz_counts.texts;
}

}  // namespace pocketray
