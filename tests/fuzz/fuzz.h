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

// The text of a front's file, then, behind a zero, that of a file of prices.
void fuzz_front(const std::uint8_t* bytes, std::size_t byte_count);

// First byte: what the rest is: an option's text, the state of a sweep, a dump of callgrind.
void fuzz_text(const std::uint8_t* bytes, std::size_t byte_count);

// First byte: what the device is and does. Then, for each message of a server that keeps to the protocol, what becomes
// of it: client_fuzz.cpp has the list.
void fuzz_client(const std::uint8_t* bytes, std::size_t byte_count);

// First byte: the line, and whether the clients greet. Then what two clients do, one act after the other: see
// server_fuzz.cpp.
void fuzz_server(const std::uint8_t* bytes, std::size_t byte_count);

struct FuzzSeed {
  std::string name;
  std::vector<std::uint8_t> bytes;
};
// What fuzzing starts from: an input of every kind.
std::vector<FuzzSeed> message_seeds();
std::vector<FuzzSeed> pray_seeds();
std::vector<FuzzSeed> import_seeds();
std::vector<FuzzSeed> front_seeds();
std::vector<FuzzSeed> text_seeds();
std::vector<FuzzSeed> client_seeds();
std::vector<FuzzSeed> server_seeds();

// How far the inputs since the start came, for tests that show that seeds get somewhere.
struct FuzzCounts {
  std::uint64_t messages = 0, chunks = 0, pictures = 0, scenes = 0, imports = 0, frames = 0, fronts = 0, texts = 0,
                states = 0;
  std::uint64_t server_rows = 0, answers = 0;
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
