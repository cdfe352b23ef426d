#if defined(__linux__)
#include <doctest/doctest.h>
#include <errno.h>
#include <unistd.h>

#include <cstring>
#include <vector>

#include "platform/linux/linux.h"
#include "platform/linux/vsync.h"
#include "present/pack.h"
#include "recorded_driver.h"

using namespace platform;
using recorded::Geometry;
using recorded::Machine;
using recorded::Vsync;

namespace {

// As reported by drivers: the first two by the emulated boards, the others from the headers of the drivers named.
const Geometry kGeometries[] = {
    {"PL110, ARM926, blind until switched on", 320, 240, 240, 16, 640, {11, 5}, {5, 6}, {0, 5}, {}, 0, true},
    {"virtio-gpu, blank until switched on", 320, 240, 240, 32, 1280, {16, 8}, {8, 8}, {0, 8}, {}, 0},
    {"240 x 320 panel, SPI", 240, 320, 320, 16, 480, {11, 5}, {5, 6}, {0, 5}, {}, 0},
    {"two pages, RGB565, stride 656", 320, 240, 480, 16, 656, {11, 5}, {5, 6}, {0, 5}, {}, 1},
    {"two pages, BGR565, stride 650", 320, 240, 480, 16, 650, {0, 5}, {5, 6}, {11, 5}, {}, 1},
    {"three pages, BGRX8888", 320, 240, 720, 32, 1280, {8, 8}, {16, 8}, {24, 8}, {}, 1},
    {"640 x 480, ARGB8888, two pages", 640, 480, 960, 32, 2560, {16, 8}, {8, 8}, {0, 8}, {24, 8}, 1},
    {"640 x 480, RGB565, one page, stride 1300", 640, 480, 480, 16, 1300, {11, 5}, {5, 6}, {0, 5}, {}, 0},
    {"970 x 730, 24 bits, two pages, stride 2911", 970, 730, 1460, 24, 2911, {16, 8}, {8, 8}, {0, 8}, {}, 1},
    {"700 x 500, 32 bits, odd stride", 700, 500, 500, 32, 2802, {16, 8}, {8, 8}, {0, 8}, {}, 0},
    {"24 bits, stride 961", 320, 240, 240, 24, 961, {16, 8}, {8, 8}, {0, 8}, {}, 0},
    {"24 bits, two pages", 320, 240, 480, 24, 960, {0, 8}, {8, 8}, {16, 8}, {}, 1},
    {"32 bits at an odd stride: cannot be drawn to directly", 320, 240, 480, 32, 1282, {16, 8}, {8, 8}, {0, 8}, {}, 1},
    {"within a memory page", 320, 240, 480, 16, 640, {11, 5}, {5, 6}, {0, 5}, {}, 1, false, false, 256},
    {"mode refused", 320, 240, 240, 16, 640, {11, 5}, {5, 6}, {0, 5}, {}, 0, false, true},
    {"shown from row 16 on", 320, 240, 240, 16, 640, {11, 5}, {5, 6}, {0, 5}, {}, 0, false, false, 0, 16},
    {"128 x 96: smaller than the picture", 128, 96, 192, 16, 256, {11, 5}, {5, 6}, {0, 5}, {}, 1},
};

constexpr std::uint64_t kPatienceNs = 60'000'000'000;  // for a driver that answers, on a busy machine

struct Screen {
  Machine machine;
  Driver driver = recorded::kDriver;
  std::vector<std::uint32_t> memory = std::vector<std::uint32_t>(320 * 240);
  ScreenOptions options;
  ScreenFormat format;
  Error error;
  explicit Screen(const Geometry& geometry, Vsync vsync = Vsync::absent) {
    recorded::reset(&machine, geometry, vsync);
    driver.vsync_timeout_ns = vsync == Vsync::never ? kVsyncTimeoutNs : kPatienceNs;
    linux_driver = &driver;
    options.memory = memory.data();
    options.memory_bytes = memory.size() * 4;
  }
  ~Screen() {
    machine.release = true;
    kLinuxBackend.close();
    linux_driver = &kSystemDriver;
    while (machine.stuck) usleep(1000);
  }
  bool open() { return kLinuxBackend.open(options, &format, &error); }
  pocketray::PixelFormat pixel_format() const {
    return {format.bits_per_pixel,
            {format.red.offset, format.red.length},
            {format.green.offset, format.green.length},
            {format.blue.offset, format.blue.length},
            {format.alpha.offset, format.alpha.length}};
  }
};

std::uint32_t pattern(const pocketray::PixelFormat& format, int x, int y, int frame) {
  return pocketray::pack_levels(format, (x * 7 + frame * 50) & 255, (y * 5 + frame) & 255, (x * y + frame) & 255);
}

void draw(const Screen& screen, const Page& page, int frame, int row_begin, int row_end) {
  pocketray::PixelFormat format = screen.pixel_format();
  int bytes = format.bits_per_pixel / 8;
  for (int y = row_begin; y < row_end; ++y)
    for (int x = 0; x < screen.format.width; ++x)
      pocketray::write_pixel(format, static_cast<std::uint8_t*>(page.pixels) + y * page.line_bytes + x * bytes,
                             pattern(format, x, y, frame));
}

// Screen pixels per pixel: the most that fit.
int scale_of(const Screen& screen) {
  const Geometry& g = screen.machine.geometry;
  int scale = 1;
  while ((scale != screen.options.scale) && (scale + 1) * screen.format.width <= static_cast<int>(g.width) &&
         (scale + 1) * screen.format.height <= static_cast<int>(g.height))
    ++scale;
  return scale;
}

// Number of screen pixels of rows [row_begin, row_end) of the picture not shown as drawn in `frame`.
int wrong_pixels(const Screen& screen, int frame, int row_begin, int row_end) {
  const Geometry& g = screen.machine.geometry;
  int scale = scale_of(screen);
  int left = (static_cast<int>(g.width) - screen.format.width * scale) / 2;
  int top = (static_cast<int>(g.height) - screen.format.height * scale) / 2;
  pocketray::PixelFormat format = screen.pixel_format();
  int wrong = 0;
  for (int y = row_begin * scale; y < row_end * scale; ++y) {
    for (int x = 0; x < screen.format.width * scale; ++x) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, recorded::shown(left + x, top + y), static_cast<std::size_t>(g.bits / 8));
      wrong += pixel != pattern(format, x / scale, y / scale, frame);
    }
  }
  return wrong;
}

}  // namespace

// Screen pixels outside the picture that are not black, and bytes of row padding that were written, of the page shown.
int stray_pixels(const Screen& screen) {
  const Geometry& g = screen.machine.geometry;
  int scale = scale_of(screen), bytes = static_cast<int>(g.bits / 8), stray = 0;
  int width = screen.format.width * scale, height = screen.format.height * scale;
  int left = (static_cast<int>(g.width) - width) / 2, top = (static_cast<int>(g.height) - height) / 2;
  for (int y = 0; y < static_cast<int>(g.height); ++y)
    for (int x = 0; x < static_cast<int>(g.width); ++x)
      if (x < left || x >= left + width || y < top || y >= top + height)
        for (int byte = 0; byte < bytes; ++byte) stray += recorded::shown(x, y)[byte] != 0;
  return stray;
}

// Goal: each geometry shows exactly the drawing, as large as fits, frame after frame, and black around it. Method:
// three frames on the recorded driver, every pixel.
TEST_CASE("fbdev_shows_every_pixel_of_every_recorded_geometry") {
  for (const Geometry& geometry : kGeometries) {
    CAPTURE(geometry.name);
    Screen screen(geometry);
    REQUIRE_MESSAGE(screen.open(), screen.error.text);
    CHECK(screen.format.bits_per_pixel == static_cast<int>(geometry.bits));
    CHECK(screen.format.red.offset == static_cast<int>(geometry.red.offset));
    CHECK(screen.format.width == static_cast<int>(geometry.width < 320 ? geometry.width : 320));
    for (int frame = 1; frame <= 3; ++frame) {
      Page page = kLinuxBackend.begin_frame();
      REQUIRE(page.pixels != nullptr);
      std::uintptr_t alignment = geometry.bits == 24 ? 1 : geometry.bits / 8;  // ARMv5 cannot store across it
      CHECK(reinterpret_cast<std::uintptr_t>(page.pixels) % alignment == 0);
      CHECK(static_cast<std::uintptr_t>(page.line_bytes) % alignment == 0);
      draw(screen, page, frame, 0, screen.format.height);
      kLinuxBackend.end_frame(0, screen.format.height);
      CHECK(wrong_pixels(screen, frame, 0, screen.format.height) == 0);
    }
    CHECK(stray_pixels(screen) == 0);
    kLinuxBackend.close();
    CHECK(screen.machine.files_open == 0);
    CHECK(screen.machine.maps == 0);
    CHECK(screen.machine.yoffset == geometry.yoffset);
  }
}

// Goal: the rotated picture fits a panel that is mounted sideways. Method: 320 × 240 by a quarter turn on the 240 × 320
// panel, packed by pack_rows(), a pixel near each corner.
TEST_CASE("fbdev_fits_a_turned_picture_on_a_portrait_panel") {
  Screen screen(kGeometries[2]);
  screen.options.rotation = 90;
  REQUIRE_MESSAGE(screen.open(), screen.error.text);
  CHECK(screen.format.width == 240);
  CHECK(screen.format.height == 320);
  std::vector<pocketray::Vec3> radiance(320 * 240, pocketray::Vec3{0, 0, 0});
  radiance[0] = {1, 0, 0};
  radiance[319] = {0, 1, 0};
  Page page = kLinuxBackend.begin_frame();
  pocketray::pack_rows(radiance.data(), 320, 240, 0, 240, 1, screen.pixel_format(), pocketray::Rotation::quarter, false,
                       page.pixels, page.line_bytes);
  kLinuxBackend.end_frame(0, 320);
  std::uint16_t pixel;
  std::memcpy(&pixel, recorded::shown(239, 0), 2);
  CHECK(pixel == 0xf800);
  std::memcpy(&pixel, recorded::shown(239, 319), 2);
  CHECK(pixel == 0x07e0);
}

// Goal: a turned picture is enlarged, too, and --scale makes it smaller but never too large. Method: a 480 × 640 panel
// with and without a scale.
TEST_CASE("fbdev_enlarges_by_a_whole_factor_or_less_if_asked") {
  Geometry portrait = {"480 x 640", 480, 640, 1280, 32, 1920, {16, 8}, {8, 8}, {0, 8}, {}, 1};
  for (int wanted : {0, 1, 2, 3}) {
    CAPTURE(wanted);
    Screen screen(portrait);
    screen.options.rotation = 270;
    screen.options.scale = wanted;
    REQUIRE_MESSAGE(screen.open(), screen.error.text);
    CHECK(screen.format.width == 240);
    CHECK(scale_of(screen) == (wanted == 1 ? 1 : 2));
    for (int frame = 1; frame <= 3; ++frame) {
      draw(screen, kLinuxBackend.begin_frame(), frame, 0, 320);
      kLinuxBackend.end_frame(0, 320);
      CHECK(wrong_pixels(screen, frame, 0, 320) == 0);
    }
    CHECK(stray_pixels(screen) == 0);
  }
}

// Goal: an enlarged picture keeps what did not change, on both pages, and costs no more writing than that. Method: rows
// of the back page named by turns, on one page and on two; rows not named are drawn, too, and must not be shown.
TEST_CASE("fbdev_enlarges_only_the_changed_rows") {
  for (bool flips : {false, true}) {
    CAPTURE(flips);
    Geometry geometry = {"640 x 480", 640, 480, flips ? 960u : 480u, 16, 1280, {11, 5}, {5, 6}, {0, 5}, {}, flips};
    Screen screen(geometry);
    REQUIRE(screen.open());
    Page page = kLinuxBackend.begin_frame();
    CHECK(page.pixels == screen.memory.data());
    CHECK(page.age == 0);
    draw(screen, page, 1, 0, 240);
    kLinuxBackend.end_frame(0, 240);
    page = kLinuxBackend.begin_frame();
    CHECK(page.age == 1);
    draw(screen, page, 2, 100, 110);
    kLinuxBackend.end_frame(100, 110);
    page = kLinuxBackend.begin_frame();
    CHECK(page.age == 1);
    draw(screen, page, 3, 20, 30);
    kLinuxBackend.end_frame(20, 30);
    CHECK(wrong_pixels(screen, 1, 0, 20) == 0);
    CHECK(wrong_pixels(screen, 3, 20, 30) == 0);
    CHECK(wrong_pixels(screen, 1, 30, 100) == 0);
    CHECK(wrong_pixels(screen, 2, 100, 110) == 0);
    CHECK(wrong_pixels(screen, 1, 110, 240) == 0);
    draw(screen, kLinuxBackend.begin_frame(), 4, 0, 240);
    kLinuxBackend.end_frame(200, 201);
    CHECK(wrong_pixels(screen, 4, 200, 201) == 0);
    CHECK(wrong_pixels(screen, 1, 0, 20) == 0);
    CHECK(wrong_pixels(screen, 1, 210, 240) == 0);
    CHECK(screen.machine.slept_ns == (flips ? 3 * 20'000'000u : 0u));
  }
}

// Goal: an enlarged picture survives a driver that stops panning. Method: refuses from the n-th call on; the back page
// keeps the frame.
TEST_CASE("fbdev_enlarges_on_when_panning_is_refused") {
  for (int accepted : {0, 1, 2, 3}) {
    CAPTURE(accepted);
    Screen screen(kGeometries[6]);
    screen.machine.pans_accepted = accepted;
    REQUIRE(screen.open());
    for (int frame = 1; frame <= 5; ++frame) {
      Page page = kLinuxBackend.begin_frame();
      CHECK(page.age == (frame > 1 ? 1 : 0));
      int rows = frame > 1 ? 120 : 240;
      draw(screen, page, frame, 0, rows);
      kLinuxBackend.end_frame(0, rows);
      CHECK(wrong_pixels(screen, frame, 0, rows) == 0);
      CHECK(wrong_pixels(screen, 1, 120, 240) == 0);
    }
  }
}

// Goal: only the changed rows are copied. Method: draw all rows, name some.
TEST_CASE("fbdev_copies_only_the_changed_rows") {
  Screen screen(kGeometries[0]);
  REQUIRE(screen.open());
  Page page = kLinuxBackend.begin_frame();
  CHECK(page.age == 0);
  draw(screen, page, 1, 0, 240);
  kLinuxBackend.end_frame(0, 240);
  page = kLinuxBackend.begin_frame();
  CHECK(page.age == 1);
  draw(screen, page, 2, 0, 240);
  kLinuxBackend.end_frame(100, 110);
  CHECK(wrong_pixels(screen, 1, 0, 100) == 0);
  CHECK(wrong_pixels(screen, 2, 100, 110) == 0);
  CHECK(wrong_pixels(screen, 1, 110, 240) == 0);
}

// Goal: flipping draws into the hidden page and reports its age. Method: two pages; the visible one does not change
// before end_frame().
TEST_CASE("fbdev_flips_two_pages_and_tells_their_age") {
  Screen screen(kGeometries[3], Vsync::works);
  REQUIRE(screen.open());
  CHECK(vsync_period_ns() > 16'000'000);
  const int ages[] = {0, 0, 2, 2};
  for (int frame = 1; frame <= 4; ++frame) {
    Page page = kLinuxBackend.begin_frame();
    CHECK(page.age == ages[frame - 1]);
    draw(screen, page, frame, 0, 240);
    if (frame > 1) CHECK(wrong_pixels(screen, frame - 1, 0, 240) == 0);
    std::uint32_t before = screen.machine.yoffset;
    kLinuxBackend.end_frame(0, 240);
    CHECK(screen.machine.yoffset == (before ? 0u : 240u));
    CHECK(wrong_pixels(screen, frame, 0, 240) == 0);
  }
  CHECK(screen.machine.slept_ns == 0);  // waits for the vertical blank instead
  CHECK(screen.machine.vsync_calls == 4 + 3);
}

// Goal: no wait if the flip is long past. Method: a frame of 100 ms between two flips.
TEST_CASE("fbdev_does_not_wait_when_a_frame_has_passed_since_the_flip") {
  Screen screen(kGeometries[3], Vsync::works);
  REQUIRE(screen.open());
  kLinuxBackend.begin_frame();
  kLinuxBackend.end_frame(0, 240);
  screen.machine.clock_ns += 100'000'000;
  int calls = screen.machine.vsync_calls;
  kLinuxBackend.begin_frame();
  CHECK(screen.machine.vsync_calls == calls);
}

// Goal: a vsync call that returns at once, is refused, or never returns is detected and not called again, and frames
// still keep their distance to the flip. Method: each kind; the one that never returns must cost one timeout of real
// time, once.
TEST_CASE("fbdev_survives_every_kind_of_vsync") {
  for (Vsync kind : {Vsync::absent, Vsync::at_once, Vsync::never}) {
    CAPTURE(static_cast<int>(kind));
    Screen screen(kGeometries[3], kind);
    std::uint64_t start = kSystemDriver.now_ns();
    REQUIRE(screen.open());
    CHECK(vsync_period_ns() == 0);
    int calls = screen.machine.vsync_calls;
    for (int frame = 1; frame <= 5; ++frame) {
      draw(screen, kLinuxBackend.begin_frame(), frame, 0, 240);
      kLinuxBackend.end_frame(0, 240);
      CHECK(wrong_pixels(screen, frame, 0, 240) == 0);
    }
    CHECK(screen.machine.vsync_calls == calls);
    CHECK(screen.machine.slept_ns == 4 * 20'000'000);
    kLinuxBackend.close();
    if (kind == Vsync::never) {
      CHECK(kSystemDriver.now_ns() - start > kVsyncTimeoutNs);
      REQUIRE(screen.open());  // while the helper is still stuck
      CHECK(vsync_period_ns() == 0);
      CHECK(screen.machine.vsync_calls == calls);
    }
  }
  // And after it came back, the next screen has its vsync again.
  Screen screen(kGeometries[3], Vsync::works);
  REQUIRE(screen.open());
  CHECK(vsync_period_ns() > 16'000'000);
}

// Goal: a driver whose vsync stops working midway costs one timeout. Method: it hangs from the second frame on.
TEST_CASE("fbdev_bounds_a_vsync_that_hangs_later") {
  Screen screen(kGeometries[3], Vsync::works);
  REQUIRE(screen.open());
  for (int frame = 1; frame <= 6; ++frame) {
    if (frame == 3) screen.machine.vsync = Vsync::never, screen.driver.vsync_timeout_ns = kVsyncTimeoutNs;
    draw(screen, kLinuxBackend.begin_frame(), frame, 0, 240);
    kLinuxBackend.end_frame(0, 240);
    CHECK(wrong_pixels(screen, frame, 0, 240) == 0);
  }
  CHECK(screen.machine.vsync_calls == 4 + 1 + 1);
  CHECK(vsync_period_ns() == 0);
  screen.driver.vsync_timeout_ns = kPatienceNs;  // a wait now would never end
  CHECK(vsync_wait() == VsyncKind::never);
  CHECK(screen.machine.vsync_calls == 4 + 1 + 1);
}

// Goal: panning that is refused, at once or later, falls back to copying without losing a frame. Method: a driver that
// refuses from the n-th call on; single rows are correct after that, too.
TEST_CASE("fbdev_falls_back_to_copying_when_panning_is_refused") {
  for (int accepted : {0, 1, 2, 3}) {
    CAPTURE(accepted);
    Screen screen(kGeometries[3]);
    screen.machine.pans_accepted = accepted;
    REQUIRE(screen.open());
    bool copied_before = false;
    for (int frame = 1; frame <= 5; ++frame) {
      Page page = kLinuxBackend.begin_frame();
      bool copies = page.pixels == screen.memory.data();
      if (copies) CHECK(page.age == (copied_before ? 1 : 0));  // the back page in memory starts with no frame in it
      copied_before = copies;
      draw(screen, page, frame, 0, 240);
      kLinuxBackend.end_frame(0, 240);
      CHECK(wrong_pixels(screen, frame, 0, 240) == 0);
    }
    Page page = kLinuxBackend.begin_frame();
    CHECK(page.age == 1);
    draw(screen, page, 6, 0, 240);
    kLinuxBackend.end_frame(20, 30);
    CHECK(wrong_pixels(screen, 5, 0, 20) == 0);
    CHECK(wrong_pixels(screen, 6, 20, 30) == 0);
    CHECK(wrong_pixels(screen, 5, 30, 240) == 0);
  }
}

// Goal: unsupported screens are refused with a reason, and everything is restored. Method: one of each kind.
TEST_CASE("fbdev_refuses_what_it_cannot_draw_to") {
  Geometry paletted = kGeometries[0], short_rows = kGeometries[0], dark = kGeometries[0], nothing = {};
  paletted.bits = 8;
  short_rows.line_bytes = 638;
  dark.refuses_put = true;  // stays at stride 0
  const Geometry all[] = {paletted, short_rows, dark, nothing};
  const char* const reasons[] = {"depth", "rows shorter", "colour fields", "cannot open /dev/fb0"};
  for (int i = 0; i < 4; ++i) {
    Screen screen(all[i]);
    CHECK_FALSE(screen.open());
    CAPTURE(screen.error.text);
    CHECK(std::strstr(screen.error.text, reasons[i]) != nullptr);
    CHECK(screen.machine.files_open == 0);
    CHECK(screen.machine.console_mode == 0);
  }
  Screen small(kGeometries[0]);
  small.options.memory_bytes = 320 * 240 * 2 - 1;
  CHECK_FALSE(small.open());
  CHECK(std::strstr(small.error.text, "back page needs 153600 bytes") != nullptr);
  CHECK(small.machine.files_open == 0);
  small.options.memory_bytes += 1;
  CHECK(small.open());
}
#endif
