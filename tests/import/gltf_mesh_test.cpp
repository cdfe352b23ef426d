// Meshes, accessors, nodes and instances of glTF files written here.
#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

ImportedScene load_text(const std::string& text) {
  TemporaryFolder folder;
  return load(folder.write("scene.gltf", text));
}
std::string error_of(const std::string& text) {
  TemporaryFolder folder;
  return load_error(folder.write("scene.gltf", text));
}

Vec3 face_normal(const Scene& s, std::uint32_t triangle) {
  const Triangle& t = s.triangles[triangle];
  Vec3 a = s.positions[t.vertex(0)], b = s.positions[t.vertex(1)], c = s.positions[t.vertex(2)];
  return normalize(cross(b - a, c - a));
}

std::string mesh_document(const std::string& primitives, const std::string& nodes = "{\"mesh\":0}") {
  return "\"meshes\":[{\"primitives\":[" + primitives + "]}],\"nodes\":[" + nodes + "],\"scenes\":[{\"nodes\":[0]}]";
}

}  // namespace

// Goal: named nodes have the bounds of their meshes and of all below them, in the world; a node without a name has its
// mesh's. Method: a triangle under a moved parent and beside it; an empty node.
TEST_CASE("gltf_parts_have_names_and_bounds") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const ImportedScene s =
      load_text(w.gltf("\"meshes\":[{\"name\":\"leaf\",\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                       "\"nodes\":[{\"name\":\"tree\",\"translation\":[10,0,0],\"children\":[1,2,3]},"
                       "{\"name\":\"branch\",\"mesh\":0},{\"mesh\":0,\"translation\":[0,5,0]},{\"name\":\"nothing\"}],"
                       "\"scenes\":[{\"nodes\":[0]}]"));
  REQUIRE(s.parts.size() == 3);
  CHECK(s.parts[0].first == "tree");
  CHECK(s.parts[0].second.low == Vec3{10, 0, 0});
  CHECK(s.parts[0].second.high == Vec3{11, 6, 0});
  CHECK(s.parts[1].first == "branch");
  CHECK(s.parts[1].second.high == Vec3{11, 1, 0});
  CHECK(s.parts[2].first == "leaf");
  CHECK(s.parts[2].second.low == Vec3{10, 5, 0});
}

// Goal: strips and fans become the same triangles, all facing one way; modes without triangles are reported. Method: a
// flat quad of four vertices in every mode.
TEST_CASE("gltf_primitive_modes_make_triangles_that_face_alike") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  w.indices({0, 1, 3, 2});
  w.indices({0, 1, 2, 2, 1, 3});
  std::string strip = "{\"attributes\":{\"POSITION\":0},\"mode\":5}";
  std::string fan = "{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":6}";
  std::string list = "{\"attributes\":{\"POSITION\":0},\"indices\":2,\"mode\":4}";
  std::string points = "{\"attributes\":{\"POSITION\":0},\"mode\":0}",
              lines = "{\"attributes\":{\"POSITION\":0},\"mode\":1}";
  ImportedScene imported =
      load_text(w.gltf(mesh_document(strip + "," + fan + "," + list + "," + points + "," + lines)));
  REQUIRE(imported.scene.triangles.count == 6);
  for (std::uint32_t t = 0; t < 6; ++t) CHECK(face_normal(imported.scene, t) == Vec3{0, 0, 1});
  CHECK(surface_area(imported.scene) == doctest::Approx(3));
  CHECK(imported.scene.normals.empty());  // without NORMAL: flat (sec. 3.7.2.1)
  CHECK(imported.warning == "not used: points, lines");
}

// Goal: a sparse accessor without a buffer view is zero except for its own values.
TEST_CASE("gltf_sparse_accessor_replaces_elements") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.add<std::uint8_t>({1, 2}, "SCALAR", 1, 5121);
  w.vec3s({2, 0, 0, 0, 3, 0});
  w.accessors +=
      ",{\"count\":3,\"type\":\"VEC3\",\"componentType\":5126,\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":1,"
      "\"componentType\":5121},\"values\":{\"bufferView\":2}}}";
  ImportedScene imported = load_text(w.gltf(mesh_document("{\"attributes\":{\"POSITION\":3}}")));
  REQUIRE(imported.scene.positions.count == 3);
  CHECK(imported.scene.positions[0] == Vec3{0, 0, 0});
  CHECK(imported.scene.positions[1] == Vec3{2, 0, 0});
  CHECK(imported.scene.positions[2] == Vec3{0, 3, 0});
}

// Goal: no memory is taken for elements that a few bytes announce. Method: accessors without a buffer view, sparse or
// not, as positions, as a morph target and as instances; the largest count that a buffer of the same bytes allows.
TEST_CASE("gltf_elements_without_bytes_are_refused_before_memory_is_taken") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.add<std::uint8_t>({1, 2}, "SCALAR", 1, 5121);
  w.vec3s({2, 0, 0, 0, 3, 0});
  auto with = [&](std::size_t count, const std::string& sparse, const std::string& primitive,
                  const std::string& translation) {
    GltfWriter made = w;
    made.accessors +=
        ",{\"count\":" + std::to_string(count) + ",\"type\":\"VEC3\",\"componentType\":5126" + sparse + "}";
    return made.gltf("\"meshes\":[{\"primitives\":[" + primitive + "]}],\"nodes\":[{\"mesh\":0" + translation +
                     "}],\"scenes\":[{\"nodes\":[0]}]");
  };
  const std::string few =
                        ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":1,\"componentType\":5121},\"values\":{"
                        "\"bufferView\":2}}",
                    instances = ",\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":3}}}",
                    plain = "{\"attributes\":{\"POSITION\":0}}", zeros = "{\"attributes\":{\"POSITION\":3}}",
                    morph = "{\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":3}]}";
  TemporaryFolder folder;
  for (const std::string& sparse : {std::string(), few})
    for (const auto& use : {std::make_pair(zeros, std::string()), std::make_pair(morph, std::string()),
                            std::make_pair(plain, instances)}) {
      CAPTURE(use.first);
      const std::string path = folder.write("a.gltf", with(60'000'000, sparse, use.first, use.second));
      CHECK(contains(load_error(path), "60000000 zeros, more than the model has bytes; export the file again"));
    }
  CHECK(load(folder.write("a.gltf", with(64, few, zeros, ""))).scene.triangles.count == 21);
}

// Goal: vertex colours of every component type and width arrive linear, with 16 bits per channel. Method: the colour
// (1, 0.5, 0, …) in each.
TEST_CASE("gltf_vertex_colors_of_all_types_become_linear_16_bit") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.add<std::uint8_t>({255, 128, 0, 51, 255, 128, 0, 51, 255, 128, 0, 51}, "VEC4", 4, 5121, ",\"normalized\":true");
  w.add<std::uint16_t>({65535, 32768, 0, 65535, 32768, 0, 65535, 32768, 0}, "VEC3", 3, 5123, ",\"normalized\":true");
  w.vec3s({1, 0.5f, 0, 1, 0.5f, 0, 1, 0.5f, 0});
  std::string primitives;
  for (int c = 1; c <= 3; ++c)
    primitives +=
        (c > 1 ? "," : "") + std::string("{\"attributes\":{\"POSITION\":0,\"COLOR_0\":") + std::to_string(c) + "}}";
  ImportedScene imported = load_text(w.gltf(mesh_document(primitives)));
  REQUIRE(imported.scene.colors.count == 9);
  for (const Rgba16& c : imported.scene.colors) {
    CHECK(c.r == 65535);
    CHECK(std::abs(c.g - 32896) <= 128);  // 128/255 in 8 bits, 0.5 in the others
    CHECK(c.b == 0);
  }
  CHECK(imported.scene.colors[0].a == 13107);  // 51/255
  CHECK(imported.scene.colors[3].a == 65535);
}

// Goal: a mirrored instance keeps its outside outside. Method: a triangle with normals under scale (−2, 3, 1) and
// shear; winding and normals must agree, and the normal stay perpendicular to the surface.
TEST_CASE("hard_26_mirrored_and_sheared_nodes_keep_normals_perpendicular_and_outward") {
  count_assertions("perpendicular, outward");
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 1, 0, 1, 1});
  Vec3 n = normalize(cross(Vec3{1, 0, 1}, Vec3{0, 1, 1}));
  w.vec3s({n.x, n.y, n.z, n.x, n.y, n.z, n.x, n.y, n.z});
  std::string primitive = "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}}";
  for (const char* node :
       {"\"scale\":[-2,3,1]", "\"scale\":[2,3,-0.5]", "\"matrix\":[1,0,0,0,0.7,2,0,0,0,0.3,1,0,5,6,7,1]",
        "\"matrix\":[-1,0,0,0,0.7,2,0,0,0,0.3,1,0,5,6,7,1]"}) {
    CAPTURE(node);
    ImportedScene imported = load_text(w.gltf(mesh_document(primitive, std::string("{\"mesh\":0,") + node + "}")));
    const Scene& s = imported.scene;
    Vec3 face = face_normal(s, 0);
    for (std::uint32_t v = 0; v < 3; ++v) CHECK(dot(face, s.normals[v]) == doctest::Approx(1).epsilon(1e-6));
  }
}

// Goal: transforms that cannot be inverted are refused, and the error names the node; those of scale 0 hide instead
// (gltf_hidden_test.cpp). Method: determinants 1e-38, Inf.
TEST_CASE("hard_27_singular_transforms_are_refused_naming_the_node") {
  count_assertions("refused by name");
  for (const char* scale : {"[1e-13,1e-13,1e-12]", "[1e15,1e15,1e15]", "[1e400,1,1]", "[1e39,1,1]"}) {
    CAPTURE(scale);
    std::string error = error_of(triangle_gltf("", "", std::string(",\"name\":\"squashed\",\"scale\":") + scale));
    bool named = contains(error, "node 0 'squashed'") || contains(error, "/nodes/0/scale/0 ('squashed')");
    CHECK_MESSAGE(named, error);
  }
}

// Goal: denormal coordinates are accepted, indices out of range refused (HARDCASES row 8; non_finite_test.cpp has the
// rest).
TEST_CASE("hard_08_denormal_vertices_are_taken_and_indices_out_of_range_refused") {
  count_assertions("left out and counted");
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0, 1e-40f, 0, 0});
  w.indices({0, 1, 2, 3, 1, 2});
  ImportedScene imported = load_text(w.gltf(mesh_document("{\"attributes\":{\"POSITION\":0},\"indices\":1}")));
  CHECK(imported.scene.triangles.count == 2);
  CHECK(bounds(imported.scene).low.x == 0);

  GltfWriter beyond;
  beyond.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  beyond.indices({0, 1, 7});
  CHECK(contains(error_of(beyond.gltf(mesh_document("{\"attributes\":{\"POSITION\":0},\"indices\":1}"))), "index 7"));
}

// Goal: instances that exceed a limit are refused before any is built. Method: five thousand of ten triangles for a
// megabyte.
TEST_CASE("gltf_instances_are_counted_before_they_are_built") {
  GltfWriter w;
  std::vector<float> corners;
  for (int i = 0; i < 90; ++i) corners.push_back(static_cast<float>(i * i % 7));
  w.vec3s(corners);
  w.vec3s(std::vector<float>(15000));
  TemporaryFolder folder;
  ImportOptions options;
  options.byte_count_max = 1 << 20;
  const std::string error =
      load_error(folder.write("a.glb", w.glb(mesh_document("{\"attributes\":{\"POSITION\":0}}",
                                                           "{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{"
                                                           "\"attributes\":{\"TRANSLATION\":1}}}}"))),
                 options);
  CHECK_MESSAGE(contains(error, "the geometry would take the scene beyond 1 MiB"), error);
}

// Goal: EXT_mesh_gpu_instancing places the mesh once for each instance, under the node's own transform.
TEST_CASE("gltf_instances_are_placed_under_their_node") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.vec3s({0, 0, 0, 10, 0, 0, 0, 0, 5});
  w.vec3s({1, 1, 1, 2, 2, 2, 1, 1, -1});
  std::string node =
      "{\"mesh\":0,\"translation\":[100,0,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{"
      "\"TRANSLATION\":1,"
      "\"SCALE\":2}}}}";
  ImportedScene imported = load_text(w.gltf(mesh_document("{\"attributes\":{\"POSITION\":0}}", node)));
  const Scene& s = imported.scene;
  REQUIRE(s.triangles.count == 3);
  CHECK(s.positions[s.triangles[1].vertex(0)] == Vec3{110, 0, 0});
  CHECK(bounds(s).high.x == 112);
  CHECK(s.positions[s.triangles[2].vertex(0)] == Vec3{100, 0, 5});
  CHECK(surface_area(s) == doctest::Approx(0.5 + 2 + 0.5));
}

// Goal: only the default scene is read, and the others are named. Method: two scenes of one triangle each, the second
// the default one.
TEST_CASE("gltf_default_scene_alone_is_read") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  std::string document = w.gltf(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0},{\"mesh\":0,"
      "\"translation\":[5,0,0]}],\"scenes\":[{\"nodes\":[0]},{\"nodes\":[1]}],\"scene\":1");
  ImportedScene imported = load_text(document);
  CHECK(imported.scene.triangles.count == 1);
  CHECK(imported.scene.positions[0].x == 5);
  CHECK(imported.warning == "not used: 1 other scene");
}

// Goal: a .glb is read like the .gltf it wraps.
TEST_CASE("gltf_binary_container_reads_like_json") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  TemporaryFolder folder;
  std::string document = mesh_document("{\"attributes\":{\"POSITION\":0}}");
  ImportedScene text = load(folder.write("a.gltf", w.gltf(document))),
                binary = load(folder.write("b.glb", w.glb(document)));
  CHECK(binary.scene.triangles.count == 1);
  for (std::uint32_t v = 0; v < 3; ++v) CHECK(binary.scene.positions[v] == text.scene.positions[v]);
}

// Goal: special cases of the samples. Method: MultipleScenes shows one; SimpleInstancing's 125 cubes;
// NegativeScaleTest's triangles all agree with their normals.
TEST_CASE("gltf_samples_scenes_instances_and_negative_scales") {
  std::string multiple = shared_scene("gltf/MultipleScenes/MultipleScenes.gltf");
  if (have(multiple)) {
    ImportedScene imported = load(multiple);
    CHECK(imported.scene.triangles.count == 2);  // scene 0, a square; scene 1 would be a triangle
    CHECK(contains(imported.warning, "1 other scene"));
  }
  std::string instancing = shared_scene("gltf/SimpleInstancing.glb");
  if (have(instancing)) CHECK(load(instancing).scene.triangles.count == 125 * 12);
  std::string modes = shared_scene("gltf/MeshPrimitiveModes/MeshPrimitiveModes.gltf");
  if (have(modes)) {
    ImportedScene imported = load(modes);
    CHECK(imported.scene.triangles.count == 16);
    CHECK(contains(imported.warning, "points, lines"));
  }
  std::string negative = shared_scene("gltf/NegativeScaleTest.glb");
  if (have(negative)) {
    ImportedScene imported = load(negative);
    const Scene& s = imported.scene;
    std::uint32_t against = 0;
    for (std::uint32_t t = 0; t < s.triangles.count; ++t)
      against += dot(face_normal(s, t), s.normals[s.triangles[t].vertex(0)]) < 0;
    CHECK(against == 0);
  }
}
