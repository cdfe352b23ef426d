// Output files of commands: checked before the work, written atomically.
#pragma once
#include <string>
#include <vector>

#include "base/status.h"
#include "present/image_file.h"

namespace pocketray {

// A file named on the command line; empty path: not given.
struct NamedFile {
  const char* option;
  std::string path;
};

// Returns whether a path ends in the suffix, ".pray", after a non-empty name. Allocates nothing.
bool has_suffix(const char* path, const char* suffix);

// Fails if an output cannot be written, or is also an input or another output, even through links. Call it before the
// work. Inputs need not be files. Leaves no trace.
Status check_outputs(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs);

// Checks only that the output, a file that is appended to, is not an input.
Status check_not_input(const std::vector<NamedFile>& inputs, const NamedFile& output);

// Fails if an output is a file that the scene was read from (SceneSource::files), even through links: its textures and
// buffers are known once it is open. Call it then, before the work.
Status check_not_read(const std::vector<std::string>& files, const std::vector<NamedFile>& outputs);
// Likewise for a folder of results: fails if it contains a file of the scene that a result would replace.
Status check_folder_not_read(const std::vector<std::string>& files, const std::string& folder);

// For commands that write data to standard output: from here on, messages go to standard error, and a reader that goes
// away fails the write instead of ending the program. Fails if standard output is a terminal.
Status keep_output_for_data();

// Creates a folder for results unless it exists; its parent must exist. Fails if no file can be created in it.
Status make_output_folder(const std::string& folder);

// Replaces a file atomically (platform/file.h); "-" is standard output. The encoder writes to the given sink; if it
// fails, its error is returned and an older file remains.
template <class Encode>
Status write_encoded(const char* path, Encode&& encode);
Status write_file(const std::string& path, const std::string& bytes);

// Flushes standard output. If that fails, reports it on stderr and turns a successful exit status into a failure.
int finish_printing(int exit_status);

// Fails on an empty argument: no option takes one, but an unset shell variable produces one.
Status check_arguments(int argument_count, const char* const* arguments);

// Implements write_encoded().
Status write_with(const char* path, Status (*encode)(void* context, const ByteSink& sink), void* context);

template <class Encode>
Status write_encoded(const char* path, Encode&& encode) {
  auto call = [](void* context, const ByteSink& sink) { return (*static_cast<Encode*>(context))(sink); };
  return write_with(path, call, &encode);
}

}  // namespace pocketray
