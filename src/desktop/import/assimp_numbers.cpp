// Checks assimp's data before use: refuses non-finite numbers by name, and faces without corners, for which assimp's
// later steps compute a negative index.
#ifdef POCKETRAY_HAVE_ASSIMP

#include <cmath>
#include <cstring>
#include <limits>

#include "base/limits.h"
#include "desktop/import/assimp_parts.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

constexpr float kFloatMax = std::numeric_limits<float>::max();

void require(const float* values, unsigned count, float limit, const char* kind, const char* name, const char* what) {
  for (unsigned i = 0; i < count; ++i)
    if (!(std::fabs(values[i]) <= limit))
      fail_import("%s '%.60s': %.60s is %g, not finite or beyond %g; fix it or export the file again", kind, name, what,
                  static_cast<double>(values[i]), static_cast<double>(limit));
}
void require(const aiVector3D& v, float limit, const char* kind, const char* name, const char* what) {
  require(&v.x, 3, limit, kind, name, what);
}

void check_mesh(const aiMesh& mesh, bool own_normals, bool strict) {
  auto check = [&](const float* values, unsigned count, unsigned vertex, float limit, const char* what) {
    for (unsigned i = 0; i < count; ++i)
      if (!(std::fabs(values[i]) <= limit))
        fail_import("mesh '%.60s': the %s of vertex %u is not finite or beyond %g; fix it or export the file again",
                    mesh.mName.C_Str(), what, vertex, static_cast<double>(limit));
  };
  for (unsigned v = 0; strict && v < mesh.mNumVertices; ++v) {
    if (mesh.HasPositions()) check(&mesh.mVertices[v].x, 3, v, kCoordinateMax, "position");
    if (mesh.HasNormals() && own_normals) check(&mesh.mNormals[v].x, 3, v, kFloatMax, "normal");
    if (mesh.HasTextureCoords(0)) check(&mesh.mTextureCoords[0][v].x, 2, v, kCoordinateMax, "texture coordinate");
    if (mesh.HasVertexColors(0)) check(&mesh.mColors[0][v].r, 4, v, kFloatMax, "colour");
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f)
    if (mesh.mFaces[f].mNumIndices == 0)
      fail_import("mesh '%.60s': face %u has no corners; remove it or export the file again", mesh.mName.C_Str(), f);
}

void check_material(const aiMaterial& material) {
  aiString name;
  material.Get(AI_MATKEY_NAME, name);
  for (unsigned i = 0; i < material.mNumProperties; ++i) {
    const aiMaterialProperty& property = *material.mProperties[i];
    if (property.mType != aiPTI_Float) continue;
    for (unsigned at = 0; at + sizeof(float) <= property.mDataLength; at += sizeof(float)) {
      float value;
      std::memcpy(&value, property.mData + at, sizeof value);
      require(&value, 1, kFloatMax, "material", name.C_Str(), property.mKey.C_Str());
    }
  }
}

void check_node(const aiNode& node) {
  require(&node.mTransformation.a1, 16, kCoordinateMax, "node", node.mName.C_Str(), "its transform");
  for (unsigned i = 0; i < node.mNumChildren; ++i) check_node(*node.mChildren[i]);
}

void check_light(const aiLight& light) {
  const char* name = light.mName.C_Str();
  require(light.mPosition, kCoordinateMax, "light", name, "its position");
  require(light.mDirection, kFloatMax, "light", name, "its direction");
  require(&light.mColorDiffuse.r, 3, kFloatMax, "light", name, "its colour");
  require(&light.mAngleInnerCone, 1, kFloatMax, "light", name, "its inner cone");
  require(&light.mAngleOuterCone, 1, kFloatMax, "light", name, "its outer cone");
}

void check_camera(const aiCamera& camera) {
  const char* name = camera.mName.C_Str();
  require(camera.mPosition, kCoordinateMax, "camera", name, "its position");
  require(camera.mLookAt, kFloatMax, "camera", name, "its direction");
  require(camera.mUp, kFloatMax, "camera", name, "its upward direction");
  require(&camera.mHorizontalFOV, 1, kFloatMax, "camera", name, "its field of view");
  require(&camera.mAspect, 1, kFloatMax, "camera", name, "its aspect");
}

}  // namespace

void check_assimp_numbers(const aiScene& scene, bool own_normals, bool strict) {
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) check_mesh(*scene.mMeshes[i], own_normals, strict);
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) check_material(*scene.mMaterials[i]);
  for (unsigned i = 0; i < scene.mNumLights; ++i) check_light(*scene.mLights[i]);
  for (unsigned i = 0; i < scene.mNumCameras; ++i) check_camera(*scene.mCameras[i]);
  check_node(*scene.mRootNode);
}

}  // namespace pocketray

#endif
