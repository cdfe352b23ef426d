#ifdef POCKETRAY_HAVE_ASSIMP

#include "desktop/import/assimp_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/color.h"
#include "base/fmath.h"
#include "base/limit_list.h"
#include "desktop/import/broken_faces.h"
#include "desktop/import/files.h"
#include "desktop/import/image.h"
#include "desktop/import/import_error.h"
#include "desktop/import/origin.h"

namespace pocketray {
namespace {

float bounded(float value, float low, float high) { return value > low ? std::min(value, high) : low; }
Vec3 bounded3(const aiColor3D& c, float high) {
  return {bounded(c.r, 0, high), bounded(c.g, 0, high), bounded(c.b, 0, high)};
}

std::uint16_t linear_16(float srgb) {
  return static_cast<std::uint16_t>(srgb_decode(static_cast<double>(bounded(srgb, 0, 1))) * 65535.0 + 0.5);
}

// The image of a texture: embedded (compressed, or plain BGRA texels) or a file beside the scene.
Image load(SceneBuilder* builder, const std::string& scene_path, const aiScene& scene, const char* name) {
  const aiTexture* embedded = scene.GetEmbeddedTexture(name);
  if (!embedded)
    return decode_image(builder, read_beside(scene_path, name, builder->options.byte_count_max, &builder->files), name);
  const std::uint8_t* data = reinterpret_cast<const std::uint8_t*>(embedded->pcData);
  if (embedded->mHeight == 0) return decode_image(builder, Bytes(data, data + embedded->mWidth), name);
  Image image;
  image.width = embedded->mWidth, image.height = embedded->mHeight;
  if (image.width < 1 || image.width > kTextureSideMax || image.height > kTextureSideMax)
    fail_import("%.60s is too large", name);
  image.texels.resize(static_cast<std::size_t>(image.width) * image.height);
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    const aiTexel& texel = embedded->pcData[i];
    std::uint8_t rgba[4] = {texel.r, texel.g, texel.b, texel.a};
    std::memcpy(&image.texels[i], rgba, 4);
  }
  return image;
}

Wrap wrap_of(aiTextureMapMode mode) {
  return mode == aiTextureMapMode_Clamp ? Wrap::clamp : mode == aiTextureMapMode_Mirror ? Wrap::mirror : Wrap::repeat;
}

TextureUse texture_of(SceneBuilder* builder, const std::string& scene_path, const aiScene& scene,
                      const aiMaterial& source, aiTextureType type) {
  TextureUse use;
  aiString name;
  aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (source.GetTexture(type, 0, &name, nullptr, nullptr, nullptr, nullptr, modes) != aiReturn_SUCCESS) return use;
  try {
    use.texture = add_texture(builder, add_texels(builder, load(builder, scene_path, scene, name.C_Str())),
                              wrap_of(modes[0]), wrap_of(modes[1]), false);
  } catch (const ImportError& error) {
    note_remark(builder, std::string("a texture is missing: ") + error.what());
  }
  return use;
}

void add_light(SceneBuilder* builder, const aiLight& source, const Transform& world) {
  Light light;
  switch (source.mType) {
    case aiLightSource_POINT:
      light.kind = LightKind::point;
      break;
    case aiLightSource_SPOT:
      light.kind = LightKind::spot;
      break;
    case aiLightSource_DIRECTIONAL:
      light.kind = LightKind::directional;
      break;
    default:
      note_unused(builder, "ambient and area lights");
      return;
  }
  const aiVector3D &p = source.mPosition, &d = source.mDirection;
  light.position = transform_point(world, {p.x, p.y, p.z});
  light.direction = normalize(transform_vector(world, {d.x, d.y, d.z}));
  if (is_zero(light.direction)) light.direction = {0, -1, 0};
  light.intensity = bounded3(source.mColorDiffuse, 1e18f);
  if (light.kind == LightKind::spot) {
    double outer = static_cast<double>(bounded(source.mAngleOuterCone, 0, 2 * kPiF)) / 2;
    double inner = std::min(static_cast<double>(bounded(source.mAngleInnerCone, 0, 2 * kPiF)) / 2, outer);
    light.cos_outer = static_cast<float>(det_cos(outer)), light.cos_inner = static_cast<float>(det_cos(inner));
  }
  if (!is_coordinate(light.position)) return note_unused(builder, "lights without a finite position");
  builder->out->lights.push_back(light);
  builder->out->info.auto_exposure = 1;
}

void add_camera(SceneBuilder* builder, const aiCamera& source, const Transform& world) {
  Camera camera;
  const aiVector3D &p = source.mPosition, &l = source.mLookAt, &u = source.mUp;
  camera.eye = transform_point(world, {p.x, p.y, p.z});
  Vec3 forward = normalize(transform_vector(world, {l.x, l.y, l.z}));
  camera.target = camera.eye + forward;
  camera.up = normalize(transform_vector(world, {u.x, u.y, u.z}));
  // Documented as half the horizontal angle, but the COLLADA, FBX and 3DS readers store the whole angle.
  double aspect = source.mAspect > 0 ? static_cast<double>(source.mAspect) : 4.0 / 3.0;
  double half = std::atan(std::tan(static_cast<double>(source.mHorizontalFOV) / 2) / aspect);
  camera.vertical_fov = static_cast<float>(2 * half);
  bool valid = is_coordinate(camera.eye) && camera.target != camera.eye && !is_zero(cross(forward, camera.up)) &&
               within(Quantity::field_of_view, camera.vertical_fov);
  if (!valid) return note_unused(builder, "cameras without a valid view");
  builder->out->cameras.push_back(camera);
}

// World transform of the node with the light's or camera's name.
Transform world_of(const aiScene& scene, const aiString& name, const Vec3d& origin) {
  aiMatrix4x4 m;
  for (const aiNode* node = scene.mRootNode->FindNode(name); node; node = node->mParent) m = node->mTransformation * m;
  Transform t;
  for (unsigned row = 0; row < 3; ++row)
    for (unsigned column = 0; column < 4; ++column) t.m[row][column] = m[row][column];
  return recentred(exact(t), origin);
}

}  // namespace

Rgba16 assimp_color(const aiColor4D& c) {
  return {linear_16(c.r), linear_16(c.g), linear_16(c.b),
          static_cast<std::uint16_t>(bounded(c.a, 0, 1) * 65535.0f + 0.5f)};
}

std::uint32_t add_default_material(SceneBuilder* builder) {
  builder->out->materials.emplace_back();
  return static_cast<std::uint32_t>(builder->out->materials.size() - 1);
}

std::uint32_t add_assimp_material(SceneBuilder* builder, const std::string& scene_path, const aiScene& scene,
                                  const aiMaterial& source) {
  Material material;
  aiColor3D color;
  float value;
  if (source.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) material.diffuse = bounded3(color, 1);
  if (source.Get(AI_MATKEY_COLOR_EMISSIVE, color) == aiReturn_SUCCESS) material.emission = bounded3(color, 1e18f);
  bool shines = source.Get(AI_MATKEY_SHININESS, value) == aiReturn_SUCCESS && value > 0;
  if (shines && source.Get(AI_MATKEY_COLOR_SPECULAR, color) == aiReturn_SUCCESS) {
    float strength = 1;
    source.Get(AI_MATKEY_SHININESS_STRENGTH, strength);
    material.specular = bounded3(color, 1) * bounded(strength, 0, 1);
    material.exponent = bounded(value, 0, 1e6f);
  }
  if (source.Get(AI_MATKEY_REFRACTI, value) == aiReturn_SUCCESS) material.ior = bounded(value, 1, kIorMax);
  if (source.Get(AI_MATKEY_OPACITY, value) == aiReturn_SUCCESS) material.opacity = bounded(value, 0, 1);
  if (material.opacity < 1 && material.ior > 1 && source.Get(AI_MATKEY_REFRACTI, value) == aiReturn_SUCCESS) {
    material.transmission = Vec3{1, 1, 1} * (1 - material.opacity);
    material.diffuse = material.diffuse * material.opacity;
    material.opacity = 1;
  } else if (material.opacity < 1) {
    material.alpha_mode = AlphaMode::blend;
  }
  material.diffuse_texture = texture_of(builder, scene_path, scene, source, aiTextureType_DIFFUSE);
  material.emission_texture = texture_of(builder, scene_path, scene, source, aiTextureType_EMISSIVE);
  if (source.GetTextureCount(aiTextureType_NORMALS) + source.GetTextureCount(aiTextureType_HEIGHT) > 0)
    note_unused(builder, "bump and normal maps");
  if (source.GetTextureCount(aiTextureType_SPECULAR) > 0) note_unused(builder, "specular maps");
  if (source.GetTextureCount(aiTextureType_OPACITY) > 0) note_unused(builder, "opacity maps");
  return add_material(builder, material, source.GetName().C_Str());
}

void add_assimp_lights_and_cameras(SceneBuilder* builder, const aiScene& scene) {
  if (scene.mNumLights > kLightCountMax || scene.mNumCameras > kCameraCountMax)
    fail_import("%u lights and %u cameras; remove some", scene.mNumLights, scene.mNumCameras);
  const Vec3d origin = origin_of(*builder);
  for (unsigned i = 0; i < scene.mNumLights; ++i)
    add_light(builder, *scene.mLights[i], world_of(scene, scene.mLights[i]->mName, origin));
  for (unsigned i = 0; i < scene.mNumCameras; ++i)
    add_camera(builder, *scene.mCameras[i], world_of(scene, scene.mCameras[i]->mName, origin));
}

}  // namespace pocketray

#endif
