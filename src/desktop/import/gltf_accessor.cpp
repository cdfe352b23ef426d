// Accessors (sec. 3.6.2): bounds are checked before an element is read or memory is taken.
#include <cmath>
#include <cstring>
#include <limits>

#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

// A run of elements in a buffer view.
struct Elements {
  const std::uint8_t* data = nullptr;  // null: zeros
  std::size_t stride = 0, count = 0;
  int component_type = 0, component_count = 0;
  bool normalized = false;
};

std::size_t component_bytes(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;  // MAT2, MAT3: unused here
  }
}

// Returns elements from `byte_offset` of a view, all of which lie in it.
Elements elements_of_view(const GltfFile& file, int view_index, std::size_t byte_offset, std::size_t count,
                          int component_type, int components, bool strided, const char* what) {
  Elements e;
  e.component_type = component_type, e.component_count = components, e.count = count;
  std::size_t size = component_bytes(component_type) * static_cast<std::size_t>(components), bytes = 0;
  const std::uint8_t* data = gltf_view(file, view_index, &bytes);
  std::size_t own_stride = file.model.bufferViews[static_cast<std::size_t>(view_index)].byteStride;
  e.stride = strided && own_stride ? own_stride : size;
  if (count == 0) return e;  // no bytes, any offset will do
  bool fits = size > 0 && e.stride >= size && byte_offset <= bytes && size <= bytes - byte_offset &&
              count - 1 <= (bytes - byte_offset - size) / e.stride;
  if (!fits)
    fail_import("%s: %zu elements do not fit into buffer view %d; export the file again", what, count, view_index);
  e.data = data + byte_offset;
  return e;
}

const tinygltf::Accessor& accessor_at(const GltfFile& file, int index, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= file.model.accessors.size())
    fail_import("%s: accessor %d does not exist; export the file again", what, index);
  return file.model.accessors[static_cast<std::size_t>(index)];
}

std::string quoted(const std::string& name) { return name.empty() ? "" : " '" + name.substr(0, 60) + "'"; }

std::uint32_t integer_component(const std::uint8_t* p, int type) {
  std::uint16_t u16;
  std::uint32_t u32;
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return *p;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      std::memcpy(&u16, p, 2);
      return u16;
    default:
      std::memcpy(&u32, p, 4);
      return u32;
  }
}

// Sec. 3.6.2.2 and the table of sec. 3.11 for normalised integers.
float float_component(const std::uint8_t* p, int type, bool normalized) {
  std::int16_t i16;
  float f;
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      std::memcpy(&f, p, 4);
      return f;
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      f = static_cast<float>(static_cast<std::int8_t>(*p));
      return normalized ? std::fmax(f / 127.0f, -1.0f) : f;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      std::memcpy(&i16, p, 2);
      return normalized ? std::fmax(static_cast<float>(i16) / 32767.0f, -1.0f) : static_cast<float>(i16);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      f = static_cast<float>(*p);
      return normalized ? f / 255.0f : f;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      f = static_cast<float>(integer_component(p, type));
      return normalized ? f / 65535.0f : f;
    default:
      return static_cast<float>(integer_component(p, type));
  }
}

// Calls put(element, component, bytes of the component) for the dense, then for the sparse elements (sec. 3.6.2.3).
template <class Put>
void for_each_component(const GltfFile& file, const tinygltf::Accessor& accessor, const Elements& dense,
                        const char* what, Put put) {
  std::size_t size = component_bytes(dense.component_type);
  auto put_element = [&](std::size_t element, const std::uint8_t* data) {
    for (int c = 0; c < dense.component_count; ++c) put(element, c, data + static_cast<std::size_t>(c) * size);
  };
  if (dense.data)
    for (std::size_t i = 0; i < dense.count; ++i) put_element(i, dense.data + i * dense.stride);
  if (!accessor.sparse.isSparse) return;
  if (accessor.sparse.count < 0 || static_cast<std::size_t>(accessor.sparse.count) > dense.count ||
      accessor.sparse.indices.byteOffset < 0 || accessor.sparse.values.byteOffset < 0)
    fail_import("%s: the sparse accessor is not valid; export the file again", what);
  std::size_t count = static_cast<std::size_t>(accessor.sparse.count);
  Elements indices = elements_of_view(file, accessor.sparse.indices.bufferView,
                                      static_cast<std::size_t>(accessor.sparse.indices.byteOffset), count,
                                      accessor.sparse.indices.componentType, 1, false, what);
  Elements values = elements_of_view(file, accessor.sparse.values.bufferView,
                                     static_cast<std::size_t>(accessor.sparse.values.byteOffset), count,
                                     dense.component_type, dense.component_count, false, what);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t element = integer_component(indices.data + i * indices.stride, indices.component_type);
    if (element >= dense.count)
      fail_import("%s: sparse index %zu is out of range; export the file again", what, element);
    put_element(element, values.data + i * values.stride);
  }
}

Elements dense_elements(GltfFile* file, const tinygltf::Accessor& accessor, int components, const char* what) {
  int own = component_count(accessor.type);
  if (own < components || component_bytes(accessor.componentType) == 0)
    fail_import("%s: the accessor has the wrong type; export the file again", what);
  require_bytes(*file->builder, accessor.count, static_cast<std::uint64_t>(components) * 4, what);
  if (accessor.bufferView >= 0)
    return elements_of_view(*file, accessor.bufferView, accessor.byteOffset, accessor.count, accessor.componentType,
                            own, true, what);
  if (accessor.count > gltf_bytes(*file))
    fail_import("%s: %zu zeros, more than the model has bytes; export the file again", what, accessor.count);
  Elements e;
  e.count = accessor.count, e.component_type = accessor.componentType, e.component_count = own;
  return e;
}

std::vector<float> read_floats(GltfFile* file, int index, int components, const char* what, float limit, bool strict) {
  const tinygltf::Accessor& accessor = accessor_at(*file, index, what);
  Elements dense = dense_elements(file, accessor, components, what);
  std::vector<float> values(dense.count * static_cast<std::size_t>(components), 0.0f);
  for_each_component(*file, accessor, dense, what, [&](std::size_t element, int c, const std::uint8_t* p) {
    if (c >= components) return;
    float value = float_component(p, accessor.componentType, accessor.normalized);
    const bool is_sound = std::fabs(value) <= limit;
    if (!is_sound && strict)
      fail_import("%s: element %zu of accessor %d%s is %g, not finite or beyond %g; export the file again", what,
                  element, index, quoted(accessor.name).c_str(), static_cast<double>(value),
                  static_cast<double>(limit));
    values[element * static_cast<std::size_t>(components) + static_cast<std::size_t>(c)] =
        is_sound ? value : std::numeric_limits<float>::quiet_NaN();
  });
  return values;
}

}  // namespace

std::uint64_t gltf_bytes(const GltfFile& file) {
  std::uint64_t bytes = 0;
  for (const tinygltf::Buffer& buffer : file.model.buffers) bytes += buffer.data.size();
  return bytes;
}

int gltf_component_count(const GltfFile& file, int accessor) {
  return component_count(accessor_at(file, accessor, "an attribute").type);
}

std::vector<float> gltf_floats(GltfFile* file, int index, int components, const char* what, float limit) {
  return read_floats(file, index, components, what, limit, true);
}

std::vector<float> gltf_attribute(GltfFile* file, int index, int components, const char* what, float limit) {
  return read_floats(file, index, components, what, limit, file->builder->options.strict);
}

std::vector<std::uint32_t> gltf_uints(GltfFile* file, int index, int components, const char* what) {
  const tinygltf::Accessor& accessor = accessor_at(*file, index, what);
  int type = accessor.componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    fail_import("%s: the accessor does not hold unsigned integers; export the file again", what);
  Elements dense = dense_elements(file, accessor, components, what);
  std::vector<std::uint32_t> values(dense.count * static_cast<std::size_t>(components), 0u);
  for_each_component(*file, accessor, dense, what, [&](std::size_t element, int c, const std::uint8_t* p) {
    if (c < components)
      values[element * static_cast<std::size_t>(components) + static_cast<std::size_t>(c)] = integer_component(p, type);
  });
  return values;
}

std::vector<Vec3> gltf_vec3s(GltfFile* file, int accessor, const char* what, float limit) {
  std::vector<float> values = gltf_attribute(file, accessor, 3, what, limit);
  std::vector<Vec3> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return result;
}

}  // namespace pocketray
