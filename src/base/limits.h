// Every capacity of the renderer. Exceeding one is refused when a scene is read or a frame is planned, never later.
#pragma once
#include <cstdint>

namespace pocketray {

// Size of the memory block: from the smallest handheld's to 64 GiB or half of a 32-bit address space.
constexpr std::uint64_t kMemoryBytesMin = 1u << 16;
constexpr std::uint64_t kMemoryBytesMax = sizeof(void*) == 4 ? 0x7FFFFFFFu : std::uint64_t(1) << 36;
constexpr std::uint32_t kImageSideMax = 8192;          // pixels; spans keep their columns in 16 bits
constexpr std::uint32_t kTriangleCountMax = 1u << 26;  // leaves room for tag bits in 32-bit child references
// Bits for a vertex index in a triangle's words; the bits above hold a part of its material index.
constexpr std::uint32_t kVertexIndexBits = 26;
constexpr std::uint32_t kVertexCountMax = 1u << kVertexIndexBits;
constexpr std::uint32_t kMaterialCountMax = 1u << 16;
constexpr std::uint32_t kTextureCountMax = 4096;
constexpr std::uint32_t kTextureSideMax = 16384;
constexpr std::uint32_t kRadiositySideMax = 256;     // nodes along a side of a grid
constexpr std::uint32_t kEnvironmentSideMax = 1024;  // texels; the bilinear filter counts in int
constexpr float kSunRadiusMax = 0.1f;                // radians
constexpr float kEnvironmentScaleMin = 0x1p-40f, kEnvironmentScaleMax = 0x1p40f;
constexpr std::uint32_t kLightCountMax = 4096;       // lights of a scene
constexpr std::uint32_t kPointLightCountMax = 4096;  // after area lights have become points
constexpr std::uint32_t kPointsPerAreaLightMax = 256;
constexpr std::uint32_t kLightCornerMax = 8;  // of flat lamps in closed form
// With fewer lights, all are tested for shadows. Chosen: among few lights, hardly any are weak enough to skip.
constexpr std::uint32_t kSelectedLightsMin = 16;
constexpr std::uint32_t kVirtualLightMax = 512;        // of instant radiosity
constexpr std::uint32_t kEnvironmentLightMax = 256;    // for the 4 × 4 pixels of a pattern
constexpr std::uint32_t kEnvironmentLightRoom = 1024;  // of all patterns
constexpr std::uint32_t kCameraCountMax = 256;
constexpr std::uint32_t kNodeCountMax = 1u << 16;
constexpr std::uint32_t kChannelKeyCountMax = 1u << 22;  // over all animation channels together
constexpr std::uint32_t kMorphTargetCountMax = 1024;     // of one mesh
constexpr std::uint32_t kBrdfCountMax = 16;
constexpr float kPhongExponentMax = 1e6f;  // HARDCASES row 31
constexpr float kNormalScaleMax = 1000;    // steeper normals are horizontal within rounding
constexpr float kIorMax = 100;
constexpr float kFilmThicknessMax = 1e6f;           // nanometres
constexpr std::uint32_t kSampleCountMax = 16;       // per pixel
constexpr float kCutOffLevelsMax = 64;              // a quarter of the display's range
constexpr std::uint32_t kRayDepthMax = 16;          // reflections and refractions along one path
constexpr std::uint32_t kMediumDepthMax = 8;        // nested transparent bodies
constexpr std::uint32_t kTransparentLayerMax = 64;  // alpha or glass surfaces that one ray passes in a straight line
constexpr std::uint32_t kThreadCountMax = 64;
constexpr std::uint32_t kCoherenceTableSideMax = 1024;  // blocks of pixels along each side, a bit of each voxel's table
constexpr std::uint32_t kBvhDepthMax = 64;              // bounds the traversal stack
constexpr float kCoordinateMax = 1e18f;                 // its square is finite; HARDCASES row 8
// Largest radiance, intensity and absorption in a scene, and largest irradiance close to a light. Everything that a
// frame computes from them stays finite: no ∞ · 0 arises.
constexpr float kRadianceMax = 1e18f;
constexpr float kFrameRateMax = 1e6f;  // frames per second

static_assert(kImageSideMax <= 1u << 16, "span columns are 16 bit");

}  // namespace pocketray
