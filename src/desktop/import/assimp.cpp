#include "desktop/import/assimp.h"

#ifdef POCKETRAY_HAVE_ASSIMP

#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>

#include "desktop/import/assimp_parts.h"
#include "desktop/import/broken_faces.h"
#include "desktop/import/import_error.h"
#include "desktop/import/normals.h"
#include "desktop/import/origin.h"
#include "desktop/import/polygon.h"
#include "desktop/import/upright.h"

namespace pocketray {
namespace {

// Formats that assimp reads well; glTF, OBJ and PLY have their own readers here.
const char* const kEndings[] = {"stl", "fbx", "dae", "3ds",  "off", "x",   "3mf", "lwo",
                                "ac",  "ase", "b3d", "ms3d", "md2", "md3", "smd", "x3d"};

// A file in memory. Some of assimp's readers loop forever at the end of a truncated file; this stops them.
class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(Bytes bytes) : bytes_(std::move(bytes)) {}
  std::size_t Read(void* buffer, std::size_t size, std::size_t count) override {
    std::size_t whole = size ? std::min(count, (bytes_.size() - at_) / size) : 0;
    if (whole == 0 && ++empty_reads_ > kEmptyReadsMax) fail_import("the file ends too early; copy it again");
    if (whole) std::memcpy(buffer, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    if (offset > bytes_.size() - base) return aiReturn_FAILURE;
    at_ = base + offset;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  static constexpr int kEmptyReadsMax = 1000;
  Bytes bytes_;
  std::size_t at_ = 0;
  int empty_reads_ = 0;
};

// Opens only files beside the scene file.
class FilesBeside : public Assimp::DefaultIOSystem {
 public:
  FilesBeside(const std::string& scene_path, std::uint64_t byte_count_max, FilesRead* files)
      : scene_path_(scene_path), byte_count_max_(byte_count_max), files_(files) {}
  bool Exists(const char* path) const override { return allowed(path) && DefaultIOSystem::Exists(path); }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (!Exists(path) || !std::strchr(mode, 'r')) return nullptr;
    return new MemoryStream(read_file(path, byte_count_max_, files_));  // the importer gives it back to Close
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  bool allowed(const std::string& path) const {
    if (path == scene_path_) return true;
    std::size_t slash = scene_path_.rfind('/');
    std::string folder = slash == std::string::npos ? "" : scene_path_.substr(0, slash + 1);
    if (path.compare(0, folder.size(), folder) != 0) return false;
    try {
      path_beside(scene_path_, path.substr(folder.size()));
      return true;
    } catch (const ImportError&) {
      return false;
    }
  }
  std::string scene_path_;
  std::uint64_t byte_count_max_;
  FilesRead* files_;
};

struct AssimpReader {
  const aiScene* scene;
  SceneBuilder* builder;
  std::vector<std::uint32_t> materials;  // assimp index → scene index
  bool own_normals;                      // use the file's normals
  Transform upright;
};

MeshData convert(const AssimpReader& reader, const aiMesh& source) {
  MeshData mesh;
  mesh.name = std::string("mesh '") + source.mName.C_Str() + "'";
  std::size_t count = source.mNumVertices;
  require_bytes(*reader.builder, count, 64, "the geometry");
  require_bytes(*reader.builder, source.mNumFaces, 12, "the geometry");
  if (source.mMaterialIndex >= reader.materials.size())
    fail_import("a mesh uses a material that does not exist; export the file again");
  mesh.material = reader.materials[source.mMaterialIndex];
  const Material& material = reader.builder->out->materials[mesh.material];
  bool textured = material.diffuse_texture.texture != kNone || material.emission_texture.texture != kNone;
  for (std::size_t i = 0; i < count; ++i) {
    const aiVector3D& p = source.mVertices[i];
    mesh.positions.push_back({p.x, p.y, p.z});
    if (source.HasNormals() && reader.own_normals) {
      const aiVector3D& n = source.mNormals[i];
      const Vec3 normal = normalize(Vec3{n.x, n.y, n.z});
      mesh.normals.push_back(is_finite(normal) ? normal : Vec3{0, 0, 0});
    }
    if (textured && source.HasTextureCoords(0)) {
      const aiVector3D& t = source.mTextureCoords[0][i];
      mesh.uvs.push_back(is_coordinate({t.x, t.y, 0}) ? Vec2{t.x, 1 - t.y} : Vec2{0, 0});
    }
    if (source.HasVertexColors(0)) mesh.colors.push_back(assimp_color(source.mColors[0][i]));
  }
  // assimp's own triangulation aborts on faces without corners.
  std::vector<std::uint32_t> corners;
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    require_bytes(*reader.builder, mesh.indices.size() + 3 * static_cast<std::uint64_t>(face.mNumIndices), 4,
                  "the faces");
    corners.assign(face.mIndices, face.mIndices + face.mNumIndices);
    if (std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return v >= count; }))
      fail_import("a face uses a vertex that does not exist; export the file again");
    append_polygon(corners, &mesh, reader.builder);
  }
  return mesh;
}

Transform transform_of(const aiMatrix4x4& m) {
  Transform t;
  for (unsigned row = 0; row < 3; ++row)
    for (unsigned column = 0; column < 4; ++column) t.m[row][column] = m[row][column];
  return t;
}

// Adds the bounds of the meshes below a node.
void measure(const std::vector<MeshData>& meshes, const aiNode& node, const ExactTransform& world,
             ExactExtent* extent) {
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    if (node.mMeshes[i] >= meshes.size()) continue;
    const MeshData& mesh = meshes[node.mMeshes[i]];
    add_points(
        extent, mesh.positions.size(), [&](std::size_t v) { return to_double(mesh.positions[v]); }, world,
        static_cast<double>(mesh.indices.size() / 3));
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    measure(meshes, *node.mChildren[i], world * exact(transform_of(node.mChildren[i]->mTransformation)), extent);
}

// assimp reads only floats: notes meshes whose coordinates are too coarse for their shape.
void note_rounding(const std::vector<MeshData>& meshes, SceneBuilder* builder) {
  ExactExtent extent;
  for (const MeshData& mesh : meshes)
    add_points(
        &extent, mesh.positions.size(), [&](std::size_t v) { return to_double(mesh.positions[v]); }, ExactTransform(),
        static_cast<double>(mesh.indices.size() / 3));
  if (extent.samples.empty() || !is_far(extent.bounds, extent.triangle_count)) return;
  float most = 0;
  for (const Vec3d& p : {extent.bounds.low, extent.bounds.high}) most = std::max(most, max_component(abs(to_float(p))));
  const float step = std::nextafter(most, 2 * most) - most;
  char told[120];
  std::snprintf(told, sizeof told, "its coordinates are floats, rounded by up to %.2g; OBJ and PLY keep more digits",
                static_cast<double>(step) / 2);
  note_remark(builder, told);
}

void append_nodes(AssimpReader* reader, std::vector<MeshData>* meshes) {
  struct Visit {
    const aiNode* node;
    Transform world;
    ExactTransform exactly;
    std::uint32_t parent;  // part
  };
  const aiNode& root = *reader->scene->mRootNode;
  const Transform root_world = reader->upright * transform_of(root.mTransformation);
  ExactExtent extent;
  measure(*meshes, root, exact(root_world), &extent);
  choose_origin(extent, reader->builder);
  note_rounding(*meshes, reader->builder);
  std::vector<Visit> stack = {{&root, root_world, exact(root_world), kNone}};
  while (!stack.empty()) {
    Visit visit = stack.back();
    stack.pop_back();
    const std::uint32_t part = begin_part(reader->builder, visit.node->mName.C_Str(), visit.parent);
    for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
      unsigned mesh = visit.node->mMeshes[i];
      if (mesh >= meshes->size()) fail_import("a node uses a mesh that does not exist; export the file again");
      require_invertible(visit.world, std::string("node '") + visit.node->mName.C_Str() + "'");
      append_mesh(reader->builder, (*meshes)[mesh], visit.world, &visit.exactly);
    }
    for (unsigned i = visit.node->mNumChildren; i-- > 0;) {
      const Transform local = transform_of(visit.node->mChildren[i]->mTransformation);
      stack.push_back({visit.node->mChildren[i], visit.world * local, visit.exactly * exact(local), part});
    }
  }
}

}  // namespace

bool assimp_reads(const std::string& ending) {
  bool listed =
      std::any_of(std::begin(kEndings), std::end(kEndings), [&](const char* known) { return ending == known; });
  return listed && Assimp::Importer().IsExtensionSupported("." + ending);
}

std::string assimp_formats() {
  std::string formats;
  for (const char* ending : kEndings)
    if (assimp_reads(ending)) formats += std::string(" ") + ending;
  return formats;
}

void import_assimp(const std::string& path, const std::string& ending, const Bytes& bytes, SceneBuilder* builder) {
  require_bytes(*builder, bytes.size(), 4, "the file");
  Assimp::Importer importer;
  importer.SetIOHandler(
      new FilesBeside(path, builder->options.byte_count_max, &builder->files));  // the importer owns it
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  bool own_normals = ending != "stl";
  // An STL file has one mesh per solid, which may be empty, and nothing else to validate.
  const bool is_stl = ending == "stl";
  const aiScene* scene = importer.ReadFile(path, is_stl ? 0u : unsigned{aiProcess_ValidateDataStructure});
  if (scene && scene->mRootNode) {
    check_assimp_numbers(*scene, own_normals, builder->options.strict);  // vertices still hold the file's numbers
    scene =
        importer.ApplyPostProcessing(aiProcess_JoinIdenticalVertices | (is_stl ? 0u : unsigned{aiProcess_SortByPType}));
  }
  if (!scene || !scene->mRootNode)
    fail_import("%.300s (as assimp reports); export the file again", importer.GetErrorString());
  if (scene->HasAnimations()) note_unused(builder, "animation (use glTF)");

  bool bare = ending == "stl" || ending == "off";  // no materials; assimp invents a shiny one
  AssimpReader reader = {scene, builder, {}, own_normals, {}};
  if (bare || builder->options.up != UpAxis::of_format)
    reader.upright = upright(builder, ending == "stl" ? UpAxis::z : UpAxis::y, "STL");
  for (unsigned i = 0; i < scene->mNumMaterials; ++i)
    reader.materials.push_back(bare ? add_default_material(builder)
                                    : add_assimp_material(builder, path, *scene, *scene->mMaterials[i]));
  std::vector<MeshData> meshes;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    const aiMesh& source = *scene->mMeshes[i];
    MeshData mesh = convert(reader, source);
    tidy_mesh(&mesh);
    if (mesh.normals.empty()) smooth_normals(&mesh, kCreaseDegrees);
    meshes.push_back(std::move(mesh));
  }
  append_nodes(&reader, &meshes);
  add_assimp_lights_and_cameras(builder, *scene);
}

}  // namespace pocketray

#else

#include "desktop/import/import_error.h"

namespace pocketray {

bool assimp_reads(const std::string&) { return false; }
std::string assimp_formats() { return ""; }
void import_assimp(const std::string&, const std::string&, const Bytes&, SceneBuilder*) {
  fail_import("built without assimp");
}

}  // namespace pocketray

#endif
