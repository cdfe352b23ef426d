// What commands write: one way to write a file, and what is asked before the work whose result goes there.
#pragma once
#include <string>
#include <vector>

#include "base/status.h"
#include "present/image_file.h"

namespace pocketray {

// A file as the command line names it; an empty path: it does not.
struct NamedFile {
  const char* option;
  std::string path;
};

// Whether a path ends in the suffix, ".pray", and its last component has something before it. Allocates nothing.
bool has_suffix(const char* path, const char* suffix);

// Fails where an output cannot be written, is an input, through whatever links, or another output. To be called before
// the work. Inputs may be names of other things than files. Leaves no trace.
Status check_outputs(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs);

// Makes a folder for results within one that is there, unless it is there, and fails where no file can be made in it.
Status make_output_folder(const std::string& folder);

// Replaces a file as a whole or not at all (platform/file.h); "-" is standard output. The encoder writes to the sink it
// is given; what it says is passed on, and then an older file stays.
template <class Encode>
Status write_encoded(const char* path, Encode&& encode);
Status write_file(const std::string& path, const std::string& bytes);

// Brings what was printed to where it goes. When standard output did not take it, says so on standard error and makes
// an exit status that claims success one that does not.
int finish_printing(int exit_status);

// Fails where an argument is empty: no option takes an empty text, though many a shell variable does.
Status check_arguments(int argument_count, const char* const* arguments);

// What write_encoded() consists of.
Status write_with(const char* path, Status (*encode)(void* context, const ByteSink& sink), void* context);

template <class Encode>
Status write_encoded(const char* path, Encode&& encode) {
  auto call = [](void* context, const ByteSink& sink) { return (*static_cast<Encode*>(context))(sink); };
  return write_with(path, call, &encode);
}

}  // namespace pocketray
