// The fuzz targets without a fuzzer: run over the committed corpus and the seeds, each intact, truncated and damaged.
#include <dirent.h>
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "base/rng.h"
#include "fuzz/fuzz.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

using Target = void (*)(const std::uint8_t*, std::size_t);
using Bytes = std::vector<std::uint8_t>;

Bytes read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

// Runs the target over the files of a corpus folder; returns their number.
int replay(const char* folder, Target target) {
  std::string path = std::string(POCKETRAY_CORPUS) + "/" + folder + "/";
  DIR* directory = opendir(path.c_str());
  REQUIRE(directory != nullptr);
  int count = 0;
  while (const dirent* entry = readdir(directory)) {
    if (entry->d_name[0] == '.') continue;
    Bytes bytes = read_file(path + entry->d_name);
    target(bytes.data(), bytes.size());
    ++count;
  }
  closedir(directory);
  return count;
}

void damage(const std::vector<FuzzSeed>& seeds, Target target, int rounds) {
  Rng rng = make_rng(1);
  for (const FuzzSeed& seed : seeds) {
    target(seed.bytes.data(), seed.bytes.size());
    for (int round = 0; round < rounds; ++round) {
      Bytes bytes = seed.bytes;
      for (std::uint32_t flips = next_u32(&rng) % 4; flips-- > 0;)
        bytes[1 + next_u32(&rng) % (bytes.size() - 1)] ^= static_cast<std::uint8_t>(1 + next_u32(&rng) % 255);
      if (next_u32(&rng) % 4 == 0) bytes.resize(1 + next_u32(&rng) % (bytes.size() - 1));
      target(bytes.data(), bytes.size());
    }
  }
}

// Checks that the corpus contains the seeds; POCKETRAY_WRITE_CORPUS=1 rewrites them.
void check_committed(const char* folder, const std::vector<FuzzSeed>& seeds) {
  for (const FuzzSeed& seed : seeds) {
    std::string path = std::string(POCKETRAY_CORPUS) + "/" + folder + "/" + seed.name;
    if (std::getenv("POCKETRAY_WRITE_CORPUS")) {
      std::ofstream file(path, std::ios::binary);
      file.write(reinterpret_cast<const char*>(seed.bytes.data()), static_cast<std::streamsize>(seed.bytes.size()));
      REQUIRE(file.good());
    }
    INFO(path);
    CHECK(read_file(path) == seed.bytes);
  }
}

}  // namespace

// Goal: no input of a hostile peer aborts the decoders; the seeds reach all of them.
TEST_CASE("fuzz_message_corpus_and_damaged_seeds") {
  check_committed("message", message_seeds());
  fuzz_counts = FuzzCounts();
  for (const FuzzSeed& seed : message_seeds()) fuzz_message(seed.bytes.data(), seed.bytes.size());
  CHECK(fuzz_counts.messages == 38);
  CHECK(fuzz_counts.chunks == 48);
  CHECK(fuzz_counts.pictures == 18);
  CHECK(fuzz_counts.changes == 6);  // rows to rows, light to both, and back; and a frame_change
  damage(message_seeds(), fuzz_message, effort(400));
  CHECK(replay("message", fuzz_message) >= 10);
}

// Goal: no .pray file makes the program abort; the seeds are opened and rendered, damaged ones at times.
TEST_CASE("fuzz_pray_corpus_and_damaged_seeds") {
  check_committed("pray", pray_seeds());
  fuzz_counts = FuzzCounts();
  for (const FuzzSeed& seed : pray_seeds()) fuzz_pray(seed.bytes.data(), seed.bytes.size());
  CHECK(fuzz_counts.scenes == 2);
  CHECK(fuzz_counts.frames == 4);
  damage(pray_seeds(), fuzz_pray, effort(400));
  CHECK(fuzz_counts.scenes > 2);
  CHECK(replay("pray", fuzz_pray) >= 2);
}

#ifdef POCKETRAY_HAVE_IMPORT
// Goal: no model makes the program abort, hang or allocate without bounds, whatever its format; seeds of several
// formats are read and rendered.
TEST_CASE("fuzz_import_corpus_and_damaged_seeds") {
  check_committed("import", import_seeds());
  fuzz_counts = FuzzCounts();
  for (const FuzzSeed& seed : import_seeds()) fuzz_import(seed.bytes.data(), seed.bytes.size());
  CHECK(fuzz_counts.imports >= (import_seeds().size() > 10 ? 10 : 4));
  CHECK(fuzz_counts.frames == 2 * fuzz_counts.imports);
  damage(import_seeds(), fuzz_import, effort(8));
  CHECK(replay("import", fuzz_import) >= 4);
}

// Goal: no glTF document makes the program abort, hang or allocate without bounds; the seeds are read and rendered.
TEST_CASE("fuzz_gltf_corpus_and_damaged_seeds") {
  check_committed("gltf", gltf_seeds());
  fuzz_counts = FuzzCounts();
  for (const FuzzSeed& seed : gltf_seeds()) fuzz_gltf(seed.bytes.data(), seed.bytes.size());
  CHECK(fuzz_counts.imports == gltf_seeds().size());
  CHECK(fuzz_counts.frames == 2 * fuzz_counts.imports);
  damage(gltf_seeds(), fuzz_gltf, effort(40));
  CHECK(replay("gltf", fuzz_gltf) >= 3);
}
#endif

// Goal: no front or price file makes the program abort, and accepted ones can be used and written again.
TEST_CASE("fuzz_front_corpus_and_damaged_seeds") {
  check_committed("front", front_seeds());
  fuzz_counts = FuzzCounts();
  for (const FuzzSeed& seed : front_seeds()) fuzz_front(seed.bytes.data(), seed.bytes.size());
  CHECK(fuzz_counts.fronts == 4);
  damage(front_seeds(), fuzz_front, effort(400));
  CHECK(replay("front", fuzz_front) >= 4);
}

// Goal: no option text, state file or output of another program makes the program abort.
TEST_CASE("fuzz_text_corpus_and_damaged_seeds") {
  check_committed("text", text_seeds());
  fuzz_counts = FuzzCounts();
  for (const FuzzSeed& seed : text_seeds()) fuzz_text(seed.bytes.data(), seed.bytes.size());
  CHECK(fuzz_counts.texts >= 5);
#if defined(POCKETRAY_HAVE_ACCURACY)
  CHECK(fuzz_counts.texts == 6);
  CHECK(fuzz_counts.states == 1);
#endif
  damage(text_seeds(), fuzz_text, effort(400));
  CHECK(replay("text", fuzz_text) >= 7);
}

// Goal: whatever a server does, a device completes its frames and obeys the protocol. The seeds reach rows, scenes and
// views.
TEST_CASE("fuzz_client_corpus_and_damaged_seeds") {
  check_committed("client", client_seeds());
  fuzz_counts = FuzzCounts();
  for (const FuzzSeed& seed : client_seeds()) fuzz_client(seed.bytes.data(), seed.bytes.size());
  CHECK(fuzz_counts.frames > 30);
  CHECK(fuzz_counts.server_rows > 100);
  CHECK(fuzz_counts.coarse > 5);
  CHECK(fuzz_counts.lit > 1);
  CHECK(fuzz_counts.by_effect > 12);
  CHECK(fuzz_counts.scenes == 1);
  CHECK(fuzz_counts.messages == 1);  // views
  damage(client_seeds(), fuzz_client, effort(20));
  CHECK(replay("client", fuzz_client) >= 14);
}

// Goal: whatever clients do, a server continues and greets the next one. The seeds get answers of every kind.
TEST_CASE("fuzz_server_corpus_and_damaged_seeds") {
  check_committed("server", server_seeds());
  fuzz_counts = FuzzCounts();
  for (const FuzzSeed& seed : server_seeds()) fuzz_server(seed.bytes.data(), seed.bytes.size());
  CHECK(fuzz_counts.answers > 20);
  damage(server_seeds(), fuzz_server, effort(20));
  CHECK(replay("server", fuzz_server) >= 9);
}
