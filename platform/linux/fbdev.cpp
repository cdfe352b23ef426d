#include "platform/linux/fbdev.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "platform/check.h"

namespace platform {
namespace {

// Without a working vsync wait, the page shown before is not drawn into until this long after the flip: a frame at 50
// Hz.
constexpr std::uint64_t kFlipNs = 20'000'000;

bool get_geometry(Framebuffer* fb, fb_fix_screeninfo* fixed) {
  return fb->driver->ioctl(fb->file, FBIOGET_VSCREENINFO, &fb->mode) == 0 &&
         fb->driver->ioctl(fb->file, FBIOGET_FSCREENINFO, fixed) == 0;
}

// Without a text console the screen may not be switched on yet: PL11x then reports stride 0 and no colour fields, and
// DRM's fbdev shows nothing. Setting the current mode is harmless elsewhere, so that is done first; then the geometry
// is read again. A driver that refuses may still be usable.
bool set_mode(Framebuffer* fb, fb_fix_screeninfo* fixed) {
  if (!get_geometry(fb, fixed)) return false;
  fb->before = fb->mode;
  fb->mode.activate = FB_ACTIVATE_NOW | FB_ACTIVATE_FORCE;
  fb->mode.xoffset = fb->mode.yoffset = 0;
  fb->driver->ioctl(fb->file, FBIOPUT_VSCREENINFO, &fb->mode);
  return get_geometry(fb, fixed);
}

Channel channel_of(const fb_bitfield& field) {
  return {static_cast<int>(field.offset), static_cast<int>(field.length)};
}

bool field_usable(const fb_bitfield& field, std::uint32_t pixel_bits) {
  return field.length >= 1 && field.length <= 10 && field.msb_right == 0 && field.offset <= pixel_bits - field.length;
}

// Returns null if the geometry is supported, otherwise what is wrong with it.
const char* geometry_error(const fb_var_screeninfo& mode, const fb_fix_screeninfo& fixed) {
  std::uint32_t bits = mode.bits_per_pixel;
  if (bits != 16 && bits != 24 && bits != 32) return "its depth is not 16, 24 or 32 bits per pixel";
  if (fixed.type != FB_TYPE_PACKED_PIXELS || mode.nonstd != 0) return "its pixels are not packed";
  if (fixed.visual != FB_VISUAL_TRUECOLOR && fixed.visual != FB_VISUAL_DIRECTCOLOR) return "it is not true-colour";
  if (!field_usable(mode.red, bits) || !field_usable(mode.green, bits) || !field_usable(mode.blue, bits) ||
      (mode.transp.length && !field_usable(mode.transp, bits)))
    return "its colour fields are not supported";
  constexpr std::uint32_t kSideMax = 1u << 16;
  if (mode.xres == 0 || mode.yres == 0 || mode.xres > kSideMax || mode.yres > kSideMax)
    return "it reports no usable size";
  if (mode.xoffset > kSideMax || mode.yoffset > kSideMax) return "it reports an offset outside its memory";
  if (fixed.line_length < (mode.xoffset + mode.xres) * (bits / 8)) return "it reports rows shorter than its pixels";
  if (fixed.smem_len / fixed.line_length < mode.yoffset + mode.yres) return "it reports less memory than its rows take";
  return nullptr;
}

// Returns whether there are two pages that the driver exchanges on request.
bool can_flip(Framebuffer* fb, const fb_fix_screeninfo& fixed, std::size_t map_offset) {
  fb_var_screeninfo* mode = &fb->mode;
  if (fixed.ypanstep == 0 || mode->yres % fixed.ypanstep != 0) return false;
  if (mode->yres_virtual / 2 < mode->yres || fixed.smem_len / fixed.line_length / 2 < mode->yres) return false;
  int alignment = fb->pixel_bytes == 3 ? 1 : fb->pixel_bytes;
  if ((fixed.line_length | map_offset) % static_cast<unsigned>(alignment) != 0) return false;
  fb_var_screeninfo first_page = *mode;
  first_page.xoffset = first_page.yoffset = 0;
  if (fb->driver->ioctl(fb->file, FBIOPAN_DISPLAY, &first_page) != 0) return false;
  mode->xoffset = mode->yoffset = 0;
  return true;
}

unsigned char* page_address(const Framebuffer* fb, int page) {
  PLATFORM_CHECK(page == 0 || page == 1);
  return fb->first_row + static_cast<std::size_t>(page) * static_cast<std::size_t>(fb->page_lines) *
                             static_cast<std::size_t>(fb->line_bytes);
}

template <typename Pixel>
void repeat_pixels(const void* from, void* to, int count, int times) {
  const auto* source = static_cast<const Pixel*>(from);
  auto* target = static_cast<Pixel*>(to);
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < times; ++k) *target++ = source[i];
}

// Writes a row of the picture with each pixel `scale` times. Old CPUs cannot store across a word.
void write_row(const Framebuffer& fb, const unsigned char* from, unsigned char* to) {
  bool aligned = reinterpret_cast<std::uintptr_t>(to) % static_cast<unsigned>(fb.pixel_bytes) == 0;
  if (fb.scale == 1) {
    memcpy(to, from, static_cast<std::size_t>(fb.width) * static_cast<std::size_t>(fb.pixel_bytes));
  } else if (fb.pixel_bytes == 4 && aligned) {
    repeat_pixels<std::uint32_t>(from, to, fb.width, fb.scale);
  } else if (fb.pixel_bytes == 2 && aligned) {
    repeat_pixels<std::uint16_t>(from, to, fb.width, fb.scale);
  } else {
    for (int i = 0; i < fb.width * fb.scale; ++i)
      for (int byte = 0; byte < fb.pixel_bytes; ++byte) *to++ = from[i / fb.scale * fb.pixel_bytes + byte];
  }
}

// Copies rows of the picture to a visible page. Each is written `scale` times: reading the screen back is slow.
void copy_rows(Framebuffer* fb, const unsigned char* from, int from_line_bytes, unsigned char* to, int row_begin,
               int row_end) {
  PLATFORM_CHECK(row_begin >= 0 && row_end <= fb->height);
  for (int row = row_begin; row < row_end; ++row)
    for (int k = 0; k < fb->scale; ++k)
      write_row(*fb, from + static_cast<std::ptrdiff_t>(row) * from_line_bytes,
                to + (static_cast<std::ptrdiff_t>(row) * fb->scale + k) * fb->line_bytes);
}

// The page to draw into was visible until the flip, which happens within one frame of the request.
void wait_for_flip(Framebuffer* fb) {
  std::uint64_t elapsed = fb->driver->now_ns() - fb->panned_ns;
  std::uint64_t period = vsync_period_ns() ? vsync_period_ns() : kFlipNs;
  if (elapsed >= period || (vsync_period_ns() && vsync_wait() == VsyncKind::works)) return;
  elapsed = fb->driver->now_ns() - fb->panned_ns;
  if (elapsed < kFlipNs) fb->driver->sleep_ns(kFlipNs - elapsed);
}

// Enlarges the back page onto the hidden one, which shows the frame before the last.
void draw_hidden_page(Framebuffer* fb, int row_begin, int row_end) {
  if (fb->frames_drawn > 0) wait_for_flip(fb);
  int begin = row_begin < fb->stale_begin ? row_begin : fb->stale_begin;
  int end = row_end > fb->stale_end ? row_end : fb->stale_end;
  copy_rows(fb, fb->memory, fb->memory_line_bytes, page_address(fb, 1 - fb->page_shown), begin, end);
  fb->stale_begin = row_begin, fb->stale_end = row_end;
}

// Returns the most screen pixels per pixel that fit, or fewer if requested.
int fitting_scale(const Framebuffer& fb, int screen_width, int screen_height, int wanted) {
  int most = screen_width / fb.width < screen_height / fb.height ? screen_width / fb.width : screen_height / fb.height;
  PLATFORM_CHECK_GE(most, 1);
  return wanted > 0 && wanted < most ? wanted : most;
}

bool fail(Framebuffer* fb) {
  framebuffer_close(fb);
  return false;
}

}  // namespace

bool framebuffer_open(const Driver& driver, const ScreenOptions& options, Framebuffer* fb, ScreenFormat* format,
                      Error* error) {
  PLATFORM_CHECK(options.width > 0 && options.height > 0);
  PLATFORM_CHECK(format != nullptr && error != nullptr);
  const char* path = options.device ? options.device : "/dev/fb0";
  *fb = Framebuffer();
  fb->driver = &driver;

  // 1. Open the device and switch it on.
  fb->file = driver.open(path, O_RDWR);
  if (fb->file < 0) {
    snprintf(error->text, sizeof error->text, "cannot open %s: %s%s", path, strerror(errno),
             errno == EACCES ? " (the user must be in the video group)" : "");
    return false;
  }
  fb_fix_screeninfo fixed;
  if (!set_mode(fb, &fixed)) {
    snprintf(error->text, sizeof error->text, "cannot read the geometry of %s: %s", path, strerror(errno));
    return fail(fb);
  }
  if (const char* reason = geometry_error(fb->mode, fixed)) {
    snprintf(error->text, sizeof error->text, "%s cannot be used, %s (%ux%u, %u bits, %u bytes per row)", path, reason,
             fb->mode.xres, fb->mode.yres, fb->mode.bits_per_pixel, fixed.line_length);
    return fail(fb);
  }

  // 2. Place the picture, enlarged and centred on a larger screen.
  bool turned = options.rotation == 90 || options.rotation == 270;
  int screen_width = static_cast<int>(fb->mode.xres), screen_height = static_cast<int>(fb->mode.yres);
  fb->width = turned ? options.height : options.width;
  fb->height = turned ? options.width : options.height;
  if (fb->width > screen_width) fb->width = screen_width;
  if (fb->height > screen_height) fb->height = screen_height;
  fb->scale = fitting_scale(*fb, screen_width, screen_height, options.scale);
  fb->stale_end = fb->height;
  fb->pixel_bytes = static_cast<int>(fb->mode.bits_per_pixel / 8);
  fb->memory = static_cast<unsigned char*>(options.memory);
  fb->memory_line_bytes = (fb->width * fb->pixel_bytes + 3) / 4 * 4;
  if (!fb->memory ||
      options.memory_bytes / static_cast<unsigned>(fb->memory_line_bytes) < static_cast<unsigned>(fb->height)) {
    snprintf(error->text, sizeof error->text, "the back page needs %d bytes but %zu were given",
             fb->memory_line_bytes * fb->height, options.memory_bytes);
    return fail(fb);
  }

  // 3. Map its memory. A frame that does not start on a memory page is mapped from the page's start.
  std::size_t map_offset = fixed.smem_start % static_cast<unsigned long>(sysconf(_SC_PAGESIZE));
  fb->map_bytes = fixed.smem_len + map_offset;
  fb->map = static_cast<unsigned char*>(driver.map(fb->file, fb->map_bytes));
  if (!fb->map) {
    snprintf(error->text, sizeof error->text, "cannot map %s (%u bytes): %s", path, fixed.smem_len, strerror(errno));
    return fail(fb);
  }
  fb->line_bytes = static_cast<int>(fixed.line_length);
  fb->page_lines = screen_height;
  fb->flips = can_flip(fb, fixed, map_offset);
  unsigned char* shown = fb->map + map_offset + static_cast<std::size_t>(fb->mode.yoffset) * fixed.line_length;
  memset(shown, 0, static_cast<std::size_t>(fixed.line_length) * fb->mode.yres * (fb->flips ? 2 : 1));
  std::size_t top = static_cast<std::size_t>(screen_height - fb->height * fb->scale) / 2;
  std::size_t left = fb->mode.xoffset + static_cast<std::size_t>(screen_width - fb->width * fb->scale) / 2;
  fb->first_row = shown + top * fixed.line_length + left * static_cast<std::size_t>(fb->pixel_bytes);
  if (fb->flips) fb->vsync = vsync_start(driver, fb->file);

  *format = {fb->width,
             fb->height,
             static_cast<int>(fb->mode.bits_per_pixel),
             channel_of(fb->mode.red),
             channel_of(fb->mode.green),
             channel_of(fb->mode.blue),
             channel_of(fb->mode.transp)};
  return true;
}

Page framebuffer_begin_frame(Framebuffer* fb) {
  PLATFORM_CHECK_GE(fb->file, 0);
  if (!fb->flips || fb->scale > 1) return {fb->memory, fb->memory_line_bytes, fb->frames_drawn > 0 ? 1 : 0};
  if (fb->frames_drawn > 0) wait_for_flip(fb);
  return {page_address(fb, 1 - fb->page_shown), fb->line_bytes, fb->frames_drawn > 1 ? 2 : 0};
}

void framebuffer_end_frame(Framebuffer* fb, int row_begin, int row_end) {
  PLATFORM_CHECK_GE(fb->file, 0);
  if (row_begin < 0) row_begin = 0;
  if (row_end > fb->height) row_end = fb->height;
  if (fb->flips && fb->scale > 1) draw_hidden_page(fb, row_begin, row_end);
  ++fb->frames_drawn;
  if (!fb->flips) {
    copy_rows(fb, fb->memory, fb->memory_line_bytes, fb->first_row, row_begin, row_end);
    return;
  }
  fb->mode.yoffset = static_cast<std::uint32_t>((1 - fb->page_shown) * fb->page_lines);
  if (fb->driver->ioctl(fb->file, FBIOPAN_DISPLAY, &fb->mode) == 0) {
    fb->page_shown = 1 - fb->page_shown;
    fb->panned_ns = fb->driver->now_ns();
    return;
  }
  // Panning has stopped working: stay on the visible page and copy this frame and all later ones to it. The back page
  // holds this frame only if it was enlarged from there.
  bool kept = fb->scale > 1;
  copy_rows(fb, kept ? fb->memory : page_address(fb, 1 - fb->page_shown), kept ? fb->memory_line_bytes : fb->line_bytes,
            page_address(fb, fb->page_shown), 0, fb->height);
  fb->first_row = page_address(fb, fb->page_shown);
  fb->flips = false;
  if (!kept) fb->frames_drawn = 0;
}

void framebuffer_close(Framebuffer* fb) {
  if (fb->file < 0) return;
  vsync_stop();
  if (fb->map) {
    fb->driver->unmap(fb->map, fb->map_bytes);
    fb->before.activate = FB_ACTIVATE_NOW | FB_ACTIVATE_FORCE;
    fb->driver->ioctl(fb->file, FBIOPUT_VSCREENINFO, &fb->before);
  }
  fb->driver->close(fb->file);
  fb->file = -1;
  fb->map = nullptr;
}

}  // namespace platform
