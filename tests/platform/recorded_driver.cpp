#include "recorded_driver.h"

#include <errno.h>
#include <linux/kd.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace recorded {

Machine* machine = nullptr;

namespace {

constexpr int kFramebuffer = 100, kTerminal = 101, kFirstInput = 200;

int refuse(int error) {
  errno = error;
  return -1;
}

int do_open(const char* path, int) {
  int file = -1;
  if (std::strcmp(path, "/dev/fb0") == 0 && machine->geometry.width) file = kFramebuffer;
  if (std::strcmp(path, "/dev/tty0") == 0 && machine->has_console) file = kTerminal;
  if (std::strncmp(path, "/dev/input/event", 16) == 0) {
    int index = std::atoi(path + 16);
    if (index < static_cast<int>(machine->inputs.size()) && !machine->inputs[static_cast<std::size_t>(index)].absent)
      file = kFirstInput + index;
  }
  if (file < 0) return refuse(ENOENT);
  ++machine->files_open;
  return file;
}

int do_close(int) {
  --machine->files_open;
  return 0;
}

void fill_mode(fb_var_screeninfo* mode) {
  const Geometry& g = machine->geometry;
  *mode = fb_var_screeninfo();
  mode->xres = mode->xres_virtual = g.width;
  mode->yres = g.height;
  mode->yres_virtual = g.virtual_height;
  mode->yoffset = machine->yoffset;
  mode->bits_per_pixel = g.bits;
  if (g.blind_until_put && !machine->put) return;
  mode->red = g.red, mode->green = g.green, mode->blue = g.blue, mode->transp = g.alpha;
}

void fill_fixed(fb_fix_screeninfo* fixed) {
  const Geometry& g = machine->geometry;
  *fixed = fb_fix_screeninfo();
  fixed->visual = FB_VISUAL_TRUECOLOR;
  fixed->smem_start = 0x10000000ul + g.map_offset;
  fixed->smem_len = g.line_bytes * (g.virtual_height + g.yoffset);
  fixed->ypanstep = static_cast<__u16>(g.pan_step);
  fixed->line_length = g.blind_until_put && !machine->put ? 0 : g.line_bytes;
}

int wait_for_vsync() {
  ++machine->vsync_calls;
  constexpr std::uint64_t kPeriodNs = 16'666'667;
  switch (machine->vsync) {
    case Vsync::absent:
      return refuse(ENOTTY);
    case Vsync::at_once:
      machine->clock_ns += 3000;
      return 0;
    case Vsync::works:
      machine->clock_ns += kPeriodNs - machine->clock_ns % kPeriodNs;
      return 0;
    case Vsync::never:
      break;
  }
  machine->stuck = true;
  while (!machine->release) usleep(1000);
  machine->stuck = false;
  return 0;
}

int pan(const fb_var_screeninfo& mode) {
  if (machine->geometry.pan_step == 0 || ++machine->pans > machine->pans_accepted) return refuse(EINVAL);
  if (mode.yoffset + mode.yres > mode.yres_virtual) return refuse(EINVAL);
  machine->yoffset = mode.yoffset;
  return 0;
}

int do_ioctl(int file, unsigned long request, void* argument) {
  int value = static_cast<int>(reinterpret_cast<std::intptr_t>(argument));
  if (file == kFramebuffer) {
    switch (request) {
      case FBIOGET_VSCREENINFO:
        fill_mode(static_cast<fb_var_screeninfo*>(argument));
        return 0;
      case FBIOGET_FSCREENINFO:
        fill_fixed(static_cast<fb_fix_screeninfo*>(argument));
        return 0;
      case FBIOPUT_VSCREENINFO:
        if (machine->geometry.refuses_put) return refuse(EINVAL);
        ++machine->puts;
        machine->put = true;
        machine->yoffset = machine->geometry.yoffset;
        return 0;
      case FBIOPAN_DISPLAY:
        return pan(*static_cast<fb_var_screeninfo*>(argument));
      case FBIO_WAITFORVSYNC:
        return wait_for_vsync();
      default:
        return refuse(ENOTTY);
    }
  }
  if (file == kTerminal) {
    switch (request) {
      case KDGETMODE:
        *static_cast<int*>(argument) = machine->console_mode;
        return 0;
      case KDGKBMODE:
        *static_cast<int*>(argument) = machine->keyboard_mode;
        return 0;
      case KDSETMODE:
        machine->console_mode = value;
        return 0;
      case KDSKBMODE:
        machine->keyboard_mode = value;
        return 0;
      default:
        return refuse(ENOTTY);
    }
  }
  const InputDevice& input = machine->inputs[static_cast<std::size_t>(file - kFirstInput)];
  input_absinfo range = {};
  if ((request == EVIOCGABS(ABS_X) || request == EVIOCGABS(ABS_Y)) && input.stick)
    range.minimum = 0, range.maximum = 255;
  else if ((request == EVIOCGABS(ABS_HAT0X) || request == EVIOCGABS(ABS_HAT0Y)) && input.hat)
    range.minimum = -1, range.maximum = 1;
  else
    return refuse(EINVAL);
  *static_cast<input_absinfo*>(argument) = range;
  return 0;
}

void* do_map(int, std::size_t bytes) {
  if (bytes > machine->memory.size()) return nullptr;
  ++machine->maps;
  return machine->memory.data();
}
int do_unmap(void*, std::size_t) {
  --machine->maps;
  return 0;
}

ssize_t do_read(int file, void* bytes, std::size_t count) {
  InputDevice& input = machine->inputs[static_cast<std::size_t>(file - kFirstInput)];
  if (input.gone) return refuse(ENODEV);
  if (input.events.empty() || count < sizeof(input_event)) return refuse(EAGAIN);
  std::memcpy(bytes, &input.events.front(), sizeof(input_event));
  input.events.pop_front();
  return sizeof(input_event);
}

int do_poll(pollfd* files, int count) {
  int ready = 0;
  for (int i = 0; i < count; ++i) {
    const InputDevice& input = machine->inputs[static_cast<std::size_t>(files[i].fd - kFirstInput)];
    files[i].revents = static_cast<short>(input.gone ? POLLERR : input.events.empty() ? 0 : POLLIN);
    ready += files[i].revents != 0;
  }
  return ready;
}

std::uint64_t do_now() { return machine->clock_ns; }
void do_sleep(std::uint64_t duration) {
  machine->slept_ns += duration;
  machine->clock_ns += duration;
}

}  // namespace

const platform::Driver kDriver = {do_open, do_close, do_ioctl, do_map, do_unmap, do_read, do_poll, do_now, do_sleep};

void reset(Machine* fresh, const Geometry& geometry, Vsync vsync) {
  machine = fresh;
  fresh->geometry = geometry;
  fresh->vsync = vsync;
  fresh->yoffset = geometry.yoffset;
  fresh->memory.assign(geometry.map_offset + geometry.line_bytes * (geometry.virtual_height + geometry.yoffset), 0xee);
}

const std::uint8_t* shown(int x, int y) {
  const Geometry& g = machine->geometry;
  std::size_t row = machine->yoffset + static_cast<std::size_t>(y);
  return machine->memory.data() + g.map_offset + row * g.line_bytes + static_cast<std::size_t>(x) * (g.bits / 8);
}

}  // namespace recorded
