// Every sample scene: what is read is what the file holds.
#include <dirent.h>

#include <chrono>
#include <vector>

#include "import/import_testing.h"

using namespace pocketray;

namespace {

struct Sample {
  const char* file;
  std::uint32_t triangles;
};

// Triangle counts from the samples' own README, instances included.
const Sample kSamples[] = {
    {"mesh/happy_vrip_res3.ply", 67240},
    {"mesh/bunny/bun_zipper.ply", 69451},
    {"mesh/bunny/bun_zipper_res2.ply", 16301},
    {"mesh/bunny/bun_zipper_res4.ply", 948},
    {"mesh/dragon_100k.obj", 100000},
    {"mesh/nefertiti_lowres.obj", 70000},
    {"mesh/BustManWreath.obj", 31514},
    {"mesh/teapot/teapot.obj", 15704},
    {"mesh/cube/cube.obj", 12},
    {"cornell/mcguire/CornellBox-Empty-CO.obj", 12},
    {"cornell/mcguire/CornellBox-Glossy.obj", 1112},
    {"cornell/mcguire/CornellBox-Mirror.obj", 36},
    {"cornell/mcguire/CornellBox-Original.obj", 36},
    {"cornell/mcguire/CornellBox-Sphere.obj", 2188},
    {"cornell/embree/cornell_box.obj", 34},
    {"cornell/glsl-pathtracer/cbox_back.obj", 2},
    {"cornell/glsl-pathtracer/cbox_largebox.obj", 12},
    {"cornell/glsl-pathtracer/glass_sphere.obj", 15872},
    {"cornell/bevy_CornellBox.glb", 36},
    {"gltf/Box.glb", 12},
    {"gltf/BoxTextured.glb", 12},
    {"gltf/BoxAnimated.glb", 254},
    {"gltf/BoxVertexColors.glb", 12},
    {"gltf/AnimatedMorphCube.glb", 12},
    {"gltf/CesiumMilkTruck.glb", 3624},
    {"gltf/Duck.glb", 4212},
    {"gltf/RiggedSimple.glb", 188},
    {"gltf/RiggedFigure.glb", 256},
    {"gltf/CesiumMan.glb", 4672},
    {"gltf/DamagedHelmet.glb", 15452},
    {"gltf/TransmissionTest.glb", 128775},
    {"gltf/AttenuationTest.glb", 292},
    {"gltf/EmissiveStrengthTest.glb", 90},
    {"gltf/TextureSettingsTest.glb", 72},
    {"gltf/Fox.glb", 576},
    {"gltf/NegativeScaleTest.glb", 7724},
    {"gltf/OrientationTest.glb", 524},
    {"gltf/VertexColorTest.glb", 36},
    {"gltf/InterpolationTest.glb", 110},
    {"gltf/MorphPrimitivesTest.glb", 32},
    {"gltf/UnlitTest.glb", 88},
    {"gltf/TextureCoordinateTest.glb", 10},
    {"gltf/NormalTangentTest.glb", 7774},
    {"gltf/SimpleSkin/SimpleSkin.gltf", 8},
    {"gltf/Cameras/Cameras.gltf", 2},
    {"gltf/SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12},
    {"gltf/TriangleWithoutIndices/TriangleWithoutIndices.gltf", 1},
    {"gltf/LightsPunctualLamp/LightsPunctualLamp.gltf", 6000},
    {"gltf/TextureTransformTest/TextureTransformTest.gltf", 24},
    {"gltf/AlphaBlendModeTest.glb", 61},
    {"gltf/Lights.glb", 12},
    {"gltf/geometry-camera-light.glb", 14},
    {"animation/robot.glb", 3238},
    {"animation/alien.glb", 292},
    {"rooms/holodeck/holodeck.obj", 4015},
    {"rooms/vr-gallery.glb", 1930},
    {"rooms/glass-table.glb", 592},
    {"rooms/IrradianceVolumeExample.glb", 32},
};

}  // namespace

// Goal: every triangle of every sample arrives, and what arrives is sound. Method: counts against the samples' README;
// indices, coordinates and array lengths checked one by one.
TEST_CASE("import_samples_have_their_triangles_and_sound_arrays") {
  for (const Sample& sample : kSamples) {
    std::string path = shared_scene(sample.file);
    if (!have(path)) continue;
    CAPTURE(path);
    auto start = std::chrono::steady_clock::now();
    ImportedScene imported = load(path);
    double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const Scene& s = imported.scene;
    if (std::getenv("POCKETRAY_VERBOSE"))
      std::printf("%-55s %8u tri %8u vtx %3u mat %2u tex %2u lights %2u cams %6.1f ms  %s\n", sample.file,
                  s.triangles.count, s.positions.count, s.materials.count, s.textures.count, s.lights.count,
                  s.cameras.count, ms, imported.warning.c_str());
    CHECK(s.triangles.count == sample.triangles);
    std::uint32_t n = s.positions.count;
    CHECK((s.normals.empty() || s.normals.count == n));
    CHECK((s.uvs.empty() || s.uvs.count == n));
    CHECK((s.colors.empty() || s.colors.count == n));
    bool indices_fit = true, finite = true;
    for (const Triangle& t : s.triangles) {
      indices_fit &= t.vertex(0) < n && t.vertex(1) < n && t.vertex(2) < n && t.material() < s.materials.count;
    }
    for (const Vec3& p : s.positions) finite &= is_finite(p);
    for (const Vec3& p : s.normals) finite &= is_finite(p);
    CHECK(indices_fit);
    CHECK(finite);
  }
}
