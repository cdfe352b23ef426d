#include "platform/linux/vsync.h"

#include <errno.h>
#include <linux/fb.h>
#include <pthread.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <time.h>

namespace platform {
namespace {

enum class Request : std::uint8_t { none, wait, stop };

// Shared with the helper thread, which may outlive vsync_stop() while stuck in the driver: static, and not reused until
// the thread returns.
struct Waiter {
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  pthread_cond_t changed;
  bool has_condition = false;
  pthread_t thread;
  bool has_thread = false;
  Request request = Request::none;
  bool busy = false;  // the helper is inside the driver
  int result = 0;
  const Driver* driver = nullptr;
  int file = -1;
  VsyncKind kind = VsyncKind::absent;
  std::uint64_t period_ns = 0;
};
Waiter waiter;

void* run_helper(void*) {
  pthread_mutex_lock(&waiter.mutex);
  for (;;) {
    while (waiter.request == Request::none) pthread_cond_wait(&waiter.changed, &waiter.mutex);
    if (waiter.request == Request::stop) break;
    waiter.request = Request::none;
    pthread_mutex_unlock(&waiter.mutex);
    std::uint32_t screen = 0;
    int result = waiter.driver->ioctl(waiter.file, FBIO_WAITFORVSYNC, &screen);
    pthread_mutex_lock(&waiter.mutex);
    waiter.busy = false;
    waiter.result = result;
    pthread_cond_signal(&waiter.changed);
  }
  pthread_mutex_unlock(&waiter.mutex);
  return nullptr;
}

bool start_helper() {
  if (!waiter.has_condition) {
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    waiter.has_condition = pthread_cond_init(&waiter.changed, &attributes) == 0;
    pthread_condattr_destroy(&attributes);
    if (!waiter.has_condition) return false;
  }
  // Only the main thread handles signals.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  waiter.request = Request::none;
  waiter.has_thread = pthread_create(&waiter.thread, nullptr, run_helper, nullptr) == 0;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return waiter.has_thread;
}

// Waits once: as long as the driver takes, but at most the timeout.
VsyncKind wait_bounded() {
  timespec deadline;
  clock_gettime(CLOCK_MONOTONIC, &deadline);
  std::uint64_t nanoseconds = static_cast<std::uint64_t>(deadline.tv_nsec) + waiter.driver->vsync_timeout_ns;
  deadline.tv_sec += static_cast<time_t>(nanoseconds / 1'000'000'000);
  deadline.tv_nsec = static_cast<long>(nanoseconds % 1'000'000'000);

  pthread_mutex_lock(&waiter.mutex);
  waiter.request = Request::wait;
  waiter.busy = true;
  pthread_cond_broadcast(&waiter.changed);
  int error = 0;
  while (waiter.busy && error != ETIMEDOUT) error = pthread_cond_timedwait(&waiter.changed, &waiter.mutex, &deadline);
  VsyncKind kind = waiter.busy ? VsyncKind::never : waiter.result != 0 ? VsyncKind::absent : VsyncKind::works;
  pthread_mutex_unlock(&waiter.mutex);
  return kind;
}

}  // namespace

VsyncKind vsync_start(const Driver& driver, int file) {
  vsync_stop();
  if (waiter.has_thread) return VsyncKind::never;  // still stuck from an earlier wait
  waiter.driver = &driver;
  waiter.file = file;
  waiter.period_ns = 0;
  waiter.kind = start_helper() ? VsyncKind::works : VsyncKind::absent;

  // The first wait ends somewhere within a frame. The following ones take a frame each, or no time if the driver does
  // not wait.
  constexpr int kTimedWaits = 3;
  constexpr std::uint64_t kPeriodMinNs = 2'000'000;  // 500 Hz
  if (waiter.kind == VsyncKind::works) waiter.kind = wait_bounded();
  std::uint64_t start = driver.now_ns();
  for (int i = 0; i < kTimedWaits && waiter.kind == VsyncKind::works; ++i) waiter.kind = wait_bounded();
  if (waiter.kind != VsyncKind::works) return waiter.kind;
  std::uint64_t period = (driver.now_ns() - start) / kTimedWaits;
  if (period < kPeriodMinNs) return waiter.kind = VsyncKind::at_once;
  waiter.period_ns = period;
  return VsyncKind::works;
}

std::uint64_t vsync_period_ns() { return waiter.period_ns; }

VsyncKind vsync_wait() {
  if (waiter.kind == VsyncKind::works) waiter.kind = wait_bounded();
  if (waiter.kind != VsyncKind::works) waiter.period_ns = 0;
  return waiter.kind;
}

void vsync_stop() {
  if (!waiter.has_thread) return;
  pthread_mutex_lock(&waiter.mutex);
  bool stuck = waiter.busy;
  waiter.request = Request::stop;  // a stuck helper sees it when it returns
  pthread_cond_broadcast(&waiter.changed);
  pthread_mutex_unlock(&waiter.mutex);
  waiter.kind = VsyncKind::absent;
  waiter.period_ns = 0;
  if (stuck) return;
  pthread_join(waiter.thread, nullptr);
  waiter.has_thread = false;
}

}  // namespace platform
