#include "temporal/edit_script.h"

#include <cmath>
#include <cstring>

#include "accel/accel_list.h"
#include "effect/setting_list.h"
#include "engine/recolor.h"

namespace pocketray {
namespace {

float next_in(Rng* rng, float low, float high) { return low + (high - low) * next_float(rng); }

Vec3 next_vector(Rng* rng, float size) {
  return {next_in(rng, -size, size), next_in(rng, -size, size), next_in(rng, -size, size)};
}

// Moves, turns, flattens or puts back a run of the moving vertices.
void edit_shape(EditScript* s) {
  std::vector<Vec3>&rest = s->generated->rest_positions, &normals = s->generated->rest_normals;
  if (rest.empty()) return;
  std::uint32_t count = static_cast<std::uint32_t>(rest.size());
  std::uint32_t begin = next_u32(&s->rng) % count, end = std::min(count, begin + 1 + next_u32(&s->rng) % 24);
  const std::uint32_t kind = next_u32(&s->rng) % 7;
  const Vec3 by = next_vector(&s->rng, kind == 0 ? 1e-7f : 0.6f) * (kind == 6 ? 1 : s->scale);
  if (kind == 6) begin = 0, end = count;  // normals alone
  for (std::uint32_t i = begin; i < end; ++i) {
    if (kind <= 1) rest[i] += by;          // by less than an ulp, too
    if (kind == 2) rest[i] = rest[begin];  // deleted: a point
    if (kind == 3) rest[i] = s->rest[i];   // added again
    if (kind == 4) rest[i].y = 0;          // onto the floor: coincident surfaces
    if (kind == 6) normals[i] = normalize(normals[i] + by);
    if (kind == 5) rest[i] = s->rest[i] + by * 40.0f;  // far outside
  }
}

void edit_light(EditScript* s) {
  std::vector<Light>& lights = s->generated->lights;
  if (lights.empty()) return;
  Light* light = &lights[next_u32(&s->rng) % lights.size()];
  switch (next_u32(&s->rng) % 4) {
    case 0:
      light->position += next_vector(&s->rng, 0.4f) * s->scale;
      break;
    case 1:
      light->intensity = light->intensity * next_in(&s->rng, 0.5f, 1.5f);
      break;
    case 2:
      light->intensity = is_zero(light->intensity) ? Vec3{3, 4, 5} : Vec3{0, 0, 0};
      break;
    default:
      light->range = light->range > 0 ? 0 : 4;
  }
}

void edit_surroundings(EditScript* s) {
  const std::uint32_t kind = next_u32(&s->rng) % 9;
  const Vec3 color = next_vector(&s->rng, 0.1f) + Vec3{0.15f, 0.15f, 0.15f};
  const float x = next_in(&s->rng, 0, 1);
  for (Renderer* renderer : {&s->whole->renderer, &s->coherent->renderer}) {
    Settings settings = renderer->settings;
    Camera camera = renderer->view.camera;
    switch (kind) {
      case 0:
        renderer->scene.info.background = color;
        break;
      case 1:
        renderer->scene.info.ambient = color;
        break;
      case 2:
        renderer->view.exposure = 0.5f + x;
        break;
      case 3:
        settings.ray_depth = static_cast<std::uint32_t>(x * 5);
        break;
      case 4:
        settings.cut_off_levels = x < 0.3f ? 0 : x;
        break;
      case 5:
        settings.normals = x < 0.5f ? NormalMode::flat : NormalMode::as_scene;
        break;
      case 6:
        settings.samples_per_pixel = 1 + static_cast<std::uint32_t>(x * 3);  // planned for 1 or 2
        break;
      case 7:
        settings.texture_filter = static_cast<TextureFilter>(static_cast<int>(x * 3));
        break;
      default:
        camera.eye.x += x - 0.5f;
    }
    if (kind >= 3 && kind <= 7) (void)change_settings(renderer, settings);
    if (kind == 8) (void)set_camera(renderer, camera);
  }
}

void edit_material(EditScript* s) {
  const std::vector<Material>& opened = s->generated->materials;
  const std::uint32_t index = next_u32(&s->rng) % static_cast<std::uint32_t>(opened.size());
  const Material m = recolored(opened[index], s->whole->renderer.materials.current[index],
                               static_cast<std::uint32_t>(s->generated->textures.size()), &s->rng);
  if (!check_recolored(&s->whole->renderer, index, m).ok) return;
  for (Renderer* renderer : {&s->whole->renderer, &s->coherent->renderer}) (void)change_material(renderer, index, m);
}

void edit(EditScript* s) {
  const std::uint32_t kind = next_u32(&s->rng) % 32;
  if (kind < 12) edit_shape(s);
  if (kind >= 8 && kind < 18) s->seconds += next_in(&s->rng, 0, kind < 14 ? 0.02f : 0.7f);
  if (kind >= 18 && kind < 24) edit_light(s);
  if (kind == 24) edit_surroundings(s);
  if (kind == 9 || kind == 16 || kind == 20 || kind > 26) edit_material(s);
  // Otherwise nothing changes.
}

bool is_stopped(Renderer* renderer, double seconds) {
  std::atomic<bool> stop{true};
  bool complete = true;
  return render_frame(renderer, changes_at(seconds, &stop), &complete).ok &&
         (!complete || renderer->history.state.pixels_traced == 0);
}

// Lets a random run of the vertices move, or all of them: bodies, lamps, panes, cut-out and one-sided surfaces.
void let_any_move(GeneratedScene* g, Rng* rng) {
  const std::uint32_t total = static_cast<std::uint32_t>(g->positions.size());
  std::uint32_t a = next_u32(rng) % total, b = next_u32(rng) % total;
  if (next_u32(rng) % 2 == 0) a = 0, b = total - 1;
  const std::uint32_t first = std::min(a, b), end = std::max(a, b) + 1;
  g->moving_meshes[0].vertex_begin = first, g->moving_meshes[0].vertex_count = end - first;
  g->rest_positions.assign(g->positions.begin() + first, g->positions.begin() + end);
  g->rest_normals.assign(g->normals.begin() + first, g->normals.begin() + end);
}

// Places the scene elsewhere, larger or smaller. Returns the scale.
float place_anywhere(GeneratedScene* g, Rng* rng) {
  const float scales[] = {1, 1, 1, 1e-12f, 1e12f, 1e17f}, offsets[] = {0, 0, 0, 100, 3000, 1e5f};
  const float scale = scales[next_u32(rng) % 6], offset = scale > 1e16f ? 0 : offsets[next_u32(rng) % 6];
  auto place = [&](Vec3& p) { p = (p + Vec3{offset, -offset * 0.5f, offset * 0.25f}) * scale; };
  for (Vec3& p : g->positions) place(p);
  for (Vec3& p : g->rest_positions) place(p);
  for (Light& light : g->lights) {
    place(light.position);
    if (light.kind != LightKind::directional) light.intensity = light.intensity * std::min(scale * scale, 1e17f);
  }
  place(g->cameras[0].eye), place(g->cameras[0].target);
  g->cameras[0].vertical_extent = 4 * scale;
  for (float& key : g->key_values) key *= scale;
  return scale;
}

// As many as source selection takes.
void add_many_lights(GeneratedScene* s, Rng* rng) {
  for (int i = 0; i < 24; ++i) {
    Light light;
    light.position = next_vector(rng, 5) + Vec3{0, 5, 0};
    light.intensity = next_vector(rng, 0.5f) + Vec3{0.5f, 0.5f, 0.5f};
    s->lights.push_back(light);
  }
}

}  // namespace

Material recolored(const Material& opened, Material m, std::uint32_t texture_count, Rng* rng) {
  Vec3* const colors[] = {&m.diffuse, &m.diffuse, &m.specular, &m.mirror, &m.transmission, &m.absorption};
  Vec3* color = colors[next_u32(rng) % 6];
  switch (next_u32(rng) % 8) {
    case 0:
      *color = {color->y, color->z, color->x};
      break;
    case 1:
      *color = *color * next_in(rng, 0.5f, 1);
      break;
    case 2:
      *color = {0, 0, 0};
      break;
    case 3:
      m.diffuse = next_vector(rng, 0.5f) + Vec3{0.5f, 0.5f, 0.5f};
      break;
    case 4:
    case 5:
      m.diffuse_texture.texture = next_u32(rng) % (texture_count + 1);
      if (m.diffuse_texture.texture == texture_count) m.diffuse_texture.texture = kNone;
      break;
    case 6:
      m.emission = opened.emission * (next_u32(rng) % 4 == 0 ? 0 : next_in(rng, 0.3f, 1.1f));
      break;
    default:
      return opened;
  }
  m.specular_tinted = min(m.specular_tinted, m.specular), m.mirror_tinted = min(m.mirror_tinted, m.mirror);
  return m;
}

EditScript begin_script(std::uint32_t features, std::uint64_t seed) {
  EditScript s;
  s.rng = make_rng(seed, 58);
  s.generated = generate_scene(features | bit(Feature::animation), seed);
  if (next_u32(&s.rng) % 4 == 0) add_many_lights(s.generated.get(), &s.rng);
  if (next_u32(&s.rng) % 2) let_any_move(s.generated.get(), &s.rng);
  if (next_u32(&s.rng) % 2) s.scale = place_anywhere(s.generated.get(), &s.rng);
  if (next_u32(&s.rng) % 4 == 0) {
    s.generated->cameras[0].projection = Projection::orthographic;
    s.generated->cameras[0].vertical_extent = 4 * s.scale;
  }
  s.generated->bind();
  if (next_u32(&s.rng) % 3 == 0) {
    s.environment = std::make_unique<TestEnvironment>(16, 8, Vec3{0.4f, 0.5f, 0.6f}, [](const Vec3d& d, int) {
      return d.x > 0.8 ? Vec3d{5, 4, 3} : Vec3d{1 + d.y, 1.2 + d.y, 1.5 + d.y};
    });
    s.environment->give(&s.generated->scene);
  }
  s.rest = s.generated->rest_positions;
  Settings plain = settings_for(features, 24 + next_u32(&s.rng) % 30, 20 + next_u32(&s.rng) % 20);
  plain.environment_shadows = next_u32(&s.rng) % 40;
  if (next_u32(&s.rng) % 3 == 0) {
    plain.indirect = indirect_choice(Effect::instant_radiosity);
    plain.virtual_lights = 1 + next_u32(&s.rng) % (next_u32(&s.rng) % 2 ? 4 : 40);  // few of them rest more often
    if (seed % 2) plain.compensation = Compensation::rays;
  }
  const AccelInfo* const accels[] = {nullptr, nullptr,
                                     kAccelList[next_u32(&s.rng) % (sizeof kAccelList / sizeof kAccelList[0])]};
  const AccelInfo* accel = accels[next_u32(&s.rng) % 3];
  s.whole = make_renderer(s.generated->scene, plain, accel, nullptr, true);
  Settings settings = plain;
  const std::uint32_t sides[] = {1, 4, 16, 16, 64};
  settings.coherence = CoherenceMode::on;
  settings.coherence_table = sides[next_u32(&s.rng) % 5];
  settings.coherence_by_tables = next_u32(&s.rng) % 8 == 0;
  settings.threads = 1 + next_u32(&s.rng) % 3;
  s.shares = next_u32(&s.rng) % 3 == 0;
  if (s.shares && next_u32(&s.rng) % 2) settings.coherence = CoherenceMode::automatic;
  s.coherent = make_renderer(s.generated->scene, settings, accel, nullptr, true);
  return s;
}

bool follow_script(EditScript* s) {
  Renderer *whole = &s->whole->renderer, *coherent = &s->coherent->renderer;
  edit(s);
  whole->lights.lit_mask = coherent->lights.lit_mask = ~EffectMask(0);
  const std::uint32_t disturbance = next_u32(&s->rng) % 40;
  if (disturbance == 0 && !is_stopped(coherent, s->seconds + 0.3)) return false;
  if (disturbance == 1 && !render_frame(coherent, s->seconds + 0.5).ok) return false;
  if (disturbance == 2 && !begin_frame(coherent, {s->seconds + 0.7}).ok) return false;
  if (s->shares && next_u32(&s->rng) % 8 != 0)
    return render_frame(whole, s->seconds).ok && follow_shared(coherent, *whole, s->seconds, &s->rng, &s->shared);
  if (!render_frame(whole, s->seconds).ok || !render_frame(coherent, changes_at(s->seconds)).ok) return false;
  if (!coherent->history.state.whole_because) {
    ++s->partial_frames;
    if (coherent->effects.mask & bit(Effect::instant_radiosity) && !is_unchanged(coherent->history.coherence))
      ++s->partly_relit_frames;
    s->pixels_traced += coherent->history.state.pixels_traced;
  }
  return std::memcmp(whole->image.data, coherent->image.data, whole->image.bytes()) == 0;
}

}  // namespace pocketray
