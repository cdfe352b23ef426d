// A render server that sends wrong pixels in valid messages: its own kernels trace, and the result is changed before it
// is packed, encoded and sent.
#pragma once
#include <cstdint>
#include <functional>

#include "desktop/split_report/virtual_world.h"

namespace pocketray {

// Whether it lies about a pixel.
using Lie = std::function<bool(std::uint32_t frame, std::uint32_t row, std::uint32_t column)>;

// Makes a server of the world lie, before or after it is started, until forget_lies().
void make_liar(VirtualWorld* world, std::uint32_t server, const Lie& lie);
// Must be called before the world ends.
void forget_lies();
// Number of wrong pixels made.
std::uint64_t lies_told();

}  // namespace pocketray
