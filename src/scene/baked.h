// The .pray file: one little-endian block that is used in place. A header (magic, version, byte count, checksum of
// the rest), a table of sections (kind, element size, offset, count), then the arrays of Scene, each aligned to 64
// bytes. A file's bytes are hostile until baked_open() has checked them.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/parallel_loop.h"
#include "base/status.h"
#include "scene/scene.h"

namespace pocketray {

constexpr std::uint32_t kBakedVersion = 21;    // as written
constexpr std::uint32_t kBakedVersionMin = 7;  // oldest readable version; it has no environment, grains or tangents

// Size in bytes of the file that baked_write() makes.
std::size_t baked_size(const Scene& scene);
// Writes the scene into `bytes`, baked_size() of them.
void baked_write(const Scene& scene, std::uint8_t* bytes);

// Makes `scene` a view of the file in `bytes` (aligned to 64). Checks magic, version, length and checksum, then every
// count, offset, index and float; after that the scene can be trusted. Allocates nothing, copies nothing.
Status baked_open(const std::uint8_t* bytes, std::size_t byte_count, Scene* scene, const ParallelLoop& loop = {});

// Applies the checks of baked_open() to any scene: indices in range, floats finite and below kCoordinateMax, nodes
// after their parents, key times increasing. The message names the faulty element.
Status validate_scene(const Scene& scene);

// Identity of the content, wherever its arrays lie: the CRC-32s of all arrays, combined independently of order. For
// caches and tests.
std::uint32_t scene_hash(const Scene& scene);

}  // namespace pocketray
