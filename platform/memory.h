// Memory. Standard types only.
#pragma once
#include <cstddef>

namespace platform {

// Asks the system to use large pages for a block, if it has any: rays read from all over it, and each small page costs
// the CPU a translation. Only a hint; it never changes the content.
void wish_large_pages(void* block, std::size_t byte_count);

// Bytes that the system can still give to this program without killing another; 0: unknown.
std::size_t free_memory();

}  // namespace platform
