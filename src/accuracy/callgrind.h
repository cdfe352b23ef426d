// What callgrind, valgrind's counter of instructions, writes.
#pragma once
#include <cstdint>
#include <string>

namespace pocketray {

// The instructions of a dump that callgrind made before it entered a function (--dump-before): those since the dump
// before it. False: the text is no such dump, or not yet whole.
bool read_callgrind_dump(const std::string& text, std::uint64_t* instructions);

}  // namespace pocketray
