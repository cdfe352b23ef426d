#include "platform/entropy.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "platform/check.h"

namespace platform {
namespace {

// Linux 3.17 and later. Called by number: older C libraries have no function for it.
bool ask_kernel(unsigned char* bytes, std::size_t byte_count) {
#ifdef SYS_getrandom
  constexpr unsigned kDoNotWait = 1;  // GRND_NONBLOCK: early in the boot there is no entropy yet
  while (byte_count > 0) {
    long count = ::syscall(SYS_getrandom, bytes, byte_count, kDoNotWait);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes += count, byte_count -= static_cast<std::size_t>(count);
  }
  return true;
#else
  return byte_count == 0 && bytes;
#endif
}

bool read_device(unsigned char* bytes, std::size_t byte_count) {
  int file = ::open("/dev/urandom", O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  while (byte_count > 0) {
    ssize_t count = ::read(file, bytes, byte_count);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    bytes += count, byte_count -= static_cast<std::size_t>(count);
  }
  ::close(file);
  return byte_count == 0;
}

}  // namespace

bool random_bytes(void* bytes, std::size_t byte_count) {
  PLATFORM_CHECK(bytes != nullptr || byte_count == 0);
  unsigned char* at = static_cast<unsigned char*>(bytes);
  return ask_kernel(at, byte_count) || read_device(at, byte_count);
}

}  // namespace platform
