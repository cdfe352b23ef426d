// Memory. Standard types only.
#pragma once
#include <cstddef>

namespace platform {

// Asks for a block of memory to be made of large pages, where the system has some: rays read here and there, and each
// small page costs the CPU a translation. A wish; whether it is granted changes no content.
void wish_large_pages(void* block, std::size_t byte_count);

}  // namespace platform
