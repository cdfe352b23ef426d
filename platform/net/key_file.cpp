#include "platform/net/key_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/check.h"

namespace platform {
namespace {

constexpr char kPrefix[] = "pocketray-key-1:";
constexpr std::size_t kPrefixBytes = sizeof kPrefix - 1, kDigitCount = 2 * SharedKey::kByteCount;
constexpr std::size_t kLineBytes = kPrefixBytes + kDigitCount + 1;

__attribute__((format(printf, 2, 3))) bool refuse(FileError* error, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(error->text, sizeof error->text, format, arguments);
  va_end(arguments);
  return false;
}

int value_of(char digit) {
  if (digit >= '0' && digit <= '9') return digit - '0';
  if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
  return digit >= 'A' && digit <= 'F' ? digit - 'A' + 10 : -1;
}

// Reads all bytes up to the end, at most `byte_count_max`; returns -1 with errno on failure.
ssize_t read_whole(int file, char* bytes, std::size_t byte_count_max) {
  std::size_t count = 0;
  while (count < byte_count_max) {
    ssize_t n = ::read(file, bytes + count, byte_count_max - count);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return n;
    if (n == 0) break;
    count += static_cast<std::size_t>(n);
  }
  return static_cast<ssize_t>(count);
}

bool write_whole(int file, const char* bytes, std::size_t byte_count) {
  while (byte_count > 0) {
    ssize_t n = ::write(file, bytes, byte_count);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    bytes += n, byte_count -= static_cast<std::size_t>(n);
  }
  return ::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP;
}

bool parse_line(const char* line, std::size_t byte_count, SharedKey* key) {
  if (byte_count == kLineBytes && line[byte_count - 1] == '\n') --byte_count;
  if (byte_count != kLineBytes - 1 || memcmp(line, kPrefix, kPrefixBytes) != 0) return false;
  for (std::size_t i = 0; i < SharedKey::kByteCount; ++i) {
    int high = value_of(line[kPrefixBytes + 2 * i]), low = value_of(line[kPrefixBytes + 2 * i + 1]);
    if (high < 0 || low < 0) return false;
    key->bytes[i] = static_cast<unsigned char>(16 * high + low);
  }
  return true;
}

}  // namespace

void wipe(void* bytes, std::size_t byte_count) {
  volatile unsigned char* at = static_cast<volatile unsigned char*>(bytes);
  while (byte_count-- > 0) *at++ = 0;
}

bool create_key_file(const char* path, const SharedKey& key, FileError* error) {
  PLATFORM_CHECK(path != nullptr && error != nullptr);
  int file = ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0 && errno == EEXIST)
    return refuse(error, "a file of that name exists: remove it first, or choose another with -o");
  if (file < 0) return refuse(error, "%s", strerror(errno));
  char line[kLineBytes + 1];
  memcpy(line, kPrefix, kPrefixBytes);
  for (std::size_t i = 0; i < SharedKey::kByteCount; ++i)
    snprintf(line + kPrefixBytes + 2 * i, 3, "%02x", key.bytes[i]);
  line[kLineBytes - 1] = '\n';
  // Regardless of the umask, which may have removed even the owner's rights.
  bool ok = ::fchmod(file, S_IRUSR | S_IWUSR) == 0 && write_whole(file, line, kLineBytes);
  int number = errno;
  wipe(line, sizeof line);
  if (::close(file) != 0 && ok) ok = false, number = errno;
  if (ok) return true;
  ::unlink(path);
  return refuse(error, "%s", strerror(number));
}

bool read_key_file(const char* path, SharedKey* key, FileError* error) {
  PLATFORM_CHECK(path != nullptr && key != nullptr && error != nullptr);
  int file = ::open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0 && errno == ENOENT) return refuse(error, "no such file: make one with `pocketray keygen`");
  if (file < 0) return refuse(error, "%s", strerror(errno));
  struct stat about = {};
  char line[kLineBytes + 1];
  bool is_file = ::fstat(file, &about) == 0 && S_ISREG(about.st_mode);
  bool is_private = (about.st_mode & (S_IRWXG | S_IRWXO)) == 0;
  ssize_t count = is_file && is_private ? read_whole(file, line, sizeof line) : 0;
  int number = errno;
  ::close(file);
  if (!is_file) return refuse(error, "not a file: name one made with `pocketray keygen`");
  if (!is_private) return refuse(error, "others may read the key: chmod 600 %.200s", path);
  if (count < 0) return refuse(error, "%s", strerror(number));
  bool ok = parse_line(line, static_cast<std::size_t>(count), key);
  wipe(line, sizeof line);
  return ok || refuse(error, "not a key: make one with `pocketray keygen`");
}

}  // namespace platform
