// Contents of a scene that no picture shows: black emission, alpha that hides nothing, maps of one value, white vertex
// colours, normals of flat faces, animations that hold still. Without them, every pixel keeps its bits.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Returns whether all texels of a texture, on all levels, are equal; stores them in R, G, B, A.
bool has_one_value(const Scene& scene, const TextureUse& use, std::uint8_t (&value)[4]);

// Returns whether the material emits: its emission × its texture is not black everywhere.
bool shows_emission(const Scene& scene, std::uint32_t material);
// Returns whether a mask makes holes: its alpha is below the cut-off somewhere.
bool shows_holes(const Scene& scene, std::uint32_t material);
// Returns whether a blended material shows what is behind it: its alpha is below 1 somewhere.
bool shows_background(const Scene& scene, std::uint32_t material);
// Returns whether a clear coat is above 0 anywhere, and whether a sheen, a film or a grain is: their textures may be
// black.
bool shows_coat(const Scene& scene, const ClearCoat& coat);
bool shows_sheen(const Scene& scene, const Sheen& sheen);
bool shows_film(const Scene& scene, const Iridescence& film);
bool shows_diffuse_transmission(const Scene& scene, const DiffuseTransmission& passing);
bool shows_grain(const Scene& scene, const Grain& grain);
// Returns whether a normal texture leans normals anywhere.
bool shows_normal_map(const Scene& scene, const TextureUse& normal, float scale);
// Returns whether an occlusion texture takes light away anywhere.
bool shows_occlusion(const Scene& scene, const MaterialMaps& maps);

// Returns whether a colour at a vertex is not white; their alpha is material's, as above.
bool shows_vertex_colors(const Scene& scene);
// Returns whether light passes the material as if it were not there: neither bent, reflected nor absorbed.
bool passes_unchanged(const Scene& scene, std::uint32_t material);

// Returns whether vertex normals can differ from those of the triangles: not if they are zero, nor along an axis that a
// resting triangle is perpendicular to, where interpolation is exact.
bool shows_vertex_normals(const Scene& scene);

// Returns whether the scene has channels, and each holds its target: every key has the target's value at rest. A
// rotation may differ by its rounding. Nodes without channels are there for callers to move.
bool holds_still(const Scene& scene);

// Bounds of the vertices that triangles use.
Box triangle_bounds(const Scene& scene);
// Returns whether nothing within these bounds is in a light's range: false if the light or a triangle may move.
bool is_out_of_range(const Scene& scene, const Box& bounds, const Light& light);

}  // namespace pocketray
