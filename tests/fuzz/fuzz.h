// Fuzz targets: each takes any bytes and aborts if something is wrong. `make fuzz` runs them under libFuzzer with
// sanitizers; the suite replays the committed corpus and the seeds.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pocketray {

// The first byte selects the kind of the rest. 0: a raw stream of messages. 1: messages without length and checksum
// (type, length of the fields in two bytes, fields), which are added. 2: chunks for a decoder. 3: pictures for an
// encoder.
void fuzz_message(const std::uint8_t* bytes, std::size_t byte_count);

// A .pray file after a first byte; if that is odd, length and checksum are corrected. Accepted files are posed and
// rendered.
void fuzz_pray(const std::uint8_t* bytes, std::size_t byte_count);

// A model after a first byte, which selects its ending from import_endings(). Only with the importers built in.
void fuzz_import(const std::uint8_t* bytes, std::size_t byte_count);
// A glTF document without a first byte; libFuzzer changes its structure.
void fuzz_gltf(const std::uint8_t* bytes, std::size_t byte_count);
// Imports, bakes, opens and renders a model file with that ending.
void fuzz_model(const std::string& ending, const std::uint8_t* bytes, std::size_t byte_count);
std::vector<std::string> import_endings();

// Renders small frames of an accepted scene at two times.
struct Scene;
void fuzz_render(const Scene& scene);

// The text of a front file, then, after a zero byte, of a price file.
void fuzz_front(const std::uint8_t* bytes, std::size_t byte_count);

// The first byte selects the kind of the rest: an option's text, the state of a sweep, a callgrind dump.
void fuzz_text(const std::uint8_t* bytes, std::size_t byte_count);

// The first byte configures the device; the rest says how each message of a well-behaved server is changed: see
// client_fuzz.cpp.
void fuzz_client(const std::uint8_t* bytes, std::size_t byte_count);

// The first byte configures the line and whether clients greet; the rest lists the actions of two clients: see
// server_fuzz.cpp.
void fuzz_server(const std::uint8_t* bytes, std::size_t byte_count);

struct FuzzSeed {
  std::string name;
  std::vector<std::uint8_t> bytes;
};
// Seeds for fuzzing: an input of every kind.
std::vector<FuzzSeed> message_seeds();
std::vector<FuzzSeed> pray_seeds();
std::vector<FuzzSeed> import_seeds();
std::vector<FuzzSeed> gltf_seeds();
std::vector<FuzzSeed> front_seeds();
std::vector<FuzzSeed> text_seeds();
std::vector<FuzzSeed> client_seeds();
std::vector<FuzzSeed> server_seeds();

// Progress of all inputs so far, for tests that seeds reach the code.
struct FuzzCounts {
  std::uint64_t messages = 0, chunks = 0, pictures = 0, scenes = 0, imports = 0, frames = 0, fronts = 0, texts = 0,
                states = 0;
  std::uint64_t server_rows = 0, answers = 0, coarse = 0, lit = 0, by_effect = 0, changes = 0;
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
