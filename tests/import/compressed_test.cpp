// Geometry compressed by meshoptimizer and by Draco.
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "base/rng.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"
#ifdef POCKETRAY_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif
#ifdef POCKETRAY_HAVE_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif

using namespace pocketray;

namespace {

// Not every build has both.
[[maybe_unused]] const std::vector<float> kCorners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
[[maybe_unused]] const std::vector<std::uint32_t> kOrder = {0, 1, 2, 2, 1, 3};

[[maybe_unused]] std::string document(const std::vector<std::uint8_t>& bytes, const std::string& views,
                                      const std::string& primitive, const std::string& accessor) {
  return "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":" + std::to_string(bytes.size()) +
         ",\"uri\":\"data:;base64," + base64(bytes) +
         "\"},{\"byteLength\":72,\"extensions\":{\"EXT_meshopt_compression\":{\"fallback\":true}}}],\"bufferViews\":[" +
         views + "],\"accessors\":[{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"" + accessor +
         "},{\"componentType\":5125,\"count\":6,\"type\":\"SCALAR\"" + (accessor.empty() ? "" : ",\"bufferView\":1") +
         "}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
         "\"indices\":1" +
         primitive + "}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}";
}

// The document, then with bytes of its data changed: a scene or one line.
[[maybe_unused]] void check_compressed(const std::vector<std::uint8_t>& bytes,
                                       const std::function<std::string(const std::vector<std::uint8_t>&)>& text_of,
                                       int rounds) {
  TemporaryFolder folder;
  ImportedScene imported = load(folder.write("a.gltf", text_of(bytes)));
  REQUIRE(imported.scene.triangles.count == 2);
  CHECK(surface_area(imported.scene) == doctest::Approx(1).epsilon(1e-3));
  CHECK(bounds(imported.scene).high.x == doctest::Approx(1).epsilon(1e-3));
  Rng rng = make_rng(3);
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::uint8_t> damaged = bytes;
    for (std::uint32_t i = 1 + next_u32(&rng) % 3; i-- > 0;)
      damaged[next_u32(&rng) % damaged.size()] = static_cast<std::uint8_t>(next_u32(&rng));
    ImportedScene result;
    Status status = import_scene(folder.write("b.gltf", text_of(damaged)), ImportOptions(), &result);
    CHECK(std::string(status.message).find('\n') == std::string::npos);
  }
}

}  // namespace

// Goal: views compressed by EXT_meshopt_compression, in place of a buffer without bytes, are read. Method: two
// triangles encoded by the library; then damaged.
TEST_CASE("gltf_meshopt_views_are_read") {
#ifdef POCKETRAY_HAVE_MESHOPT
  std::vector<std::uint8_t> vertices(meshopt_encodeVertexBufferBound(4, 12)),
      indices(meshopt_encodeIndexBufferBound(6, 4));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), kCorners.data(), 4, 12));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), kOrder.data(), 6));
  std::vector<std::uint8_t> bytes = vertices;
  bytes.insert(bytes.end(), indices.begin(), indices.end());
  auto view = [](std::size_t offset, std::size_t size, std::size_t count, int stride, const char* mode) {
    return "{\"buffer\":1,\"byteLength\":" + std::to_string(count * static_cast<std::size_t>(stride)) +
           ",\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":" + std::to_string(offset) +
           ",\"byteLength\":" + std::to_string(size) + ",\"byteStride\":" + std::to_string(stride) +
           ",\"count\":" + std::to_string(count) + ",\"mode\":\"" + mode + "\"}}}";
  };
  const std::string views =
      view(0, vertices.size(), 4, 12, "ATTRIBUTES") + "," + view(vertices.size(), indices.size(), 6, 4, "TRIANGLES");
  auto text_of = [&](const std::vector<std::uint8_t>& data) { return document(data, views, "", ",\"bufferView\":0"); };
  check_compressed(bytes, text_of, 300);
  TemporaryFolder folder;
  const std::string text = text_of(bytes);
  for (const char* change : {"\"count\":4,\"mode\"", "\"byteStride\":12", "\"byteOffset\":0", "\"byteLength\":72"})
    for (const char* number : {"0", "-1", "3", "13", "1e9", "4294967295"}) {
      std::string changed = text;
      const std::string field = change, key = field.substr(0, field.find(':') + 1);
      const std::size_t at = changed.find(field);
      if (at == std::string::npos) continue;
      changed.replace(at, field.size(), key + number + (field.find("mode") != field.npos ? ",\"mode\"" : ""));
      ImportedScene result;
      Status status = import_scene(folder.write("c.gltf", changed), ImportOptions(), &result);
      CHECK(std::string(status.message).find('\n') == std::string::npos);
    }
#else
  std::printf("skipped: this build has no libmeshoptimizer\n");
#endif
}

// Goal: primitives compressed by KHR_draco_mesh_compression are read, in a process of their own. Method: as above.
TEST_CASE("gltf_draco_primitives_are_read") {
#ifdef POCKETRAY_HAVE_DRACO
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::uint32_t f = 0; f < 2; ++f) {
    const float* corner[3];
    for (std::uint32_t c = 0; c < 3; ++c) corner[c] = &kCorners[3 * kOrder[3 * f + c]];
    builder.SetAttributeValuesForFace(id, draco::FaceIndex(f), corner[0], corner[1], corner[2]);
  }
  std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  REQUIRE(mesh != nullptr);
  draco::EncoderBuffer buffer;
  REQUIRE(draco::Encoder().EncodeMeshToBuffer(*mesh, &buffer).ok());
  const std::vector<std::uint8_t> bytes(buffer.data(), buffer.data() + buffer.size());
  const std::string unique = std::to_string(mesh->attribute(id)->unique_id());
  check_compressed(
      bytes,
      [&](const std::vector<std::uint8_t>& data) {
        return document(
            data, "{\"buffer\":0,\"byteLength\":" + std::to_string(data.size()) + "}",
            ",\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":" + unique +
                "}}}",
            "");
      },
      40);
#else
  std::printf("skipped: this build has no libdraco\n");
#endif
}
