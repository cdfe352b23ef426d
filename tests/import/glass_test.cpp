// Glass without a volume: bodies and thin sheets.
#include <array>

#include "import/gltf_writer.h"
#include "import/import_testing.h"

using namespace pocketray;

namespace {

const char* const kGlass =
    "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0},\"extensions\":{\"KHR_materials_"
    "transmission\":{\"transmissionFactor\":1}}}";
const char* const kMatte = "{}";

// Triangles with vertices of their own, as at seams of normals and texture coordinates.
struct Soup {
  std::vector<float> positions;
  void add(const std::array<float, 3>& a, const std::array<float, 3>& b, const std::array<float, 3>& c) {
    for (const auto& p : {a, b, c}) positions.insert(positions.end(), p.begin(), p.end());
  }
  void add_quad(const std::array<float, 3>& a, const std::array<float, 3>& b, const std::array<float, 3>& c,
                const std::array<float, 3>& d) {
    add(a, b, c), add(a, c, d);
  }
  // A cube of half side r, its front outside, or inside with `inward`; without its top with `is_open`.
  void add_cube(float r, bool inward = false, bool is_open = false, float x = 0) {
    auto at = [&](float i, float j, float k) { return std::array<float, 3>{{x + r * i, r * j, r * k}}; };
    auto side = [&](const std::array<float, 3>& a, const std::array<float, 3>& b, const std::array<float, 3>& c,
                    const std::array<float, 3>& d) { inward ? add_quad(d, c, b, a) : add_quad(a, b, c, d); };
    side(at(-1, -1, 1), at(1, -1, 1), at(1, 1, 1), at(-1, 1, 1));
    side(at(1, -1, -1), at(-1, -1, -1), at(-1, 1, -1), at(1, 1, -1));
    side(at(1, -1, 1), at(1, -1, -1), at(1, 1, -1), at(1, 1, 1));
    side(at(-1, -1, -1), at(-1, -1, 1), at(-1, 1, 1), at(-1, 1, -1));
    side(at(-1, -1, -1), at(1, -1, -1), at(1, -1, 1), at(-1, -1, 1));
    if (!is_open) side(at(-1, 1, 1), at(1, 1, 1), at(1, 1, -1), at(-1, 1, -1));
  }
};

// A node for each mesh; all of material 0, or of material 1 if it is in `matte`.
ImportedScene load_meshes(const std::vector<Soup>& soups, GlassKind kind = GlassKind::automatic,
                          const std::string& glass = kGlass, std::size_t matte = 99, const std::string& rest = "") {
  GltfWriter w;
  std::string meshes, nodes, roots;
  for (std::size_t i = 0; i < soups.size(); ++i) {
    const std::string comma = i ? "," : "", index = std::to_string(w.vec3s(soups[i].positions));
    meshes += comma + "{\"primitives\":[{\"attributes\":{\"POSITION\":" + index +
              "},\"material\":" + (i == matte ? "1" : "0") + "}]}";
    nodes += comma + "{\"mesh\":" + std::to_string(i) + "}", roots += comma + std::to_string(i);
  }
  TemporaryFolder folder;
  ImportOptions options;
  options.glass = kind;
  return load(folder.write("scene.gltf",
                           w.gltf("\"meshes\":[" + meshes + "],\"nodes\":[" + nodes + "],\"scenes\":[{\"nodes\":[" +
                                  roots + "]}],\"scene\":0,\"materials\":[" + glass + "," + kMatte + "]" + rest)),
              options);
}

bool is_thin(const ImportedScene& imported, std::uint32_t triangle) {
  return imported.scene.materials[imported.scene.triangles[triangle].material()].thin != 0;
}

Soup cube(float r = 1, bool inward = false, bool is_open = false) {
  Soup soup;
  soup.add_cube(r, inward, is_open);
  return soup;
}

}  // namespace

// Goal: a closed mesh is a body, an open one a sheet, and a line says so; faces of another direction open a mesh, and a
// sheet with a front and a back encloses nothing. Method: cubes of separate triangles, whole and without a side.
TEST_CASE("glass_is_solid_if_its_mesh_is_closed") {
  ImportedScene imported = load_meshes({cube()});
  CHECK_FALSE(is_thin(imported, 0));
  CHECK(imported.warning == "glass without a volume: 1 closed, taken as solid (--glass thin or solid)");
  CHECK_FALSE(is_thin(load_meshes({cube(1, true)}), 0));
  for (float step : {1e-7f, 1e-2f}) {  // a seam that is rounded differently, and a gap
    Soup rounded = cube();
    for (std::size_t i = 0; i < 18; i += 3) rounded.positions[i] *= 1 + step;
    CHECK(is_thin(load_meshes({rounded}), 0) == (step > 1e-3f));
  }
  imported = load_meshes({cube(1, false, true)});
  CHECK(is_thin(imported, 0));
  CHECK(imported.warning ==
        "glass without a volume: 1 open or around something, taken as thin (--glass thin or solid)");
  Soup plane, sheet, turned = cube();
  plane.add_quad({{-1, 0, 1}}, {{1, 0, 1}}, {{1, 0, -1}}, {{-1, 0, -1}});
  CHECK(is_thin(load_meshes({plane}), 0));
  sheet = plane;
  sheet.add_quad({{-1, 0, -1}}, {{1, 0, -1}}, {{1, 0, 1}}, {{-1, 0, 1}});
  CHECK(is_thin(load_meshes({sheet}), 0));
  for (int c = 0; c < 3; ++c)
    std::swap(turned.positions[static_cast<std::size_t>(c)], turned.positions[static_cast<std::size_t>(3 + c)]);
  CHECK(is_thin(load_meshes({turned}), 0));
}

// Goal: what the file or the option says holds. Method: volumes of a thickness and of none; --glass.
TEST_CASE("glass_is_what_it_is_said_to_be") {
  auto with_volume = [](const char* volume) {
    return "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0},\"extensions\":{\"KHR_materials_"
           "transmission\":{\"transmissionFactor\":1},\"KHR_materials_volume\":{" +
           std::string(volume) + "}}}";
  };
  for (GlassKind kind : {GlassKind::automatic, GlassKind::thin, GlassKind::solid}) {
    const ImportedScene thick = load_meshes({cube(1, false, true)}, kind, with_volume("\"thicknessFactor\":1")),
                        thin = load_meshes({cube()}, kind, with_volume(""));
    CHECK((!is_thin(thick, 0) && is_thin(thin, 0)));
    CHECK((thick.warning.empty() && thin.warning.empty()));
  }
  const ImportedScene sheet = load_meshes({cube()}, GlassKind::thin),
                      body = load_meshes({cube(1, false, true)}, GlassKind::solid);
  CHECK((is_thin(sheet, 0) && !is_thin(body, 0)));
  CHECK((sheet.warning.empty() && body.warning.empty()));
  CHECK(load_meshes({cube()}, GlassKind::automatic, kMatte).warning.empty());
}

// Goal: a material of closed and open meshes is divided, with everything that belongs to it; in one mesh, too. Method:
// a cube and a cube without a side, apart and in one mesh.
TEST_CASE("glass_of_both_kinds_is_divided") {
  const std::string coated =
      "{\"name\":\"pane\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0},\"normalTexture\":{"
      "\"index\":0},\"extensions\":{\"KHR_materials_transmission\":{"
      "\"transmissionFactor\":1},"
      "\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.5},\"KHR_materials_sheen\":{\"sheenColorFactor\":[1,0,0]}}}";
  const std::string texture =
      ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64,"
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==\"}]";
  ImportedScene imported = load_meshes({cube(), cube(2, false, true)}, GlassKind::automatic, coated, 99, texture);
  CHECK(contains(imported.warning, "1 closed, taken as solid; 1 open or around something, taken as thin"));
  CHECK((!is_thin(imported, 0) && !is_thin(imported, 11) && is_thin(imported, 12) && is_thin(imported, 21)));
  const std::uint32_t body = imported.scene.triangles[0].material(), sheet = imported.scene.triangles[12].material();
  CHECK(imported.material_names[body] == "pane");
  CHECK(imported.scene.clear_coats[body].strength == imported.scene.clear_coats[sheet].strength);
  CHECK(imported.scene.sheens[body].color == Vec3{1, 0, 0});
  CHECK(imported.scene.material_maps[body].normal.texture == imported.scene.material_maps[sheet].normal.texture);
  Soup both = cube();
  both.add_cube(1, false, true, 5);
  imported = load_meshes({both});
  CHECK((!is_thin(imported, 11) && is_thin(imported, 12)));
}

// Goal: a bottle of two shells is solid, whatever stands in it; one shell around a lamp or an object is a bulb. Method:
// cubes in cubes; a point light.
TEST_CASE("glass_around_something_is_a_bulb") {
  Soup bottle = cube(2);
  bottle.add_cube(1.5f, true);
  ImportedScene imported = load_meshes({bottle});
  CHECK((!is_thin(imported, 0) && !is_thin(imported, 23)));
  imported = load_meshes({bottle, cube(1)}, GlassKind::automatic, kGlass, 1);
  CHECK((!is_thin(imported, 0) && !is_thin(imported, 23)));
  imported = load_meshes({cube(2), cube(1)}, GlassKind::automatic, kGlass, 1);
  CHECK(is_thin(imported, 0));
  CHECK_FALSE(is_thin(load_meshes({cube(2), cube(1)}), 0));  // a body in a body
  Soup beside;
  beside.add_cube(1, false, false, 9);
  CHECK_FALSE(is_thin(load_meshes({cube(2), beside}, GlassKind::automatic, kGlass, 1), 0));
  Soup pierced = cube(1);
  pierced.positions[1] = -5;
  CHECK_FALSE(is_thin(load_meshes({cube(2), pierced}, GlassKind::automatic, kGlass, 1), 0));
  for (const char* place : {"0.3,0.2,0.1", "0,0,0", "5,0,0"}) {
    const std::string light =
        ",\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":"
        "\"point\"}]}}";
    GltfWriter w;
    w.vec3s(cube().positions);
    TemporaryFolder folder;
    const ImportedScene lamp = load(folder.write(
        "lamp.gltf",
        w.gltf(
            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}],\"nodes\":[{\"mesh\":0},"
            "{\"translation\":[" +
            std::string(place) +
            "],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],\"scenes\":[{\"nodes\":[0,1]}],\"scene\":0,"
            "\"materials\":[" +
            kGlass + "]" + light)));
    CAPTURE(place);
    REQUIRE(lamp.scene.lights.count == 1);
    CHECK(is_thin(lamp, 0) == (place[0] == '0'));
  }
}
