#include "scene/baked.h"

#include <zlib.h>

#include <cstring>

#include "base/check.h"
#include "scene/baked_layout.h"
#include "scene/checksum.h"

namespace pocketray {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "files are used as they lie: a big-endian CPU would have to swap");

// The file holds these structs as in memory. None may have padding: their sizes are the sums of their members' on every
// ABI, and writing them is copying them.
static_assert(sizeof(SceneInfo) == 64 + 6 * 4 + 6 * 4, "no padding");
static_assert(sizeof(Vec3) == 12 && sizeof(Vec2) == 8 && sizeof(Rgba16) == 8 && sizeof(Triangle) == 12, "no padding");
static_assert(sizeof(Texture) == 4 + 2 * 2 + 4 + 4, "no padding");
static_assert(sizeof(TextureUse) == 28 && sizeof(Material) == 8 * 12 + 6 * 4 + 2 * 28 + 4 + 4, "no padding");
static_assert(sizeof(MetallicRoughness) == 28 && sizeof(MaterialMaps) == 28 + 5 * 28 + 8 * 4, "no padding");
static_assert(sizeof(Grain) == 8 + 28 && sizeof(Sheen) == 12 + 2 * 4 + 2 * 28 && sizeof(PackedTangent) == 4,
              "no padding");
static_assert(sizeof(GlassMap) == 2 * 4 + 2 * 28 && sizeof(Iridescence) == 4 * 4 + 2 * 28, "no padding");
static_assert(sizeof(DiffuseTransmission) == 4 + 12 + 2 * 28, "no padding");
static_assert(sizeof(Light) == 4 + 3 * 12 + 3 * 4 + 4 && sizeof(Camera) == 3 * 12 + 4 * 4, "no padding");
static_assert(sizeof(Node) == 4 + 12 + 16 + 12 + 8 && sizeof(Animation) == 12, "no padding");
static_assert(sizeof(Channel) == 4 * 4 + 2 + 2 && sizeof(Joint) == 4 + 48 && sizeof(Skin) == 8, "no padding");
static_assert(sizeof(SkinWeight) == 8 + 16 && sizeof(MovingMesh) == 8 * 4 + 48, "no padding");
static_assert(sizeof(RadiosityInfo) == 12 && sizeof(RadiosityGrid) == 3 * 12 + 3 * 4, "no padding");
static_assert(sizeof(AnimationLabel) == 64 + 188 + 4 && sizeof(SceneOrigin) == 3 * 8 && sizeof(Reduction) == 8,
              "no padding");
static_assert(sizeof(DefaultView) == 2 * 4 + 12 + 4 && sizeof(Framing) == 3 * 12 + 64 * 4, "no padding");
static_assert(sizeof(EnvironmentInfo) == 3 * 4 + 10 * 12, "no padding");
static_assert(sizeof(RadiosityNode) == 4 * 12 && sizeof(RadiosityCorners) == 12 && sizeof(RadiositySplit) == 8 &&
                  sizeof(RadiosityCut) == 2 * 12 + 2 * 4,
              "no padding");

// Calls visit(name, array) for every array of the scene. A section's kind and its place in the file are given by its
// position here: append new arrays at the end and raise kBakedVersion.
template <class SceneType, class Visit>
void for_each_array(SceneType& scene, Visit visit) {
  visit("positions", scene.positions);
  visit("normals", scene.normals);
  visit("uvs", scene.uvs);
  visit("colors", scene.colors);
  visit("triangles", scene.triangles);
  visit("materials", scene.materials);
  visit("textures", scene.textures);
  visit("texels", scene.texels);
  visit("lights", scene.lights);
  visit("cameras", scene.cameras);
  visit("nodes", scene.nodes);
  visit("animations", scene.animations);
  visit("channels", scene.channels);
  visit("key_times", scene.key_times);
  visit("key_values", scene.key_values);
  visit("weights", scene.weights);
  visit("skins", scene.skins);
  visit("joints", scene.joints);
  visit("moving_meshes", scene.moving_meshes);
  visit("rest_positions", scene.rest_positions);
  visit("rest_normals", scene.rest_normals);
  visit("skin_weights", scene.skin_weights);
  visit("morph_positions", scene.morph_positions);
  visit("morph_normals", scene.morph_normals);
  visit("accel", scene.accel);
  visit("radiosity_info", scene.radiosity_info);
  visit("radiosity_triangles", scene.radiosity_triangles);
  visit("radiosity_grids", scene.radiosity_grids);
  visit("radiosity_nodes", scene.radiosity_nodes);
  visit("radiosity_corners", scene.radiosity_corners);
  visit("radiosity_values", scene.radiosity_values);
  visit("material_maps", scene.material_maps);
  visit("environment_info", scene.environment_info);
  visit("environment_texels", scene.environment_texels);
  visit("grains", scene.grains);
  visit("tangents", scene.tangents);
  visit("second_uvs", scene.second_uvs);
  visit("clear_coats", scene.clear_coats);
  visit("radiosity_splits", scene.radiosity_splits);
  visit("default_view", scene.default_view);
  visit("animation_labels", scene.animation_labels);
  visit("node_visible", scene.node_visible);
  visit("origin", scene.origin);
  visit("radiosity_cuts", scene.radiosity_cuts);
  visit("reductions", scene.reductions);
  visit("sheens", scene.sheens);
  visit("framings", scene.framings);
  visit("glass_maps", scene.glass_maps);
  visit("iridescences", scene.iridescences);
  visit("camera_near", scene.camera_near);
  visit("environment_suns", scene.environment_suns);
  visit("diffuse_transmissions", scene.diffuse_transmissions);
}
// zlib counts in uInt, which may be narrower than size_t.
std::uint32_t crc(std::uint32_t start, const void* bytes, std::size_t byte_count) {
  CHECK(bytes != nullptr || byte_count == 0);
  constexpr std::size_t step_max = std::size_t(1) << 30;
  const Bytef* at = static_cast<const Bytef*>(bytes);
  uLong value = start;
  while (byte_count) {
    std::size_t step = byte_count < step_max ? byte_count : step_max;
    value = crc32(value, at, static_cast<uInt>(step));
    at += step, byte_count -= step;
  }
  return static_cast<std::uint32_t>(value);
}

// The counts alone determine where every section lies: sections come in order of kind, each at the next multiple of 64.
// Any other table is refused, which rules out overlaps, gaps, duplicates and unknown kinds at once.
Status check_section(const Section& section, std::uint32_t kind, const char* name, std::uint32_t element_bytes,
                     std::uint64_t byte_count, std::uint64_t* next_offset) {
  CHECK_GT(element_bytes, 0u);
  CHECK_EQ(*next_offset % kSectionAlignment, 0u);
  if (section.kind != kind) return failure("section %u is of kind %u, not %s: bake it again", kind, section.kind, name);
  if (section.element_bytes != element_bytes || section.reserved != 0)
    return failure("%s has elements of %u bytes, not %u: bake it again", name, section.element_bytes, element_bytes);
  if (section.offset != *next_offset)
    return failure("%s lies at byte %llu, not %llu: bake it again", name,
                   static_cast<unsigned long long>(section.offset), static_cast<unsigned long long>(*next_offset));
  std::uint64_t section_bytes = std::uint64_t(section.count) * element_bytes;  // below 2^32 · 152
  if (section.offset > byte_count || section_bytes > byte_count - section.offset)
    return failure("%s reaches beyond the end of the file: bake it again", name);
  *next_offset = aligned(section.offset + section_bytes);
  return success();
}

Status check_header(const std::uint8_t* bytes, std::size_t byte_count, const ParallelLoop& loop, FileHeader* header) {
  if (reinterpret_cast<std::uintptr_t>(bytes) % kSectionAlignment != 0)
    return failure("must be aligned to 64 bytes in memory");
  if (byte_count < sizeof kMagic || std::memcmp(bytes, kMagic, sizeof kMagic) != 0)
    return failure("not a .pray file: make one with pocketray bake");
  if (byte_count < sizeof(FileHeader)) return failure("cut short after %zu bytes: copy or bake it again", byte_count);
  std::memcpy(header, bytes, sizeof *header);
  if (header->version < kBakedVersionMin || header->version > kBakedVersion)
    return failure("made by version %u, but this program reads versions %u to %u: bake it again", header->version,
                   kBakedVersionMin, kBakedVersion);
  if (header->byte_count != byte_count)
    return failure("%zu bytes long, it should be %llu: copy or bake it again", byte_count,
                   static_cast<unsigned long long>(header->byte_count));
  if (baked_checksum(header->version, bytes, byte_count, loop) != header->checksum)
    return failure("damaged, its checksum does not match: copy or bake it again");
  const std::uint32_t section_count = section_count_of(header->version);
  if (header->section_count != section_count)
    return failure("%u sections, not %u: bake it again", header->section_count, section_count);
  for (std::uint32_t word : header->reserved)
    if (word != 0) return failure("reserved bytes of the header are in use: bake it again");
  if (byte_count < first_offset(section_count)) return failure("too short for its table of sections: bake it again");
  return success();
}

Section section_at(const std::uint8_t* bytes, std::uint32_t kind) {
  CHECK_LT(kind, kSectionCount);
  Section section;
  std::memcpy(&section, bytes + sizeof(FileHeader) + kind * sizeof(Section), sizeof section);
  return section;
}

}  // namespace

std::uint32_t baked_checksum(std::uint32_t version, const std::uint8_t* bytes, std::size_t byte_count,
                             const ParallelLoop& loop) {
  CHECK_LE(kChecksumBegin, byte_count);
  return version < kJoinedSumVersion ? crc(0, bytes + kChecksumBegin, byte_count - kChecksumBegin)
                                     : joined_sum(bytes, kChecksumBegin, byte_count, loop);
}

std::size_t baked_size(const Scene& scene) {
  std::uint64_t size = aligned(first_offset(kSectionCount) + sizeof(SceneInfo));
  for_each_array(scene, [&](const char*, const auto& array) { size = aligned(size + array.bytes()); });
  CHECK_LE(size, SIZE_MAX);
  return static_cast<std::size_t>(size);
}

void baked_write(const Scene& scene, std::uint8_t* bytes) {
  CHECK(bytes != nullptr);
  std::size_t size = baked_size(scene);
  std::memset(bytes, 0, size);
  std::uint64_t offset = first_offset(kSectionCount);
  std::uint32_t kind = 0;
  auto write = [&](const void* data, std::uint32_t element_bytes, std::uint32_t count) {
    CHECK_LT(kind, kSectionCount);
    CHECK(data != nullptr || count == 0);
    Section section = {kind, element_bytes, offset, count, 0};
    std::memcpy(bytes + sizeof(FileHeader) + kind * sizeof(Section), &section, sizeof section);
    std::size_t section_bytes = std::size_t(element_bytes) * count;
    CHECK_LE(section_bytes, size - offset);
    if (section_bytes) std::memcpy(bytes + offset, data, section_bytes);
    offset = aligned(offset + section_bytes);
    ++kind;
  };
  write(&scene.info, sizeof scene.info, 1);
  for_each_array(scene, [&](const char*, const auto& array) { write(array.data, sizeof array[0], array.count); });
  CHECK_EQ(kind, kSectionCount);
  CHECK_EQ(offset, size);
  FileHeader header = {};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kBakedVersion;
  header.byte_count = size;
  header.section_count = kSectionCount;
  std::memcpy(bytes, &header, sizeof header);
  header.checksum = baked_checksum(header.version, bytes, size);
  std::memcpy(bytes, &header, sizeof header);
}

Status baked_open(const std::uint8_t* bytes, std::size_t byte_count, Scene* scene, const ParallelLoop& loop) {
  CHECK(bytes != nullptr || byte_count == 0);
  CHECK(scene != nullptr);
  FileHeader header;
  RETURN_IF_ERROR(check_header(bytes, byte_count, loop, &header));
  Scene opened;
  std::uint64_t offset = first_offset(header.section_count);
  Section info = section_at(bytes, 0);
  RETURN_IF_ERROR(check_section(info, 0, "info", sizeof(SceneInfo), byte_count, &offset));
  if (info.count != 1) return failure("%u info sections, not 1: bake it again", info.count);
  std::memcpy(&opened.info, bytes + info.offset, sizeof opened.info);
  Status status;
  std::uint32_t kind = 1;
  for_each_array(opened, [&](const char* name, auto& array) {
    if (!status.ok || kind >= header.section_count) return;
    Section section = section_at(bytes, kind);
    status = check_section(section, kind, name, sizeof array[0], byte_count, &offset);
    if (!status.ok) return;
    array.data = reinterpret_cast<decltype(array.data)>(bytes + section.offset);
    array.count = section.count;
    ++kind;
  });
  if (!status.ok) return status;
  CHECK_EQ(kind, header.section_count);
  if (offset != byte_count) return failure("bytes after the last section: bake it again");
  status = validate_scene(opened);
  if (!status.ok) return failure("%.400s; bake it again", status.message);
  *scene = opened;
  return success();
}

std::uint32_t scene_hash(const Scene& scene) {
  std::uint32_t kind = 0, hash = crc(0, &scene.info, sizeof scene.info);
  for_each_array(scene, [&](const char*, const auto& array) {
    const std::uint32_t prefix[2] = {++kind, array.count};
    if (array.empty() && kind >= section_count_of(kBakedVersionMin)) return;  // scenes without it keep their hash
    hash ^= crc(crc(0, prefix, sizeof prefix), array.data, array.bytes());
  });
  CHECK_EQ(kind, kArrayCount);
  return hash;
}

}  // namespace pocketray
