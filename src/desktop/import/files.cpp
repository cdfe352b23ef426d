#include "desktop/import/files.h"

#include <dirent.h>
#include <fcntl.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "base/check.h"
#include "desktop/import/import_error.h"

namespace pocketray {

static constexpr std::size_t kNoteBytes = 16;  // overhead of a short name besides its text

void note_file(FilesRead* files, const std::string& path) {
  CHECK(files != nullptr);
  if (!files->paths.insert(path).second) return;
  files->byte_count += path.size() + kNoteBytes;
  if (files->byte_count > kFilesReadBytesMax) fail_import("it names too many files; merge some");
}

Bytes read_file(const std::string& path, std::uint64_t byte_count_max, FilesRead* files) {
  // Non-blocking, since open() on a pipe would wait for a writer. Checks the open descriptor, so that the checked file
  // is the one read.
  int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0)
    fail_import("cannot read %s: %s; check its name and location", path.c_str(), std::strerror(errno));
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(fdopen(descriptor, "rb"), std::fclose);
  if (!file) close(descriptor);
  struct stat info;
  if (!file || fstat(descriptor, &info) != 0) fail_import("cannot read %s: %s", path.c_str(), std::strerror(errno));
  if (!S_ISREG(info.st_mode)) fail_import("%s is a folder, a pipe or a device; put a regular file there", path.c_str());
  note_file(files, path);
  if (static_cast<std::uint64_t>(info.st_size) > byte_count_max)
    fail_import("%s has %lld bytes, more than the limit of %llu; use a smaller model", path.c_str(),
                static_cast<long long>(info.st_size), static_cast<unsigned long long>(byte_count_max));
  Bytes bytes(static_cast<std::size_t>(info.st_size));
  std::size_t got = bytes.empty() ? 0 : std::fread(bytes.data(), 1, bytes.size(), file.get());
  if (got != bytes.size()) fail_import("cannot read all of %s", path.c_str());
  return bytes;
}

namespace {

std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (end > begin) parts.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// Resolves "." and ".."; returns false if that leads above the first part.
bool resolve(const std::vector<std::string>& parts, std::vector<std::string>* resolved) {
  for (const std::string& part : parts) {
    if (part == "..") {
      if (resolved->empty()) return false;
      resolved->pop_back();
    } else if (part != ".") {
      resolved->push_back(part);
    }
  }
  return true;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string path;
  for (const std::string& part : parts) path += (path.empty() ? "" : "/") + part;
  return path;
}

std::string real_path(const std::string& path) {
  std::unique_ptr<char, void (*)(void*)> real(realpath(path.empty() ? "." : path.c_str(), nullptr), std::free);
  return real ? real.get() : "";
}

// Returns the path of a name that ".." leads above the scene file's folder, if it stays below `root`; otherwise empty.
std::string path_below(const std::string& root, const std::string& folder, const std::vector<std::string>& parts) {
  const std::string real_root = real_path(root), real_folder = real_path(folder);
  if (real_root.empty() || real_folder.empty()) return "";
  std::vector<std::string> resolved = parts_of(real_folder);
  const std::vector<std::string> above = parts_of(real_root);
  if (!resolve(parts, &resolved) || resolved.size() <= above.size() ||
      !std::equal(above.begin(), above.end(), resolved.begin()))
    return "";
  return "/" + joined(resolved);
}

}  // namespace

std::string path_beside(const std::string& scene_path, const std::string& name, const std::string& root) {
  std::string relative = name;
  std::replace(relative.begin(), relative.end(), '\\', '/');
  const bool is_plain = !relative.empty() && relative[0] != '/' && relative.back() != '/' &&
                        relative.find(':') == std::string::npos && relative.find('\0') == std::string::npos;
  const std::string folder = scene_path.substr(0, scene_path.rfind('/') + 1);
  std::vector<std::string> resolved;
  if (is_plain && relative.find("..") == std::string::npos) return folder + relative;
  if (is_plain && resolve(parts_of(relative), &resolved) && !resolved.empty()) return folder + joined(resolved);
  const std::string path = is_plain ? path_below(root.empty() ? folder : root, folder, parts_of(relative)) : "";
  if (path.empty())
    fail_import("the file names '%.200s'; put that file beside the scene and name it without a path%s", name.c_str(),
                is_plain ? ", or name the folder of both by --model-root" : "");
  return path;
}

// Finds the entry of `folder` by name, else ignoring case, the first in byte order. Empty if there is none.
static std::string entry_in_any_case(const std::string& folder, const std::string& name) {
  std::unique_ptr<DIR, int (*)(DIR*)> directory(opendir(folder.empty() ? "." : folder.c_str()), closedir);
  std::string found;
  while (const dirent* entry = directory ? readdir(directory.get()) : nullptr) {
    if (name == entry->d_name) return name;
    bool same = strcasecmp(entry->d_name, name.c_str()) == 0;
    if (same && (found.empty() || found > entry->d_name)) found = entry->d_name;
  }
  return found;
}

std::string find_beside(const std::string& scene_path, const std::string& name, const std::string& root) {
  std::string path = path_beside(scene_path, name, root);
  std::string folder = scene_path.substr(0, scene_path.rfind('/') + 1);
  if (access(path.c_str(), F_OK) == 0 || path.compare(0, folder.size(), folder) != 0) return path;
  std::string relative = path.substr(folder.size());
  for (std::size_t begin = 0; begin < relative.size();) {
    std::size_t end = std::min(relative.find('/', begin), relative.size());
    std::string entry = entry_in_any_case(folder, relative.substr(begin, end - begin));
    if (entry.empty()) return path;
    folder += entry + (end < relative.size() ? "/" : "");
    begin = end + 1;
  }
  return folder;
}

Bytes read_beside(const std::string& scene_path, const std::string& name, std::uint64_t byte_count_max,
                  FilesRead* files) {
  return read_file(find_beside(scene_path, name, files->root), byte_count_max, files);
}

static int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  char lower = static_cast<char>(c | 0x20);
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

static std::string percent_decoded(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0) {
      result += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

static Bytes base64_decoded(const char* text, std::size_t size) {
  Bytes result;
  result.reserve(size / 4 * 3 + 3);
  std::uint32_t bits = 0, bit_count = 0;
  for (std::size_t i = 0; i < size && text[i] != '='; ++i) {
    static const char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char* digit = text[i] ? std::strchr(kDigits, text[i]) : nullptr;
    if (!digit) fail_import("a data URI is not valid base64; export the file again");
    bits = bits << 6 | static_cast<std::uint32_t>(digit - kDigits);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      result.push_back(static_cast<std::uint8_t>(bits >> bit_count));
    }
  }
  return result;
}

Bytes read_uri(const std::string& scene_path, const std::string& uri, std::uint64_t byte_count_max, FilesRead* files) {
  if (uri.compare(0, 5, "data:") != 0) return read_beside(scene_path, percent_decoded(uri), byte_count_max, files);
  std::size_t comma = uri.find(',');
  if (comma == std::string::npos || comma < 7 || uri.compare(comma - 7, 7, ";base64") != 0)
    fail_import("a data URI is not base64; export the file again");
  return base64_decoded(uri.data() + comma + 1, uri.size() - comma - 1);
}

std::string path_ending(const std::string& path) {
  std::size_t dot = path.rfind('.'), slash = path.rfind('/');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return "";
  std::string ending = path.substr(dot + 1);
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

std::string path_stem(const std::string& path) {
  std::size_t slash = path.rfind('/');
  std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  std::size_t dot = name.rfind('.');
  return dot == std::string::npos || dot == 0 ? name : name.substr(0, dot);
}

}  // namespace pocketray
