// Fuzz targets: each takes any bytes and aborts where something is wrong. `make fuzz` runs them under libFuzzer with
// sanitizers; the suite replays the committed corpus and the seeds.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pocketray {

// First byte: what the rest is. 0: a stream of messages as it is. 1: messages without length and checksum (type, length
// of the fields in two bytes, fields), which are put in. 2: chunks for a decoder. 3: pictures for an encoder.
void fuzz_message(const std::uint8_t* bytes, std::size_t byte_count);

// A .pray file behind a first byte: odd, its length and checksum are made right. What is accepted is posed and
// rendered.
void fuzz_pray(const std::uint8_t* bytes, std::size_t byte_count);

// A model behind a first byte: which of import_endings() its name has. Where the importers are built in.
void fuzz_import(const std::uint8_t* bytes, std::size_t byte_count);
std::vector<std::string> import_endings();

// Renders small frames of a scene that was accepted, at two times.
struct Scene;
void fuzz_render(const Scene& scene);

struct FuzzSeed {
  std::string name;
  std::vector<std::uint8_t> bytes;
};
// What fuzzing starts from: an input of every kind.
std::vector<FuzzSeed> message_seeds();
std::vector<FuzzSeed> pray_seeds();
std::vector<FuzzSeed> import_seeds();

// How far the inputs since the start came, for tests that show that seeds get somewhere.
struct FuzzCounts {
  std::uint64_t messages = 0, chunks = 0, pictures = 0, scenes = 0, imports = 0, frames = 0;
};
inline FuzzCounts fuzz_counts;

}  // namespace pocketray

// The entry point of libFuzzer, for one of the targets.
#if defined(POCKETRAY_FUZZ)
#define POCKETRAY_FUZZ_TARGET(function)                                                      \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t byte_count);  \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t byte_count) { \
    ::pocketray::function(bytes, byte_count);                                                \
    return 0;                                                                                \
  }
#else
#define POCKETRAY_FUZZ_TARGET(function)
#endif
