// A Linux framebuffer: geometry, pixel order, stride and panning as the driver reports them.
#pragma once
#include <linux/fb.h>

#include "platform/linux/driver.h"
#include "platform/linux/vsync.h"
#include "platform/platform.h"

namespace platform {

struct Framebuffer {
  const Driver* driver = nullptr;
  int file = -1;
  fb_var_screeninfo before = {};  // to restore
  fb_var_screeninfo mode = {};
  unsigned char* map = nullptr;
  std::size_t map_bytes = 0;
  unsigned char* first_row = nullptr;  // of page 0, at the left edge of the picture
  int line_bytes = 0, page_lines = 0;
  int width = 0, height = 0, pixel_bytes = 0;  // of the picture
  int scale = 1;                               // screen pixels per pixel of the picture, each way
  bool flips = false;                          // two pages, exchanged by panning; otherwise the back page is copied
  int stale_begin = 0, stale_end = 0;          // rows missing on the hidden page, if enlarged from the back page
  int page_shown = 0;
  int frames_drawn = 0;  // since the display method was chosen
  std::uint64_t panned_ns = 0;
  VsyncKind vsync = VsyncKind::absent;
  unsigned char* memory = nullptr;  // the back page, if copying or enlarging
  int memory_line_bytes = 0;
};

// Opens the device (null: /dev/fb0), maps it and clears the picture's pages. On a larger screen the picture is enlarged
// by options.scale, or by the largest whole factor that fits if options.scale is 0 or larger than that. On failure
// returns false with the reason in `error`, and leaves nothing open.
bool framebuffer_open(const Driver& driver, const ScreenOptions& options, Framebuffer* framebuffer,
                      ScreenFormat* format, Error* error);
Page framebuffer_begin_frame(Framebuffer* framebuffer);
void framebuffer_end_frame(Framebuffer* framebuffer, int row_begin, int row_end);
void framebuffer_close(Framebuffer* framebuffer);

}  // namespace platform
