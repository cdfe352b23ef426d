// The kernel's parts that a frame uses.
#pragma once
#include "effect/settings.h"
#include "scene/scene.h"

namespace pocketray {

struct FrameData;
struct Footprints;
struct Hit;
struct PixelRows;
struct Ray;
struct RayPacket;
struct Rgba;
struct Surface;
struct TileShadows;
struct TileStrip;
struct Tracer;

// Instantiations of the kernel's parts, selected once per frame for the plan. Hit::t is the distance from the eye along
// the whole path.
using SurfaceFunction = void (*)(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* surface);
using GlowFunction = void (*)(const FrameData& frame, Surface* surface);
// Radiance of the surroundings that the material's lobes reflect back along the ray.
using SurroundingsFunction = Vec3 (*)(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s);
// Value of a texture at the surface (colour or numbers), and the material's alpha at a hit; texture.h.
using ColorFunction = Rgba (*)(const FrameData& frame, const TextureUse& use, const Surface& s);
using NumbersFunction = Vec3 (*)(const FrameData& frame, const TextureUse& use, const Surface& s);
using AlphaFunction = float (*)(const Scene& scene, const Material& material, std::uint32_t triangle, float u, float v,
                                TextureFilter filter, const Footprints& footprints);
// Radiance along a ray, given its first hit and, if already known, the surface there (otherwise null).
using RadianceFunction = Vec3 (*)(Tracer* tracer, const Ray& ray, const Hit& hit, const Surface* surface);
// Adds tile lighting to a secondary hit. `weight` is the throughput of the path to the surface.
using LaterLightFunction = void (*)(Tracer* tracer, const Vec3& weight, Surface* surface);
using ShadowsFunction = void (*)(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows);
using StripFunction = void (*)(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

struct Kernels {
  SurfaceFunction surface = nullptr;
  SurfaceFunction plain_surface = nullptr;      // see ambient_gloss.h
  SurroundingsFunction surroundings = nullptr;  // null: there is only the ambient term
  GlowFunction glow = nullptr;                  // see material_maps.h
  ColorFunction color = nullptr;
  NumbersFunction numbers = nullptr;
  AlphaFunction alpha = nullptr;
  RadianceFunction radiance = nullptr;
  LaterLightFunction add_later_light = nullptr;  // null: tiles add no light
  ShadowsFunction find_shadows = nullptr;        // null if nothing casts a shadow
  StripFunction trace_strip = nullptr;           // traces pixels in blocks; null: pixel by pixel
  StripFunction trace_window_strip = nullptr;    // for the pixels of a window, see window.h
};

}  // namespace pocketray
