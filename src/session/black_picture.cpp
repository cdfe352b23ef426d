#include "session/black_picture.h"

#include <algorithm>
#include <cstdio>

#include "base/check.h"
#include "indirect/surroundings.h"
#include "shade/camera.h"
#include "shade/contact.h"
#include "shade/filters.h"
#include "shade/lights.h"

namespace pocketray {
namespace {

// Chosen: a fraction measured with 1000 rays is within 3 % of the picture's, at almost no cost; fewer than 8 hits are
// not significant.
constexpr std::uint32_t kRaysMax = 1000, kHitsMin = 8;

enum Cause { kNoReflection, kBlackSurroundings, kBlocked, kUnlit, kCauseCount };

// Results of a grid of rays.
struct Findings {
  std::uint32_t hits = 0, black = 0, causes[kCauseCount] = {};
  std::uint32_t black_backs = 0;      // seen from behind
  std::uint32_t material_count = 0;   // of surfaces that are lit or where light would not matter
  std::uint32_t materials[kRaysMax];  // indices of these
};

// Finds the first opaque surface behind a pixel's centre.
bool find_surface(const FrameData& frame, std::uint32_t column, std::uint32_t row, Surface* s) {
  Ray ray = camera_ray(frame.view.camera, static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
  for (std::uint32_t layer = 0; layer < kTransparentLayerMax; ++layer) {
    Hit hit;
    frame.geometry.accel_info->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, nullptr);
    if (hit.triangle == kNoTriangle) return false;
    frame.kernels.surface(frame, ray, hit, s);
    const Material& m = *s->material;
    if (!culls(m, s->front, frame.mask) && !transmits(m, frame.mask) && !blends(m, frame.mask)) return true;
    ray.origin = safe_origin(*s, -1);
  }
  return false;
}

bool has_light_on(const FrameData& frame) {
  return std::any_of(frame.lights.points.begin(), frame.lights.points.end(),
                     [](const LightPoint& light) { return !is_zero(light.intensity); });
}

bool is_lit_unless_blocked(const FrameData& frame, const Surface& s) {
  for (int r = 0; r < frame.lights.run_count; ++r)
    for (std::uint32_t i = frame.lights.runs[r].begin; i < frame.lights.runs[r].end; ++i) {
      LightSample sample;
      if (lights_up(frame, s, frame.lights.runs[r], frame.lights.points[i], &sample)) return true;
    }
  return false;
}

Cause cause_of_black(const FrameData& frame, const Surface& s) {
  const Material& m = *s.material;
  if (is_zero(s.diffuse) || m.unlit)
    return is_zero(m.specular) && is_zero(m.mirror) ? kNoReflection : kBlackSurroundings;
  return is_lit_unless_blocked(frame, s) ? kBlocked : kUnlit;
}

void look_at(const Renderer& renderer, Findings* found) {
  const FrameData& frame = renderer.frame;
  const std::uint32_t width = renderer.settings.width, height = renderer.settings.height;
  std::uint32_t step = 1;
  while (((width + step - 1) / step) * ((height + step - 1) / step) > kRaysMax) ++step;
  for (std::uint32_t row = step / 2; row < height; row += step)
    for (std::uint32_t column = step / 2; column < width; column += step) {
      Surface s;
      if (!find_surface(frame, column, row, &s)) continue;
      CHECK_LT(found->hits, kRaysMax);
      ++found->hits;
      if (!is_zero(renderer.image[static_cast<std::size_t>(row) * width + column])) continue;
      ++found->black;
      found->black_backs += !s.front;
      const Cause cause = cause_of_black(frame, s);
      ++found->causes[cause];
      if (cause == kNoReflection || cause == kBlackSurroundings)
        found->materials[found->material_count++] =
            static_cast<std::uint32_t>(s.material - frame.scene->materials.begin());
    }
}

std::uint32_t most_frequent(std::uint32_t* values, std::uint32_t count) {
  CHECK_GT(count, 0u);
  std::sort(values, values + count);
  std::uint32_t best = values[0], longest = 0;
  for (std::uint32_t i = 0, run = 0; i < count; ++i) {
    run = i > 0 && values[i] == values[i - 1] ? run + 1 : 1;
    if (run > longest) longest = run, best = values[i];
  }
  return best;
}

void describe_material(const Renderer& renderer, const std::vector<std::string>& names, Cause cause, Findings* found,
                       char* text, std::size_t text_bytes) {
  const std::uint32_t index = most_frequent(found->materials, found->material_count);
  const Material& m = renderer.scene.materials[index];
  char name[100];
  if (index < names.size() && !names[index].empty())
    std::snprintf(name, sizeof name, "material '%.60s'", names[index].c_str());
  else
    std::snprintf(name, sizeof name, "material %u of %u", index + 1, renderer.scene.materials.count);
  if (cause == kNoReflection && is_zero(m.diffuse))
    std::snprintf(text, text_bytes,
                  "%s reflects nothing: its diffuse, specular and mirror colours are 0; give it a colour", name);
  else if (cause == kNoReflection)
    std::snprintf(text, text_bytes, "the texture or vertex colours of %s are black there; check how they were exported",
                  name);
  else
    std::snprintf(text, text_bytes, "%s is a metal or mirror, and what it reflects is black%s", name,
                  is_zero(radiance_of_surroundings(renderer.scene.info)) ? "; try --background '#808080'" : "");
}

bool has_bright_light(const Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return !is_zero(l.intensity); });
}

void describe_light(const Renderer& renderer, Cause cause, const Findings& found, char* text, std::size_t text_bytes) {
  const bool is_bounced = has(renderer.effects.mask, Effect::instant_radiosity);
  const char* more = is_bounced ? "" : ", or try --indirect instant-radiosity for light from other surfaces";
  const bool is_out_of_reach = !renderer.settings.forced_off && has_bright_light(renderer.scene);  // and not planned
  if (!has_light_on(renderer.frame) && !is_out_of_reach)
    std::snprintf(text, text_bytes, "there is no light: %s",
                  renderer.settings.forced_off ? "--effects has switched it off" : "the scene's lights are at 0");
  else if (2 * found.black_backs > found.black)
    std::snprintf(text, text_bytes,
                  "no light reaches them, and the camera sees their backs: it may be inside an object; move it "
                  "with --camera");
  else if (cause == kBlocked)
    std::snprintf(text, text_bytes, "all light on its way there is blocked; move the lights%s", more);
  else
    std::snprintf(text, text_bytes, "they are out of range of the lights, or turned away from them; move them%s", more);
}

}  // namespace

bool explain_black(const Renderer& renderer, const std::vector<std::string>& material_names,
                   char (&text)[kBlackTextBytes]) {
  CHECK(renderer.image.data != nullptr && renderer.frame.scene != nullptr);  // a frame has been rendered
  text[0] = 0;
  Findings found;
  look_at(renderer, &found);
  if (found.hits < kHitsMin) return false;
  const double share = static_cast<double>(found.black) / found.hits;
  const Cause cause = static_cast<Cause>(std::max_element(found.causes, found.causes + kCauseCount) - found.causes);
  const bool is_shadow = (cause == kBlocked || cause == kUnlit) && has_light_on(renderer.frame);
  if (!(share > (is_shadow ? kShadowShareMax : kBlackShareMax))) return false;
  char why[300];
  if (cause == kNoReflection || cause == kBlackSurroundings)
    describe_material(renderer, material_names, cause, &found, why, sizeof why);
  else
    describe_light(renderer, cause, found, why, sizeof why);
  std::snprintf(text, sizeof text, "%.0f %% of the surfaces in the picture are exactly black: %s", 100 * share, why);
  return true;
}

}  // namespace pocketray
