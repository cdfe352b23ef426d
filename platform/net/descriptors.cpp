#include "platform/net/descriptors.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

namespace platform {

int descriptors_left(int wanted) {
  rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return wanted;
  // Counts open descriptors up to the highest possible one, but no more than a few thousand.
  constexpr rlim_t kLookedAt = 4096;
  auto free_below = [](rlim_t end) {
    int count = 0;
    for (rlim_t i = 0; i < end && i < kLookedAt; ++i)
      count += fcntl(static_cast<int>(i), F_GETFD) < 0 && errno == EBADF ? 1 : 0;
    return count;
  };
  int left = free_below(limit.rlim_cur);
  if (left < wanted && limit.rlim_cur < limit.rlim_max) {
    rlim_t target = limit.rlim_cur + static_cast<rlim_t>(wanted - left);
    limit.rlim_cur = target < limit.rlim_max ? target : limit.rlim_max;
    if (setrlimit(RLIMIT_NOFILE, &limit) == 0) left = free_below(limit.rlim_cur);
  }
  return left < wanted ? left : wanted;
}

bool is_shortage(int error_number) {
  return error_number == EMFILE || error_number == ENFILE || error_number == ENOMEM || error_number == ENOBUFS;
}

int take_spare() { return open("/dev/null", O_RDONLY | O_CLOEXEC); }

int turn_away(int listener, int spare) {
  if (spare < 0) return take_spare();
  close(spare);
  int peer = ::accept(listener, nullptr, nullptr);
  if (peer >= 0) close(peer);
  return take_spare();
}

}  // namespace platform
