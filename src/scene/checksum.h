// Checksum of a .pray file: detects accidental damage, in few instructions per byte on any CPU. Not a secure hash.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/parallel_loop.h"

namespace pocketray {

// A file consists of blocks of this many bytes from its start, and a rest. Each has a sum of its own, so that blocks
// can be summed up in any order, by any thread, and while a file is read.
constexpr std::size_t kChecksumBlockBytes = 1u << 16;

// Sum of one block. Eight lanes take every eighth word, h = (word + rotate(h)) · odd, as a lane of xxHash32 [Collet
// 2012] without its first multiplication. Each step is a bijection of h and of the word, so damage to a single word
// always changes the sum, and other damage goes unnoticed once in 2^32. The last 32 bytes are completed with zeros:
// whoever compares sums has to know the length. `bytes` is aligned to 4.
std::uint32_t block_sum(const std::uint8_t* bytes, std::size_t byte_count);

// Appends the sum of the next block to those before it; 0 stands for none.
std::uint32_t join_sums(std::uint32_t before, std::uint32_t sum);

// The joined sums of the blocks of bytes[begin .. byte_count); `begin` lies in the first block.
std::uint32_t joined_sum(const std::uint8_t* bytes, std::size_t begin, std::size_t byte_count,
                         const ParallelLoop& loop = {});

}  // namespace pocketray
