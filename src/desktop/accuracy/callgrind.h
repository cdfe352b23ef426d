// Reads the output of callgrind, valgrind's instruction counter.
#pragma once
#include <cstdint>
#include <string>

namespace pocketray {

// Reads the number of instructions from a dump that callgrind made before entering a function (--dump-before), counted
// since the previous dump. Returns false if the text is not such a dump or is incomplete.
bool read_callgrind_dump(const std::string& text, std::uint64_t* instructions);

}  // namespace pocketray
