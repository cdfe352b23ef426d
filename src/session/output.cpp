#include "session/output.h"

#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "platform/file.h"
#include "platform/standard_streams.h"
#include "scene/builtin/builtin.h"
#include "session/report.h"

namespace pocketray {
namespace {

bool is_given(const NamedFile& file) { return !file.path.empty(); }

// True if both name standard output, where they would mix, or one file, where one would replace the other.
bool is_same(const NamedFile& one, const NamedFile& other) {
  if (one.path == "-" || other.path == "-") return one.path == other.path;
  return platform::is_same_file(one.path.c_str(), other.path.c_str());
}

// False for names of built-in scenes and of servers' scenes.
bool is_file(const NamedFile& input) {
  return is_given(input) && !find_builtin(input.path.c_str()) && platform::file_stamp(input.path.c_str()) != 0;
}

}  // namespace

bool has_suffix(const char* path, const char* suffix) {
  std::size_t length = std::strlen(path), suffix_length = std::strlen(suffix);
  if (length <= suffix_length) return false;
  const char* at = path + length - suffix_length;
  return std::strcmp(at, suffix) == 0 && at[-1] != '/';
}

Status check_not_input(const std::vector<NamedFile>& inputs, const NamedFile& output) {
  for (const NamedFile& input : inputs)
    if (is_given(output) && is_file(input) && is_same(input, output))
      return failure("%s %.200s would overwrite the input %.200s of %s: name another file", output.option,
                     output.path.c_str(), input.path.c_str(), input.option);
  return success();
}

Status check_outputs(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const NamedFile& output = outputs[i];
    if (!is_given(output)) continue;
    RETURN_IF_ERROR(check_not_input(inputs, output));
    for (std::size_t k = 0; k < i; ++k)
      if (is_given(outputs[k]) && is_same(outputs[k], output))
        return failure("%s and %s name the same file, %.300s: name two files", outputs[k].option, output.option,
                       output.path.c_str());
    platform::FileError error;
    if (!platform::can_write(output.path.c_str(), &error)) return failure("%.300s %s", output.path.c_str(), error.text);
  }
  return success();
}

Status check_not_read(const std::vector<std::string>& files, const std::vector<NamedFile>& outputs) {
  for (const NamedFile& output : outputs) {
    if (!is_given(output) || output.path == "-" || platform::file_stamp(output.path.c_str()) == 0) continue;
    for (const std::string& file : files)
      if (platform::is_same_file(file.c_str(), output.path.c_str()))
        return failure("%s %.200s would overwrite %.200s, which the scene is read from: name another file",
                       output.option, output.path.c_str(), file.c_str());
  }
  return success();
}

Status check_folder_not_read(const std::vector<std::string>& files, const std::string& folder) {
  if (folder.empty()) return success();
  for (const std::string& file : files) {
    const std::size_t slash = file.rfind('/');
    const std::string within = folder + "/" + (slash == std::string::npos ? file : file.substr(slash + 1));
    if (has_suffix(file.c_str(), ".png") && platform::is_same_file(file.c_str(), within.c_str()))
      return failure("-o %.200s has %.200s, which the scene is read from: name another folder", folder.c_str(),
                     file.c_str());
  }
  return success();
}

Status keep_output_for_data() {
  platform::survive_closed_pipes();
  platform::FileError error;
  return platform::keep_output_for_data(&error) ? success() : failure("standard output %s", error.text);
}

Status make_output_folder(const std::string& folder) {
  platform::FileError error;
  if (!platform::make_folder(folder.c_str(), &error)) return failure("%.300s %s", folder.c_str(), error.text);
  if (!platform::can_write((folder + "/pocketray.test").c_str(), &error))
    return failure("cannot create files in %.300s: %s", folder.c_str(), error.text);
  return success();
}

Status write_with(const char* path, Status (*encode)(void* context, const ByteSink& sink), void* context) {
  CHECK(path != nullptr && encode != nullptr);
  platform::FileWriter writer;
  platform::FileError error;
  std::fflush(stdout);  // the file may be standard output
  const char* name = path[0] == '-' && path[1] == 0 ? "standard output" : path;
  if (!platform::open_writer(path, &writer, &error)) return failure("%.300s %s", name, error.text);
  auto write = [](void* user, const void* bytes, std::size_t count) {
    platform::write_bytes(static_cast<platform::FileWriter*>(user), bytes, count);
  };
  Status status = encode(context, {write, &writer});
  if (!status.ok) {
    platform::discard_writer(&writer);
    return status;
  }
  if (!platform::close_writer(&writer, &error)) return failure("%.300s %s", name, error.text);
  return success();
}

Status write_file(const std::string& path, const std::string& bytes) {
  return write_encoded(path.c_str(), [&](const ByteSink& sink) {
    sink.write(sink.user, bytes.data(), bytes.size());
    return success();
  });
}

int finish_printing(int exit_status) {
  bool arrived = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (arrived || exit_status != kExitDone) return exit_status;  // an earlier failure has been reported
  // The data has arrived, or the reader has read enough; the rest does not matter.
  if (platform::is_output_for_data() || platform::is_output_closed()) return exit_status;
  return report(failure("could not write all output to standard output: is it full or closed?"));
}

Status check_arguments(int argument_count, const char* const* arguments) {
  for (int i = 1; i < argument_count; ++i) {
    if (arguments[i][0] != 0) continue;
    if (arguments[i - 1][0] == '-')
      return failure("%.100s has an empty value: give it one, or drop the option", arguments[i - 1]);
    return failure("argument %d is empty: drop it", i);
  }
  return success();
}

}  // namespace pocketray
