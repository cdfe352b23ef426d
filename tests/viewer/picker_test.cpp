// The choice of a scene, on the null screen.
#include "viewer/picker.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "viewer/stage.h"

using namespace pocketray;
using platform::Button;

namespace {

struct Folder {
  std::string path;
  Folder() {
    char name[] = "/tmp/pocketray-picker-XXXXXX";
    path = mkdtemp(name);
  }
  void write(const std::string& name, const std::string& content) const {
    std::FILE* file = std::fopen((path + "/" + name).c_str(), "wb");
    REQUIRE(file != nullptr);
    std::fwrite(content.data(), 1, content.size(), file);
    std::fclose(file);
  }
  ~Folder() {
    for (const char* name : {"b.pray", "a.pray", "cube.pray", "a.ppm", "b.ppm", "cube.ppm", "notes.txt"})
      unlink((path + "/" + name).c_str());
    rmdir(path.c_str());
  }
};

// Presses buttons a tenth of a second apart; what the user chose of twelve entries, on a screen of three columns.
int chosen_after(const std::vector<Button>& buttons, Stage* stage) {
  double seconds = 1;
  for (Button button : buttons) stage->press(seconds, button), seconds += 0.1;
  stage->leave(60);
  stage->open("");
  std::vector<PickerEntry> entries(12);
  for (PickerEntry& entry : entries) entry.title = "entry";
  int chosen;
  pick_scene(&stage->viewer, entries, &chosen);
  return chosen;
}

}  // namespace

// Goal: a folder's scenes come first, sorted, with their pictures, then the built-in ones it does not replace. Damaged
// and oversized pictures are left out. Method: such a folder, and one that is not there.
TEST_CASE("picker_lists_files_then_builtin_scenes") {
  Folder folder;
  for (const char* name : {"b.pray", "a.pray", "cube.pray", "notes.txt"}) folder.write(name, "x");
  folder.write("a.ppm", "P6\n2 1\n255\nABCDEF");
  folder.write("b.ppm", "P6\n2 1\n255\nABCDE");
  folder.write("cube.ppm", "P6\n97 1\n255\n" + std::string(3 * 97, 'x'));
  std::vector<PickerEntry> entries;
  REQUIRE(list_scenes_to_pick(folder.path, &entries).ok);
  REQUIRE(entries.size() == 8);
  const char* const titles[] = {"a", "b", "cube", "cornell", "statue", "seesaw", "furnace", "lanterns"};
  for (std::size_t i = 0; i < 8; ++i) CHECK(entries[i].title == titles[i]);
  CHECK(entries[0].scene == folder.path + "/a.pray");
  CHECK(entries[3].scene == "cornell");
  CHECK(std::string(entries[0].rgb.begin(), entries[0].rgb.end()) == "ABCDEF");
  CHECK(entries[0].width == 2);
  CHECK(entries[1].rgb.empty());
  CHECK(entries[2].rgb.empty());
  CHECK_FALSE(list_scenes_to_pick(folder.path + "/none", &entries).ok);
}

// Goal: the pad and one button suffice, and nothing leads out of the list. Method: walks through it; quitting.
TEST_CASE("picker_is_used_with_a_pad_and_a_button") {
  Stage first, down, back, edge, last, quit;
  CHECK(chosen_after({Button::a}, &first) == 0);
  CHECK(chosen_after({Button::down, Button::right, Button::a}, &down) == 4);
  CHECK(chosen_after({Button::right, Button::right, Button::left, Button::start}, &back) == 1);
  CHECK(chosen_after({Button::left, Button::up, Button::a}, &edge) == 0);
  CHECK(chosen_after({Button::down, Button::down, Button::down, Button::down, Button::right, Button::a}, &last) == 10);
  CHECK(chosen_after({Button::right}, &quit) == -1);
  CHECK(quit.viewer.quit);
}

// Goal: pictures are shown as they are, the selected one in a frame that moves with it. Method: one red picture; its
// pixels on the screen, and those of the frame above pictures and titles, before and after a step to the right.
TEST_CASE("picker_shows_pictures_and_what_is_selected") {
  for (bool step : {false, true}) {
    Stage stage;
    if (step) stage.press(1, Button::right);
    stage.leave(2);
    stage.open("");
    std::vector<PickerEntry> entries(2);
    entries[0].width = kThumbnailWidth, entries[0].height = 40;
    for (int i = 0; i < kThumbnailWidth * 40; ++i) entries[0].rgb.insert(entries[0].rgb.end(), {200, 0, 0});
    int chosen;
    pick_scene(&stage.viewer, entries, &chosen);
    int red = 0, white_left = 0, white_right = 0;
    for (int y = 0; y < Stage::kHeight; ++y)
      for (int x = 0; x < Stage::kWidth; ++x) {
        std::uint32_t pixel = stage.screen[static_cast<std::size_t>(y * Stage::kWidth + x)] & 0xffffff;
        red += pixel == 0xc80000;
        if (y < 6 && pixel == 0xffffff) ++(x < Stage::kWidth / 3 ? white_left : white_right);
      }
    CHECK(red > kThumbnailWidth * 30);
    CHECK((white_left > 50) == !step);
    CHECK((white_right > 50) == step);
  }
}
