// The real system calls, and the clocks: CLOCK_MONOTONIC, which is never set back, and a thread's CPU time.
#include <errno.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "platform/cpu_time.h"
#include "platform/linux/driver.h"

namespace platform {
namespace {

int system_open(const char* path, int flags) { return ::open(path, flags | O_CLOEXEC); }
int system_ioctl(int file, unsigned long request, void* argument) { return ::ioctl(file, request, argument); }

void* system_map(int file, std::size_t bytes) {
  void* address = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  return address == MAP_FAILED ? nullptr : address;
}

int system_poll(pollfd* files, int count) { return ::poll(files, static_cast<nfds_t>(count), 0); }

std::uint64_t now_by(clockid_t clock) {
  timespec now;
  clock_gettime(clock, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000 + static_cast<std::uint64_t>(now.tv_nsec);
}

std::uint64_t system_now_ns() { return now_by(CLOCK_MONOTONIC); }

void system_sleep_ns(std::uint64_t duration) {
  timespec left = {static_cast<time_t>(duration / 1'000'000'000), static_cast<long>(duration % 1'000'000'000)};
  while (nanosleep(&left, &left) != 0 && errno == EINTR) {
  }
}

}  // namespace

std::uint64_t thread_cpu_ns() { return now_by(CLOCK_THREAD_CPUTIME_ID); }

const Driver kSystemDriver = {system_open, ::close,     system_ioctl,  system_map,     ::munmap,
                              ::read,      system_poll, system_now_ns, system_sleep_ns};

}  // namespace platform
