#include "viewer/picker.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "base/printable.h"
#include "platform/file.h"
#include "present/hud.h"
#include "present/repack.h"
#include "scene/builtin/builtin.h"
#include "session/interrupt.h"
#include "viewer/steps.h"

namespace pocketray {
namespace {

using platform::Button;

constexpr int kGap = 6, kTitleHeight = 14;  // pixels between cells, and for a title below a picture: a line and a gap
constexpr int kStepX = kThumbnailWidth + kGap, kStepY = kThumbnailHeight + kTitleHeight + kGap;
constexpr std::size_t kTitleLengthMax = 15;    // of 6 pixels each: 90, no wider than a picture
constexpr std::uint64_t kRestNs = 30'000'000;  // between two polls of the buttons; chosen: feels immediate
// Display levels. Chosen: dark, so that pictures stand out, and white.
constexpr std::uint8_t kBackground = 16, kEmpty = 48, kFrame = 255;

// A picture of bytes R, G, B as large as the screen.
struct Sheet {
  int width, height;
  std::vector<std::uint8_t> rgb;
};

void fill(Sheet* sheet, int left, int top, int width, int height, std::uint8_t level) {
  for (int y = std::max(0, top); y < std::min(sheet->height, top + height); ++y)
    for (int x = std::max(0, left); x < std::min(sheet->width, left + width); ++x)
      std::memset(&sheet->rgb[3 * static_cast<std::size_t>(y * sheet->width + x)], level, 3);
}

// Reads a picture of our own: "P6\nWIDTH HEIGHT\n255\n" and the pixels.
void read_thumbnail(const std::string& path, PickerEntry* entry) {
  platform::LoadedFile file;
  platform::FileError error;
  if (!platform::load_file(path.c_str(), &file, &error)) return;
  char head[32] = {};
  std::memcpy(head, file.bytes, std::min(file.byte_count, sizeof head - 1));
  int width = 0, height = 0, used = 0;
  bool ok = std::sscanf(head, "P6\n%4d %4d\n255%n", &width, &height, &used) == 2 && used > 0;
  ok = ok && width > 0 && height > 0 && width <= kThumbnailWidth && height <= kThumbnailHeight;
  std::size_t begin = static_cast<std::size_t>(used) + 1, count = ok ? 3 * static_cast<std::size_t>(width * height) : 0;
  if (ok && file.byte_count >= begin + count) {
    entry->rgb.assign(file.bytes + begin, file.bytes + begin + count);
    entry->width = width, entry->height = height;
  }
  platform::unload_file(&file);
}

// Layout around the selected entry: the sheet shows whole rows of cells, the selected one among them.
struct Grid {
  int columns, rows_shown, first_row, left;

  Grid(const Viewer& viewer, int selected) {
    columns = std::max(1, (viewer.width - kGap) / kStepX);
    rows_shown = std::max(1, (viewer.height - kGap) / kStepY);
    first_row = std::max(0, selected / columns - rows_shown + 1);
    left = (viewer.width - columns * kStepX + kGap) / 2;
  }
};

void show(Viewer* viewer, const std::vector<PickerEntry>& entries, int selected, Sheet* sheet) {
  platform::Page page = viewer->backend->begin_frame();
  if (!page.pixels) return;
  Grid grid(*viewer, selected);
  std::memset(sheet->rgb.data(), kBackground, sheet->rgb.size());
  int begin = grid.first_row * grid.columns, count = static_cast<int>(entries.size());
  int end = std::min(count, begin + grid.rows_shown * grid.columns);
  auto cell_left = [&](int i) { return grid.left + (i - begin) % grid.columns * kStepX; };
  auto cell_top = [&](int i) { return kGap + (i - begin) / grid.columns * kStepY; };
  for (int i = begin; i < end; ++i) {
    const PickerEntry& entry = entries[static_cast<std::size_t>(i)];
    int left = cell_left(i), top = cell_top(i);
    if (i == selected) fill(sheet, left - 2, top - 2, kThumbnailWidth + 4, kThumbnailHeight + 4, kFrame);
    fill(sheet, left, top, kThumbnailWidth, kThumbnailHeight, kEmpty);
    left += (kThumbnailWidth - entry.width) / 2, top += (kThumbnailHeight - entry.height) / 2;
    int columns = std::min(entry.width, sheet->width - left), rows = std::min(entry.height, sheet->height - top);
    for (int y = 0; y < rows && columns > 0; ++y)
      std::memcpy(&sheet->rgb[3 * static_cast<std::size_t>((top + y) * sheet->width + left)],
                  &entry.rgb[3 * static_cast<std::size_t>(y * entry.width)], 3 * static_cast<std::size_t>(columns));
  }
  repack_rows(kRgb888, sheet->rgb.data(), 3 * sheet->width, viewer->width, viewer->height, 0, viewer->height,
              viewer->format, viewer->rotation, page.pixels, page.line_bytes);
  Canvas canvas = {page.pixels, page.line_bytes, viewer->format, viewer->width, viewer->height, viewer->rotation};
  for (int i = begin; i < end; ++i) {
    const char* title = entries[static_cast<std::size_t>(i)].title.c_str();
    draw_text_box(canvas, cell_left(i), cell_top(i) + kThumbnailHeight + 2, 1, &title, 1);
  }
  viewer->backend->end_frame(0, screen_height(*viewer));
}

// Returns the entry that a button leads to; the current one if none.
int moved(const Viewer& viewer, Button button, int selected, int count) {
  int columns = Grid(viewer, selected).columns, step = 0;
  if (button == Button::left) step = -1;
  if (button == Button::right) step = 1;
  if (button == Button::up) step = -columns;
  if (button == Button::down) step = columns;
  return selected + step >= 0 && selected + step < count ? selected + step : selected;
}

}  // namespace

Status list_scenes_to_pick(const std::string& folder, std::vector<PickerEntry>* entries) {
  CHECK(entries != nullptr);
  const std::string end = ".pray";
  std::vector<std::string> names;
  platform::FileError error;
  auto add = [](void* context, const char* name) { static_cast<std::vector<std::string>*>(context)->push_back(name); };
  if (!platform::list_folder(folder.c_str(), add, &names, &error))
    return failure("%.300s %s", folder.c_str(), error.text);
  std::sort(names.begin(), names.end());
  entries->clear();
  for (const std::string& name : names) {
    if (name.size() <= end.size() || name.compare(name.size() - end.size(), end.size(), end) != 0) continue;
    PickerEntry entry;
    entry.title = name.substr(0, name.size() - end.size());
    entry.scene = folder + "/" + name;
    read_thumbnail(folder + "/" + entry.title + ".ppm", &entry);
    entries->push_back(entry);
  }
  int count;
  const BuiltinScene* builtin = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    PickerEntry entry;
    entry.scene = entry.title = builtin[i].name;
    bool has_file =
        std::any_of(entries->begin(), entries->end(), [&](const PickerEntry& e) { return e.title == entry.title; });
    if (!has_file) entries->push_back(entry);
  }
  for (PickerEntry& entry : *entries) {
    entry.title.resize(std::min<std::size_t>(entry.title.size(), kTitleLengthMax));
    make_printable(&entry.title[0], entry.title.size());
  }
  return success();
}

void pick_scene(Viewer* viewer, const std::vector<PickerEntry>& entries, int* chosen) {
  CHECK(viewer->backend != nullptr && !entries.empty());
  CHECK(chosen != nullptr);
  Sheet sheet = {viewer->width, viewer->height, {}};
  sheet.rgb.resize(3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height));
  int selected = 0, count = static_cast<int>(entries.size());
  show(viewer, entries, selected, &sheet);
  for (*chosen = -1; !interrupted;) {
    platform::Event event;
    bool any = viewer->backend->poll(&event);
    if (any && event.type == platform::EventType::quit) break;
    if (any && event.type == platform::EventType::button_down) {
      if (event.button == Button::a || event.button == Button::start) {
        *chosen = selected;
        break;
      }
      selected = moved(*viewer, event.button, selected, count);
      show(viewer, entries, selected, &sheet);
    }
    if (!any) viewer->backend->sleep_ns(kRestNs);
  }
  viewer->quit = viewer->quit || *chosen < 0;
}

}  // namespace pocketray
