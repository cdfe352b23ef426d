#include "platform/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/check.h"

namespace platform {
namespace {

bool fail(FileError* error, const char* what, int number) {
  snprintf(error->text, sizeof error->text, "%s: %s", what, strerror(number));
  return false;
}

// Opens a regular file for reading; on failure returns -1, and `error` says why. open() would wait forever on a pipe
// that nobody writes to, and on some devices; O_NONBLOCK prevents that and does not affect regular files.
int open_regular(const char* path, struct stat* info, FileError* error) {
  int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) {
    fail(error, "cannot be opened", errno);
    return -1;
  }
  bool ok = fstat(descriptor, info) == 0 || fail(error, "cannot be examined", errno);
  if (ok && !S_ISREG(info->st_mode)) {
    ok = false;
    snprintf(error->text, sizeof error->text, "is a folder, a pipe or a device: put a regular file there");
  }
  if (ok) return descriptor;
  close(descriptor);
  return -1;
}

}  // namespace

bool open_reader(const char* path, FileReader* reader, FileError* error) {
  PLATFORM_CHECK(path != nullptr && error != nullptr);
  PLATFORM_CHECK_LT(reader->descriptor, 0);  // the previous file is closed
  struct stat info;
  int descriptor = open_regular(path, &info, error);
  if (descriptor < 0) return false;
  bool ok = info.st_size > 0;
  if (!ok) {
    snprintf(error->text, sizeof error->text, "is empty: create it again");
    close(descriptor);
    return false;
  }
  reader->descriptor = descriptor;
  reader->byte_count = static_cast<std::uint64_t>(info.st_size);
  return true;
}

bool read_bytes(FileReader* reader, void* bytes, std::size_t byte_count, FileError* error) {
  PLATFORM_CHECK_GE(reader->descriptor, 0);
  PLATFORM_CHECK(bytes != nullptr || byte_count == 0);
  char* at = static_cast<char*>(bytes);
  while (byte_count > 0) {
    ssize_t n = read(reader->descriptor, at, byte_count);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return fail(error, "cannot be read", errno);
    if (n == 0) {
      snprintf(error->text, sizeof error->text, "was truncated while being read: try again when it is complete");
      return false;
    }
    at += n;
    byte_count -= static_cast<size_t>(n);
  }
  return true;
}

void close_reader(FileReader* reader) {
  if (reader->descriptor >= 0) close(reader->descriptor);
  *reader = FileReader();
}

bool load_file(const char* path, LoadedFile* file, FileError* error) {
  PLATFORM_CHECK(file != nullptr && file->bytes == nullptr);
  FileReader reader;
  if (!open_reader(path, &reader, error)) return false;
  void* bytes = MAP_FAILED;
  size_t byte_count = static_cast<size_t>(reader.byte_count);
  if (reader.byte_count <= PTRDIFF_MAX)
    bytes = mmap(nullptr, byte_count, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  bool ok = bytes != MAP_FAILED;
  if (!ok)
    snprintf(error->text, sizeof error->text, "has %llu bytes: not enough memory",
             static_cast<unsigned long long>(reader.byte_count));
  if (ok) {
    ok = read_bytes(&reader, bytes, byte_count, error);
    if (ok)
      *file = {static_cast<const std::uint8_t*>(bytes), byte_count};
    else
      munmap(bytes, byte_count);
  }
  close_reader(&reader);
  return ok;
}

void unload_file(LoadedFile* file) {
  if (file->bytes) munmap(const_cast<std::uint8_t*>(file->bytes), file->byte_count);
  *file = LoadedFile();
}

bool list_folder(const char* path, void (*found)(void* context, const char* name), void* context, FileError* error) {
  PLATFORM_CHECK(path != nullptr && found != nullptr);
  DIR* folder = opendir(path);
  if (!folder) return fail(error, "cannot be opened as a folder", errno);
  errno = 0;
  while (const dirent* entry = readdir(folder)) {
    if (entry->d_name[0] != '.') found(context, entry->d_name);
    errno = 0;
  }
  bool ok = errno == 0 || fail(error, "cannot be read", errno);
  closedir(folder);
  return ok;
}

bool make_folder(const char* path, FileError* error) {
  PLATFORM_CHECK(path != nullptr && error != nullptr);
  struct stat info;
  if (mkdir(path, 0777) == 0) return true;
  int number = errno;
  if (stat(path, &info) == 0 && S_ISDIR(info.st_mode)) return true;
  return fail(error, "cannot be created as a folder", number);
}

bool make_temporary_folder(char* path, std::size_t path_bytes, FileError* error) {
  PLATFORM_CHECK(path != nullptr && path_bytes > 0);
  const char* where = getenv("TMPDIR");
  if (!where || !*where) where = "/tmp";
  int length = snprintf(path, path_bytes, "%s/pocketray_XXXXXX", where);
  bool fits = length >= 0 && static_cast<size_t>(length) < path_bytes;
  if (fits && mkdtemp(path)) return true;
  int number = fits ? errno : ENAMETOOLONG;
  path[0] = 0;  // not another user's folder
  return fail(error, "of TMPDIR: no folder can be made there", number);
}

void remove_folder(const char* path) {
  PLATFORM_CHECK(path != nullptr && *path != 0);
  int descriptor = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  FileError error;
  list_folder(
      path, [](void* folder, const char* name) { unlinkat(*static_cast<int*>(folder), name, 0); }, &descriptor, &error);
  close(descriptor);
  rmdir(path);
}

std::uint64_t file_stamp(const char* path) {
  PLATFORM_CHECK(path != nullptr);
  struct stat info;
  if (stat(path, &info) != 0) return 0;
  std::uint64_t time =
      static_cast<std::uint64_t>(info.st_mtim.tv_sec) * 1000000000u + static_cast<std::uint64_t>(info.st_mtim.tv_nsec);
  return (time * 31 + static_cast<std::uint64_t>(info.st_size)) | 1;
}

bool stderr_is_terminal() { return isatty(STDERR_FILENO) != 0; }

}  // namespace platform
