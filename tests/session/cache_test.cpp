// Where results are kept between runs, and names made fit for a terminal.
#include "session/cache.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "session/note.h"

using namespace pocketray;

// Goal: nothing is kept in a pipe, which would be waited for; folders are made. Method: a pipe in a new folder.
TEST_CASE("cache_keeps_nothing_in_pipes") {
  char folder[] = "/tmp/pocketray_XXXXXX";
  REQUIRE(mkdtemp(folder) != nullptr);
  const std::string within = std::string(folder) + "/pocketray", path = within + "/a.front";
  CHECK(make_cache(path, "--front").ok);
  REQUIRE(mkfifo(path.c_str(), 0600) == 0);
  Status status = make_cache(path, "--front");
  REQUIRE_FALSE(status.ok);
  CHECK(std::string(status.message).find("remove it") != std::string::npos);
  unlink(path.c_str());
  rmdir(within.c_str());
  rmdir(folder);
}

// Goal: what is shown has no control characters, and else stays. Method: both kinds, and letters of two bytes.
TEST_CASE("shown_names_do_not_command_the_terminal") {
  CHECK(shown("Säule\x1b[31m.obj") == "Säule?[31m.obj");
  CHECK(shown("e\xc2\x9b"
              "31m") == "e??31m");
  CHECK(shown("") == "");
}
