// Compressed geometry: EXT_meshopt_compression by meshoptimizer, KHR_draco_mesh_compression by Draco, if the build has
// them. Both become plain buffer views, which the other steps read.
#include <cstring>

#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"
#ifdef POCKETRAY_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif
#ifdef POCKETRAY_HAVE_DRACO
#include <draco/compression/decode.h>
#endif

namespace pocketray {
namespace {

constexpr const char *kMeshopt = "EXT_meshopt_compression", *kDraco = "KHR_draco_mesh_compression";

// Appends a buffer with a view of all of it; returns the view's index.
[[maybe_unused]] int add_view(GltfFile* file, std::vector<unsigned char> bytes, std::size_t stride) {
  tinygltf::BufferView view;
  view.buffer = static_cast<int>(file->model.buffers.size());
  view.byteLength = bytes.size(), view.byteStride = stride;
  tinygltf::Buffer buffer;
  buffer.data = std::move(bytes);
  file->model.buffers.push_back(std::move(buffer));
  file->model.bufferViews.push_back(view);
  return static_cast<int>(file->model.bufferViews.size() - 1);
}

[[maybe_unused]] std::size_t whole(const tinygltf::Value& object, const char* key, double most) {
  const double value = gltf_number(object, key, 0);
  if (!(value >= 0 && value <= most)) fail_import("%s of a compressed view is %g; export the file again", key, value);
  return static_cast<std::size_t>(value);
}

#ifdef POCKETRAY_HAVE_MESHOPT

std::string text(const tinygltf::Value& object, const char* key) {
  return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : "";
}

void filter(const std::string& name, std::size_t count, std::size_t stride, unsigned char* bytes) {
  if (name == "OCTAHEDRAL" && (stride == 4 || stride == 8)) return meshopt_decodeFilterOct(bytes, count, stride);
  if (name == "QUATERNION" && stride == 8) return meshopt_decodeFilterQuat(bytes, count, stride);
  if (name == "EXPONENTIAL" && stride % 4 == 0) return meshopt_decodeFilterExp(bytes, count, stride);
  if (!name.empty() && name != "NONE")
    fail_import("a compressed view has the filter %.40s for elements of %zu bytes; export the file again", name.c_str(),
                stride);
}

// Decompresses a view into its own buffer.
void decompress_view(GltfFile* file, std::size_t index, const tinygltf::Value& extension) {
  const std::size_t count = whole(extension, "count", 1e9), stride = whole(extension, "byteStride", 256),
                    offset = whole(extension, "byteOffset", 1e15), size = whole(extension, "byteLength", 1e15),
                    buffer = whole(extension, "buffer", 1e9);
  if (buffer >= file->model.buffers.size() || offset > file->model.buffers[buffer].data.size() ||
      size > file->model.buffers[buffer].data.size() - offset)
    fail_import("a compressed view reaches beyond its buffer; export the file again");
  const std::string mode = text(extension, "mode");
  const bool has_vertices = mode == "ATTRIBUTES", has_triangles = mode == "TRIANGLES";
  const bool fits = has_vertices ? stride % 4 == 0 && stride > 0 : stride == 2 || stride == 4;
  if (!fits || (has_triangles && count % 3 != 0) || (!has_vertices && !has_triangles && mode != "INDICES"))
    fail_import("a compressed view of mode '%.20s' has elements of %zu bytes; export the file again", mode.c_str(),
                stride);
  // Requires a bit per 256 bytes, which bounds the memory that few bytes can claim.
  if (std::uint64_t(count) * stride / 2048 > size) fail_import("a compressed view is too short; export the file again");
  charge_bytes(file->builder, std::uint64_t(count) * stride, "the compressed geometry");
  std::vector<unsigned char> bytes(count * stride);
  const unsigned char* from = file->model.buffers[buffer].data.data() + offset;
  const int fault = count == 0      ? 0
                    : has_vertices  ? meshopt_decodeVertexBuffer(bytes.data(), count, stride, from, size)
                    : has_triangles ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, from, size)
                                    : meshopt_decodeIndexSequence(bytes.data(), count, stride, from, size);
  if (fault) fail_import("a compressed view cannot be decoded; export the file again");
  if (has_vertices) filter(text(extension, "filter"), count, stride, bytes.data());
  const int made = add_view(file, std::move(bytes), has_vertices ? stride : 0);
  tinygltf::BufferView& view = file->model.bufferViews[index];
  view.buffer = file->model.bufferViews[static_cast<std::size_t>(made)].buffer;
  view.byteOffset = 0, view.byteLength = count * stride, view.byteStride = has_vertices ? stride : 0;
}

#else

void decompress_view(GltfFile*, std::size_t, const tinygltf::Value&) {
  fail_import(
      "its geometry is compressed by %s, which this build does not read; export it without, or build with "
      "libmeshoptimizer",
      kMeshopt);
}

#endif

#ifdef POCKETRAY_HAVE_DRACO

// Makes the accessor refer to these elements.
void fill_accessor(GltfFile* file, int index, std::vector<unsigned char> bytes, std::size_t count, int component_type,
                   int type) {
  if (index < 0 || static_cast<std::size_t>(index) >= file->model.accessors.size())
    fail_import("accessor %d does not exist; export the file again", index);
  charge_bytes(file->builder, bytes.size(), "the compressed geometry");
  const int view = add_view(file, std::move(bytes), 0);
  tinygltf::Accessor& accessor = file->model.accessors[static_cast<std::size_t>(index)];
  accessor.bufferView = view, accessor.byteOffset = 0, accessor.count = count;
  accessor.componentType = component_type, accessor.type = type, accessor.sparse.isSparse = false;
}

// Reads an attribute as floats, or as integers if the accessor has integers.
void fill_attribute(GltfFile* file, const draco::Mesh& mesh, const draco::PointAttribute& attribute, int index) {
  constexpr int kTypes[] = {0, TINYGLTF_TYPE_SCALAR, TINYGLTF_TYPE_VEC2, TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4};
  const int components = attribute.num_components();
  if (components < 1 || components > 4)
    fail_import("a compressed attribute has %d components; export the file again", components);
  if (index < 0 || static_cast<std::size_t>(index) >= file->model.accessors.size())
    fail_import("accessor %d does not exist; export the file again", index);
  const int wanted = file->model.accessors[static_cast<std::size_t>(index)].componentType;
  const bool whole_numbers =
      wanted == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || wanted == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  const bool as_integers = whole_numbers && !file->model.accessors[static_cast<std::size_t>(index)].normalized;
  const std::size_t count = mesh.num_points();
  std::vector<unsigned char> bytes(count * static_cast<std::size_t>(components) * 4);
  for (draco::PointIndex i(0); i < mesh.num_points(); ++i) {
    std::uint32_t integers[4] = {};
    float reals[4] = {};
    const bool ok =
        as_integers
            ? attribute.ConvertValue<std::uint32_t>(attribute.mapped_index(i), attribute.num_components(), integers)
            : attribute.ConvertValue<float>(attribute.mapped_index(i), attribute.num_components(), reals);
    if (!ok) fail_import("a compressed attribute cannot be read; export the file again");
    const std::size_t size = static_cast<std::size_t>(components) * 4;
    std::memcpy(&bytes[i.value() * size], as_integers ? static_cast<const void*>(integers) : reals, size);
  }
  fill_accessor(file, index, std::move(bytes), count,
                as_integers ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT : TINYGLTF_COMPONENT_TYPE_FLOAT, kTypes[components]);
}

void decompress_primitive(GltfFile* file, const tinygltf::Primitive& primitive, const tinygltf::Value& extension) {
  std::size_t size = 0;
  const std::uint8_t* from = gltf_view(*file, static_cast<int>(whole(extension, "bufferView", 1e9)), &size);
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(from), size);
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok())
    fail_import("compressed geometry cannot be decoded (%.60s); export the file again", decoded.status().error_msg());
  const draco::Mesh& mesh = *decoded.value();
  const tinygltf::Value& attributes = extension.Get("attributes");
  if (!attributes.IsObject()) fail_import("compressed geometry names no attributes; export the file again");
  for (const std::string& name : attributes.Keys()) {
    const auto accessor = primitive.attributes.find(name);
    const draco::PointAttribute* attribute =
        mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(whole(attributes, name.c_str(), 1e9)));
    if (accessor != primitive.attributes.end() && attribute) fill_attribute(file, mesh, *attribute, accessor->second);
  }
  std::vector<unsigned char> indices(std::size_t(mesh.num_faces()) * 12);
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t index = mesh.face(f)[c].value();
      std::memcpy(&indices[(std::size_t(f.value()) * 3 + static_cast<std::size_t>(c)) * 4], &index, 4);
    }
  fill_accessor(file, primitive.indices, std::move(indices), std::size_t(mesh.num_faces()) * 3,
                TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR);
}

#else

void decompress_primitive(GltfFile*, const tinygltf::Primitive&, const tinygltf::Value&) {
  fail_import(
      "its geometry is compressed by %s, which this build does not read; export it without, or build with "
      "libdraco",
      kDraco);
}

#endif

}  // namespace

void gltf_decompress(GltfFile* file) {
  for (std::size_t i = 0, count = file->model.bufferViews.size(); i < count; ++i) {
    const tinygltf::Value* extension = gltf_extension(file->model.bufferViews[i].extensions, kMeshopt);
    if (extension) decompress_view(file, i, tinygltf::Value(*extension));
  }
  for (const tinygltf::Mesh& mesh : file->model.meshes)
    for (const tinygltf::Primitive& primitive : mesh.primitives)
      if (const tinygltf::Value* extension = gltf_extension(primitive.extensions, kDraco))
        decompress_primitive(file, primitive, *extension);
}

}  // namespace pocketray
