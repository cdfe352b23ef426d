// Writes files: the part of file.h that replaces files as a whole.
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <initializer_list>

#include "platform/check.h"
#include "platform/file.h"

namespace platform {
namespace {

constexpr int kLinkCountMax = 40;       // in a row, as in Linux
constexpr int kPartCountMax = 100;      // names to try; files of killed programs may be in the way
constexpr size_t kPartStemBytes = 200;  // bytes of the file's name in its part's name: names have at most 255 bytes

int data_output = STDOUT_FILENO;  // what "-" names

bool fail(FileError* error, const char* what, int number) {
  snprintf(error->text, sizeof error->text, "%s: %s", what, strerror(number));
  return false;
}

bool fail_as_too_long(FileError* error) {
  snprintf(error->text, sizeof error->text, "the path is longer than %zu bytes: use a shorter one",
           kWriterPathBytes - 1);
  return false;
}

bool starts_with(const char* text, const char* start) { return strncmp(text, start, strlen(start)) == 0; }

// Returns the descriptor of this process that a path names, or -1. Opening it again would truncate or overwrite data
// already written to it.
int descriptor_named(const char* path) {
  if (strcmp(path, "/dev/stdout") == 0) return STDOUT_FILENO;
  if (strcmp(path, "/dev/stderr") == 0) return STDERR_FILENO;
  for (const char* folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!starts_with(path, folder)) continue;
    const char* digits = path + strlen(folder);
    size_t length = strlen(digits);
    if (length > 0 && length < 9 && strspn(digits, "0123456789") == length) return atoi(digits);
  }
  return -1;
}

// Returns the length of a path's folder, including its last slash; 0: no folder.
size_t folder_length(const char* path) {
  const char* slash = strrchr(path, '/');
  return slash ? static_cast<size_t>(slash - path) + 1 : 0;
}

// Follows the links at the end of a path, even if the target does not exist. Stops at a link that names a descriptor of
// this process.
bool follow_links(const char* path, char* target, FileError* error) {
  if (strlen(path) >= kWriterPathBytes) return fail_as_too_long(error);
  strcpy(target, path);
  for (int i = 0; i < kLinkCountMax && descriptor_named(target) < 0; ++i) {
    char link[kWriterPathBytes], next[2 * kWriterPathBytes];
    ssize_t n = readlink(target, link, sizeof link - 1);
    if (n < 0) return true;  // not a link, or nothing there
    link[n] = 0;
    size_t folder = link[0] == '/' ? 0 : folder_length(target);
    memcpy(next, target, folder);
    strcpy(next + folder, link);
    if (strlen(next) >= kWriterPathBytes) return fail_as_too_long(error);
    strcpy(target, next);
  }
  return descriptor_named(target) >= 0 || fail(error, "cannot be written", ELOOP);
}

// The target of a path to be written.
struct Destination {
  char path[kWriterPathBytes];  // with links followed
  int descriptor = -1;          // of this process, to write to
  bool is_direct = false;       // something other than a regular file exists there
  bool is_there = false;
  struct stat info = {};  // if it exists
};

bool find_destination(const char* path, Destination* d, FileError* error) {
  if (!*path) {
    snprintf(error->text, sizeof error->text, "the path is empty: name a file");
    return false;
  }
  if (!follow_links(path, d->path, error)) return false;
  d->descriptor = descriptor_named(d->path);
  // Only the system can follow a link to a pipe.
  d->is_there = stat(path, &d->info) == 0;
  if (d->descriptor >= 0) {
    d->is_direct = true;
    return fcntl(d->descriptor, F_GETFD) >= 0 || fail(error, "cannot be written", errno);
  }
  if (!d->is_there) return true;
  if (S_ISDIR(d->info.st_mode)) {
    snprintf(error->text, sizeof error->text, "is a folder: name a file in it");
    return false;
  }
  d->is_direct = !S_ISREG(d->info.st_mode);
  return faccessat(AT_FDCWD, path, W_OK, AT_EACCESS) == 0 || fail(error, "cannot be written", errno);
}

// Opens a new file next to the one to replace, with an unused name: not another program's part, nor a planted link.
bool open_part(const Destination& d, FileWriter* writer, FileError* error) {
  size_t folder = folder_length(d.path);
  size_t name = strlen(d.path) - folder, stem = name < kPartStemBytes ? name : kPartStemBytes;
  mode_t mode = d.is_there ? 0600 : 0666;
  for (int i = 0; i < kPartCountMax; ++i) {
    int length = static_cast<int>(folder + stem);
    snprintf(writer->part, sizeof writer->part, "%.*s.%ld-%d.part", length, d.path, static_cast<long>(getpid()), i);
    writer->descriptor = open(writer->part, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (writer->descriptor >= 0 || errno != EEXIST) break;
  }
  return writer->descriptor >= 0 || fail(error, "cannot be written", errno);
}

// Gives the part the permissions of the file it replaces. If its group cannot be kept, the new group gets no more than
// everybody.
bool keep_permissions(const Destination& d, int part) {
  mode_t mode = d.info.st_mode & 0777;
  struct stat now;
  if (fstat(part, &now) != 0) return false;
  if (now.st_uid != d.info.st_uid && fchown(part, d.info.st_uid, static_cast<gid_t>(-1)) != 0) errno = 0;
  if (now.st_gid != d.info.st_gid && fchown(part, static_cast<uid_t>(-1), d.info.st_gid) != 0)
    mode = (mode & 0707) | ((mode & 07) << 3);
  return fchmod(part, mode) == 0;
}

// Some file systems cannot do this and report it.
bool bring_to_disk(int descriptor) {
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS || errno == ENOTSUP;
}

// Makes the new name survive a power cut. The file is complete either way, so a failure is ignored.
void bring_folder_to_disk(const char* path) {
  char folder[kWriterPathBytes];
  size_t length = folder_length(path);
  memcpy(folder, path, length);
  folder[length] = 0;
  int descriptor = open(length ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)bring_to_disk(descriptor);
  close(descriptor);
}

bool (*is_stopped)() = nullptr;

// Opens something other than a regular file. A pipe waits for its reader; open() would keep waiting after Ctrl-C.
int open_direct(const char* path) {
  constexpr struct timespec kLook = {0, 20'000'000};
  for (;;) {
    const int descriptor = open(path, O_WRONLY | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor >= 0) {
      const int flags = fcntl(descriptor, F_GETFL);
      if (flags >= 0 && fcntl(descriptor, F_SETFL, flags & ~O_NONBLOCK) == 0) return descriptor;
      const int number = errno;
      close(descriptor);
      errno = number;
      return -1;
    }
    struct stat info;
    if (errno != ENXIO || stat(path, &info) != 0 || !S_ISFIFO(info.st_mode)) return -1;
    errno = EINTR;
    if (is_stopped && is_stopped()) return -1;
    nanosleep(&kLook, nullptr);
  }
}

void remove_part(FileWriter* writer) {
  if (writer->part[0]) unlink(writer->part);
}

}  // namespace

void stop_waiting_if(bool (*stopped)()) { is_stopped = stopped; }

bool open_writer(const char* path, FileWriter* writer, FileError* error) {
  PLATFORM_CHECK(path != nullptr && error != nullptr);
  PLATFORM_CHECK_LT(writer->descriptor, 0);  // the previous file is closed
  *writer = FileWriter();
  if (strcmp(path, "-") == 0) {
    writer->descriptor = data_output;
    return true;
  }
  Destination d;
  if (!find_destination(path, &d, error)) return false;
  if (d.is_direct) {
    writer->descriptor = d.descriptor >= 0 ? fcntl(d.descriptor, F_DUPFD_CLOEXEC, 3) : open_direct(path);
    if (writer->descriptor < 0 && errno == EINTR) {
      snprintf(error->text, sizeof error->text, "is a pipe that nobody read before the interruption");
      return false;
    }
    return writer->descriptor >= 0 || fail(error, "cannot be written", errno);
  }
  if (!open_part(d, writer, error)) return false;
  strcpy(writer->path, d.path);
  if (!d.is_there || keep_permissions(d, writer->descriptor)) return true;
  int number = errno;
  discard_writer(writer);
  return fail(error, "cannot be replaced with its permissions kept", number);
}

bool open_growing_writer(const char* path, const void* bytes, std::size_t byte_count, FileWriter* writer,
                         FileError* error) {
  PLATFORM_CHECK(path != nullptr && error != nullptr);
  PLATFORM_CHECK_LT(writer->descriptor, 0);
  *writer = FileWriter();
  if (strlen(path) >= kWriterPathBytes) return fail_as_too_long(error);
  Destination d;
  strcpy(d.path, path);
  d.is_there = lstat(path, &d.info) == 0 && S_ISREG(d.info.st_mode);
  if (!open_part(d, writer, error)) return false;
  write_bytes(writer, bytes, byte_count);
  bool ok = !writer->failed && (!d.is_there || keep_permissions(d, writer->descriptor)) &&
            bring_to_disk(writer->descriptor) && rename(writer->part, path) == 0;
  if (!ok) {
    fail(error, "cannot be written completely", errno);
    discard_writer(writer);
    return false;
  }
  bring_folder_to_disk(path);
  writer->part[0] = 0;  // it has its final name: from here on it is written directly
  return true;
}

void write_bytes(FileWriter* writer, const void* bytes, std::size_t byte_count) {
  PLATFORM_CHECK_GE(writer->descriptor, 0);
  PLATFORM_CHECK(bytes != nullptr || byte_count == 0);
  const char* at = static_cast<const char*>(bytes);
  while (byte_count > 0 && !writer->failed) {
    ssize_t n = write(writer->descriptor, at, byte_count);
    if (n > 0) {
      at += n;
      byte_count -= static_cast<size_t>(n);
    } else if (n == 0 || errno != EINTR) {
      writer->failed = true;
    }
  }
}

bool rewrite_bytes(FileWriter* writer, std::uint64_t offset, const void* bytes, std::size_t byte_count) {
  PLATFORM_CHECK_GE(writer->descriptor, 0);
  PLATFORM_CHECK(bytes != nullptr && byte_count > 0);
  if (!writer->path[0]) return false;
  ssize_t n = pwrite(writer->descriptor, bytes, byte_count, static_cast<off_t>(offset));
  if (n != static_cast<ssize_t>(byte_count)) writer->failed = true;
  return true;
}

bool close_writer(FileWriter* writer, FileError* error) {
  PLATFORM_CHECK_GE(writer->descriptor, 0);
  bool is_direct = !writer->path[0];
  bool ok = !writer->failed && (is_direct || bring_to_disk(writer->descriptor));
  if (writer->descriptor != data_output && close(writer->descriptor) != 0) ok = false;
  writer->descriptor = -1;
  if (!ok) {
    remove_part(writer);
    snprintf(error->text, sizeof error->text,
             is_direct ? "did not take all data: is it full or closed?"
                       : "could not be written completely: is the disk full?");
    return false;
  }
  if (is_direct) return true;
  if (rename(writer->part, writer->path) != 0) {
    int number = errno;
    remove_part(writer);
    return fail(error, "cannot be replaced", number);
  }
  bring_folder_to_disk(writer->path);
  return true;
}

void discard_writer(FileWriter* writer) {
  if (writer->descriptor < 0) return;
  if (writer->descriptor != data_output) close(writer->descriptor);
  writer->descriptor = -1;
  remove_part(writer);
}

bool keep_output_for_data(FileError* error) {
  PLATFORM_CHECK(error != nullptr);
  if (is_output_for_data()) return true;
  if (isatty(STDOUT_FILENO)) {
    snprintf(error->text, sizeof error->text, "is a terminal: redirect it to a file or another program");
    return false;
  }
  fflush(stdout);
  int kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (kept < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) return fail(error, "cannot be written", errno);
  data_output = kept;
  return true;
}

bool is_output_for_data() { return data_output != STDOUT_FILENO; }

bool can_write(const char* path, FileError* error) {
  PLATFORM_CHECK(path != nullptr && error != nullptr);
  if (strcmp(path, "-") == 0) return true;
  Destination d;
  if (!find_destination(path, &d, error)) return false;
  if (d.is_direct) return true;
  FileWriter writer;
  if (!open_part(d, &writer, error)) return false;
  discard_writer(&writer);
  return true;
}

bool is_device_or_pipe(const char* path) {
  PLATFORM_CHECK(path != nullptr);
  Destination d;
  FileError error;
  return strcmp(path, "-") == 0 || (find_destination(path, &d, &error) && d.is_direct);
}

bool is_plain_or_absent(const char* path) {
  PLATFORM_CHECK(path != nullptr);
  struct stat info;
  return lstat(path, &info) != 0 || S_ISREG(info.st_mode);
}

bool is_same_file(const char* one, const char* other) {
  PLATFORM_CHECK(one != nullptr && other != nullptr);
  struct stat a, b;
  bool there = stat(one, &a) == 0;
  if (there != (stat(other, &b) == 0)) return false;
  if (there) return S_ISREG(a.st_mode) && a.st_dev == b.st_dev && a.st_ino == b.st_ino;
  char targets[2][kWriterPathBytes];
  FileError error;
  if (!follow_links(one, targets[0], &error) || !follow_links(other, targets[1], &error)) return false;
  size_t lengths[2];
  for (int i = 0; i < 2; ++i) {
    char* target = targets[i];
    lengths[i] = folder_length(target);
    char first = target[lengths[i]];
    target[lengths[i]] = 0;
    bool found = stat(lengths[i] ? target : ".", i ? &b : &a) == 0;
    target[lengths[i]] = first;
    if (!found) return false;
  }
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino && strcmp(targets[0] + lengths[0], targets[1] + lengths[1]) == 0;
}

}  // namespace platform
