// All system calls of the Linux backend, as a table: the real ones, or a recorded driver in tests. Return values and
// errno are as for the calls of those names.
#pragma once
#include <poll.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>

namespace platform {

constexpr std::uint64_t kVsyncTimeoutNs = 100'000'000;  // two frames at 20 Hz: no screen is slower

struct Driver {
  int (*open)(const char* path, int flags);
  int (*close)(int file);
  // An integer argument is passed cast to a pointer. Also called from a signal handler and from another thread.
  int (*ioctl)(int file, unsigned long request, void* argument);
  void* (*map)(int file, std::size_t bytes);  // shared, read and write; null on failure
  int (*unmap)(void* address, std::size_t bytes);
  ssize_t (*read)(int file, void* bytes, std::size_t count);
  int (*poll)(pollfd* files, int count);  // does not wait
  std::uint64_t (*now_ns)();
  void (*sleep_ns)(std::uint64_t duration);
  std::uint64_t vsync_timeout_ns = kVsyncTimeoutNs;  // by the system's clock
};

extern const Driver kSystemDriver;
// The backend's driver; changes only while the backend is closed. Tests substitute a recorded one.
extern const Driver* linux_driver;

}  // namespace platform
