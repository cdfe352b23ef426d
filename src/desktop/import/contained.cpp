#include "desktop/import/contained.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#include "desktop/import/files.h"
#include "desktop/import/import_error.h"
#include "scene/baked.h"

// Sanitizers reserve terabytes of address space, so their builds set no memory limit.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define POCKETRAY_ADDRESS_SPACE_IS_SHADOWED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define POCKETRAY_ADDRESS_SPACE_IS_SHADOWED 1
#endif
#endif

namespace pocketray {
namespace {

// Header of the child's result; the text (a warning or error), the names of materials and parts and the baked scene
// follow.
struct ResultHeader {
  std::uint32_t read;  // 1 if a scene follows
  std::uint32_t text_bytes, name_bytes;
  std::uint64_t scene_bytes;
};
constexpr std::uint32_t kTextBytesMax = 1u << 20;
constexpr std::size_t kAlignment = 64;  // of a baked scene

struct FreeBlock {
  void operator()(std::uint8_t* block) const { std::free(block); }
};
using Block = std::unique_ptr<std::uint8_t, FreeBlock>;
using SteadyClock = std::chrono::steady_clock;

Block take_aligned(std::size_t bytes) {
  void* block = nullptr;
  if (posix_memalign(&block, kAlignment, std::max<std::size_t>(bytes, 1)) != 0) throw std::bad_alloc();
  return Block(static_cast<std::uint8_t*>(block));
}

bool write_all(int pipe, const void* data, std::size_t count) {
  const char* at = static_cast<const char*>(data);
  while (count > 0) {
    ssize_t written = write(pipe, at, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written, count -= static_cast<std::size_t>(written);
  }
  return true;
}

// Returns false once the deadline has passed.
bool wait_for_data(int pipe, SteadyClock::time_point deadline) {
  pollfd waiting = {pipe, POLLIN, 0};
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - SteadyClock::now()).count();
    const int ready = poll(&waiting, 1, static_cast<int>(std::clamp<decltype(left)>(left, 0, 1000)));
    if (ready > 0) return true;
    if (left <= 0 || (ready < 0 && errno != EINTR)) return false;
  }
}
bool read_all(int pipe, void* data, std::size_t count, SteadyClock::time_point deadline) {
  char* at = static_cast<char*>(data);
  while (count > 0) {
    if (!wait_for_data(pipe, deadline)) return false;
    ssize_t got = read(pipe, at, count);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got, count -= static_cast<std::size_t>(got);
  }
  return true;
}

void limit(int what, std::uint64_t value) {
  rlimit now;
  if (getrlimit(what, &now) != 0) return;
  if (now.rlim_max != RLIM_INFINITY && value > now.rlim_max) value = now.rlim_max;
  now.rlim_cur = static_cast<rlim_t>(value);
  now.rlim_max = static_cast<rlim_t>(what == RLIMIT_CPU ? value + 1 : value);
  setrlimit(what, &now);
}

// Limits the process to `more_bytes` beyond its current memory; no limit if that is unknown or with sanitizers.
void limit_memory([[maybe_unused]] std::uint64_t more_bytes) {
#if !defined(POCKETRAY_ADDRESS_SPACE_IS_SHADOWED)
  unsigned long long pages = 0;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen("/proc/self/statm", "r"), std::fclose);
  if (!file || std::fscanf(file.get(), "%llu", &pages) != 1 || pages == 0) return;
  limit(RLIMIT_AS, pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + more_bytes);
#endif
}

// Isolates the child: default signal handlers, no output, no core file.
void become_contained(const ContainerLimits& limits) {
  for (int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGXCPU})
    signal(signal_number, SIG_DFL);
  int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (nowhere >= 0) dup2(nowhere, descriptor);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.cpu_seconds);
  if (limits.memory_bytes > 0) limit_memory(limits.memory_bytes);
}

std::uint32_t text_bytes(const std::string& text) {
  return static_cast<std::uint32_t>(std::min<std::size_t>(text.size(), kTextBytesMax));
}

bool send_result(int pipe, bool read, const std::string& text, const std::string& names, const std::uint8_t* scene,
                 std::size_t scene_bytes) {
  ResultHeader header;
  header.read = read;
  header.text_bytes = text_bytes(text), header.name_bytes = text_bytes(names);
  header.scene_bytes = scene_bytes;
  return write_all(pipe, &header, sizeof header) && write_all(pipe, text.data(), header.text_bytes) &&
         write_all(pipe, names.data(), header.name_bytes) && write_all(pipe, scene, scene_bytes);
}

std::string one_line(std::string name) {
  std::replace(name.begin(), name.end(), '\n', ' ');
  return name;
}

// Exchanges line feeds for the one byte that no path contains, so that a path fits into a line; and back.
std::string exchanged(std::string path, char from, char to) {
  std::replace(path.begin(), path.end(), from, to);
  return path;
}

// One line per file, material and part. Files, whose names are bounded, come first, because the end may be
// truncated.
std::string join_names(const ImportedScene& imported) {
  static_assert(kFilesReadBytesMax <= kTextBytesMax / 2, "all files are told");
  std::string lines;
  for (const std::string& path : imported.files) lines += "file " + exchanged(path, '\n', '\0') + '\n';
  for (const std::string& name : imported.material_names) lines += "material " + one_line(name) + '\n';
  for (const auto& part : imported.parts) {
    const Vec3 &low = part.second.low, &high = part.second.high;
    char numbers[200];
    std::snprintf(numbers, sizeof numbers, "part %a %a %a %a %a %a ", static_cast<double>(low.x),
                  static_cast<double>(low.y), static_cast<double>(low.z), static_cast<double>(high.x),
                  static_cast<double>(high.y), static_cast<double>(high.z));
    lines += numbers + one_line(part.first) + '\n';
  }
  return lines;
}

// Skips malformed lines from the child.
void split_names(const std::string& lines, ImportedScene* imported) {
  const std::string material = "material ", file = "file ";
  for (std::size_t at = 0, end; (end = lines.find('\n', at)) != std::string::npos; at = end + 1) {
    const std::string line = lines.substr(at, end - at);
    Box box;
    int used = 0;
    if (line.compare(0, material.size(), material) == 0)
      imported->material_names.push_back(line.substr(material.size()));
    else if (line.compare(0, file.size(), file) == 0)
      imported->files.push_back(exchanged(line.substr(file.size()), '\0', '\n'));
    else if (std::sscanf(line.c_str(), "part %a %a %a %a %a %a%n", &box.low.x, &box.low.y, &box.low.z, &box.high.x,
                         &box.high.y, &box.high.z, &used) == 6 &&
             used > 0 && static_cast<std::size_t>(used) < line.size() && is_finite(box.low) && is_finite(box.high) &&
             !is_empty(box))
      imported->parts.emplace_back(line.substr(static_cast<std::size_t>(used) + 1), box);
  }
}

bool read_and_send(int pipe, const std::function<void(ImportedScene*)>& read) {
  try {
    ImportedScene imported;
    read(&imported);
    std::size_t bytes = baked_size(imported.scene);
    Block block = take_aligned(bytes);
    baked_write(imported.scene, block.get());
    return send_result(pipe, true, imported.warning, join_names(imported), block.get(), bytes);
  } catch (const std::bad_alloc&) {
    return send_result(pipe, false, "not enough memory to read it; use a smaller model", "", nullptr, 0);
  } catch (const std::exception& error) {
    return send_result(pipe, false, error.what(), "", nullptr, 0);
  } catch (...) {
    return send_result(pipe, false, "cannot be read; export the file again", "", nullptr, 0);
  }
}

// Returns false if the child did not finish.
bool receive_result(int pipe, const ContainerLimits& limits, ResultHeader* header, std::string* text,
                    std::string* names, Block* block) {
  const SteadyClock::time_point deadline = SteadyClock::now() + std::chrono::seconds(limits.elapsed_seconds);
  if (!read_all(pipe, header, sizeof *header, deadline)) return false;
  if (header->text_bytes > kTextBytesMax || header->name_bytes > kTextBytesMax) return false;
  text->resize(header->text_bytes), names->resize(header->name_bytes);
  if (!read_all(pipe, &(*text)[0], text->size(), deadline)) return false;
  if (!read_all(pipe, &(*names)[0], names->size(), deadline)) return false;
  if (header->scene_bytes > limits.result_bytes_max)
    fail_import("the scene would take %llu MiB; use a smaller model",
                static_cast<unsigned long long>(header->scene_bytes >> 20));
  *block = take_aligned(static_cast<std::size_t>(header->scene_bytes));
  return read_all(pipe, block->get(), static_cast<std::size_t>(header->scene_bytes), deadline);
}

[[noreturn]] void fail_as_ended(int status, const ContainerLimits& limits) {
  int signal_number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal_number == SIGXCPU || signal_number == SIGKILL)
    fail_import(
        "reading it took more than %u seconds of processor time, %u seconds in all, or too much memory; export "
        "the file again, or a smaller one",
        limits.cpu_seconds, limits.elapsed_seconds);
  if (signal_number == SIGINT || signal_number == SIGTERM || signal_number == SIGHUP)
    fail_import("reading was interrupted; start again");
  fail_import("its reader crashed (signal %d), so it is damaged or of an unknown kind; export the file again",
              signal_number);
}

// A running child and its pipe; the destructor ends both.
struct Child {
  pid_t id = -1;
  int pipe = -1;
  int status = 0;
  void close_pipe() {
    if (pipe >= 0) close(pipe);
    pipe = -1;
  }
  void wait_for_end() {
    while (id > 0 && waitpid(id, &status, 0) < 0 && errno == EINTR) {
    }
    id = -1;
  }
  void end() {
    if (id > 0) kill(id, SIGKILL);  // no effect on one that has ended
  }
  ~Child() {
    close_pipe();
    end();
    wait_for_end();
  }
};

}  // namespace

void import_contained(const ContainerLimits& limits, const std::function<void(ImportedScene*)>& read,
                      ImportedScene* result) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail_import("cannot create a pipe to read it: %s", std::strerror(errno));
  Child child;
  child.pipe = ends[0];
  child.id = fork();
  if (child.id == 0) {
    close(ends[0]);
    become_contained(limits);
    _exit(read_and_send(ends[1], read) ? 0 : 1);
  }
  int fork_error = errno;
  close(ends[1]);
  if (child.id < 0) fail_import("cannot create a process to read it: %s; try again", std::strerror(fork_error));

  ResultHeader header = {};
  std::string text, names;
  Block block;
  bool complete = receive_result(child.pipe, limits, &header, &text, &names, &block);
  child.close_pipe();
  if (!complete) child.end();
  child.wait_for_end();
  if (!complete) fail_as_ended(child.status, limits);
  if (!header.read) fail_import("%s", text.c_str());
  Status status = baked_open(block.get(), static_cast<std::size_t>(header.scene_bytes), &result->scene);
  if (!status.ok) fail_import("%s", status.message);
  result->storage = std::shared_ptr<void>(block.release(), [](void* data) { std::free(data); });
  result->warning = text;
  split_names(names, result);
}

}  // namespace pocketray
