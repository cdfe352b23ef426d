// glTF whose JSON is valid and whose numbers are not: counts, offsets, strides, indices, references.
#include <vector>

#include "import/import_testing.h"
#include "scene/baked_file.h"
#include "support/effort.h"
#include "support/gltf_documents.h"
#include "support/gltf_mutation.h"

using namespace pocketray;

namespace {

struct Outcomes {
  int read = 0, refused = 0;
};

// The document becomes a scene that can be baked and opened, or is refused in one line.
void import_document(const TemporaryFolder& folder, const GltfJson& document, Outcomes* outcomes) {
  const std::string path = folder.write("a.gltf", document.dump());
  ImportOptions options;
  options.byte_count_max = 16 << 20;
  ImportedScene imported;
  Status status = import_scene(path, options, &imported);
  ++(status.ok ? outcomes->read : outcomes->refused);
  if (!status.ok) {
    CHECK(std::string(status.message).find('\n') == std::string::npos);
    return;
  }
  BakedFile file = bake(imported.scene);
  Scene opened;
  CHECK(baked_open(file.data(), file.size(), &opened).ok);
}

}  // namespace

// Goal: a primitive without vertices or without triangles is left out and said; what is beside it is shown. Method: a
// triangle beside primitives whose positions, indices or both are empty, with every further attribute.
TEST_CASE("gltf_primitives_without_vertices_are_left_out") {
  GltfWriter w;
  const int corners = w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0}), none = w.vec3s({}), no_index = w.indices({});
  const std::string attributes[] = {
      "\"POSITION\":" + std::to_string(none),
      "\"POSITION\":" + std::to_string(none) + ",\"NORMAL\":" + std::to_string(none) +
          ",\"COLOR_0\":" + std::to_string(none) + ",\"TEXCOORD_0\":" + std::to_string(none),
  };
  std::vector<std::string> primitives = {"{\"attributes\":{\"POSITION\":" + std::to_string(corners) +
                                         "},\"indices\":" + std::to_string(no_index) + "}"};
  for (const std::string& list : attributes)
    for (const char* rest : {"", ",\"targets\":[{\"POSITION\":1}]", ",\"indices\":2", ",\"mode\":5", ",\"mode\":6"})
      primitives.push_back("{\"attributes\":{" + list + "}" + rest + "}");
  TemporaryFolder folder;
  for (const std::string& primitive : primitives) {
    CAPTURE(primitive);
    ImportedScene imported =
        load(folder.write("a.gltf", w.gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]},{"
                                           "\"primitives\":[" +
                                           primitive +
                                           "]}],\"nodes\":[{\"mesh\":0},{\"mesh\":1}],"
                                           "\"scenes\":[{\"nodes\":[0,1]}]")));
    CHECK(imported.scene.triangles.count == 1);
    CHECK(contains(imported.warning, "without triangles"));
  }
}

// Goal: no number in a document crashes the importer, hangs it or slips past its checks. Method: each number in turn
// becomes 0, −1, 2³¹, … or is removed.
TEST_CASE("gltf_with_any_number_changed_ends_in_a_scene_or_one_line") {
  TemporaryFolder folder;
  Outcomes outcomes;
  for (const std::string& text : gltf_documents()) {
    const GltfJson document = GltfJson::parse(text);
    import_document(folder, document, &outcomes);
    CHECK(outcomes.refused == 0);
    std::vector<GltfJson::json_pointer> numbers, all;
    list_places(document, GltfJson::json_pointer(), &numbers, &all);
    for (const GltfJson::json_pointer& place : numbers)
      for (std::size_t i = 0; i <= kGltfNumberCount; ++i) {
        CAPTURE(place.to_string());
        CAPTURE(i);
        GltfJson changed = document;
        if (i < kGltfNumberCount)
          set_number(&changed, place, kGltfNumbers[i]);
        else
          remove_place(&changed, place);
        Outcomes one;
        import_document(folder, changed, &one);
        outcomes.read += one.read;
      }
  }
  CHECK(outcomes.read > 500);
}

// Goal: as above, for several changes at once, of structure as well. Method: random changes, seed 7.
TEST_CASE("gltf_with_several_changes_ends_in_a_scene_or_one_line") {
  TemporaryFolder folder;
  Rng rng = make_rng(7);
  Outcomes outcomes;
  for (const std::string& text : gltf_documents())
    for (int round = 0; round < effort(1500); ++round) {
      CAPTURE(round);
      GltfJson changed = GltfJson::parse(text);
      for (std::uint32_t changes = 1 + next_u32(&rng) % 4; changes-- > 0;) mutate_gltf(&changed, &rng);
      import_document(folder, changed, &outcomes);
    }
  std::printf("mutated glTF: %d read, %d refused\n", outcomes.read, outcomes.refused);
  CHECK(outcomes.read > 0);
  CHECK(outcomes.refused > 0);
}
