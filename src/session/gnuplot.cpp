#include "session/gnuplot.h"

#include "platform/process.h"

namespace pocketray {

bool run_gnuplot(const std::string& folder, const std::vector<std::string>& scripts) {
  char path[1024];
  if (!platform::find_program("gnuplot", path, sizeof path)) return false;
  std::vector<const char*> words = {"gnuplot"};
  for (const std::string& script : scripts) words.push_back(script.c_str());
  words.push_back(nullptr);
  platform::Process process;
  platform::FileError error;
  return platform::start_program(path, words.data(), folder.c_str(), &process, &error) && platform::wait_for(&process);
}

}  // namespace pocketray
