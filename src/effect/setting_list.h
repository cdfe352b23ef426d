// One row per setting that trades accuracy for time. The command line, its validation, fronts, the settings on the
// wire, the server's reuse of a renderer, sweeps and the budget's choice are all derived from the rows: a new setting
// is a member of Quality and a row here. The member holds the default, base/limit_list.h the limits. Settings that
// change no picture, such as Settings::coherence_table, which trades memory for time, have no row: every choice by
// error would pick the fastest, and they cannot change within the planned memory. `coherence-report --sweep-table`
// sweeps it.
#pragma once
#include "effect/effect_list.h"
#include "effect/setting.h"

namespace pocketray {

inline constexpr const char* kTextureFilterNames[] = {"scene", "nearest", "bilinear", "trilinear", "anisotropic"};
inline constexpr const char* kNormalNames[] = {"scene", "flat"};
inline constexpr const char* kResolutionNames[] = {"full", "checkerboard", "half"};
inline constexpr const char* kCompensationNames[] = {"none", "rays"};
inline constexpr const char* kReconstructionNames[] = {"constant", "bilinear", "bicubic", "quadratic", "cubic"};

// "auto", "none", then the effects that are methods of indirect light.
constexpr int kIndirectChoiceCount = 2 + __builtin_popcount(kIndirectEffects);
struct IndirectNames {
  const char* names[kIndirectChoiceCount] = {"auto", "none"};
  constexpr IndirectNames() {
    int count = 2;
    for (const EffectRow& row : kEffectList)
      if (kIndirectEffects & bit(row.effect)) names[count++] = row.name;
  }
};
inline constexpr IndirectNames kIndirectNames;
// None first, the scene's own method last.
constexpr SweepValues indirect_sweep() {
  SweepValues sweep = {};
  for (int i = 0; i < kIndirectChoiceCount; ++i) sweep.values[sweep.count++] = (i + 1) % kIndirectChoiceCount;
  return sweep;
}
// Returns the choice for a method's effect, which is one of kIndirectEffects.
constexpr IndirectChoice indirect_choice(Effect effect) {
  const EffectMask before = kIndirectEffects & (bit(effect) - 1);
  return static_cast<IndirectChoice>(static_cast<int>(IndirectChoice::first) + __builtin_popcountll(before));
}

constexpr EffectMask kReflecting = bit(Effect::mirror) | bit(Effect::refraction);
constexpr EffectMask kSpawning = kReflecting | bit(Effect::alpha_blend);

inline double samples_price(double samples) { return samples; }
// Edges take about a tenth of the pixels, and samples of one pixel half of what those of different pixels take.
inline double edge_samples_price(double samples) { return 1 + samples / 20; }
// Other work on a pixel costs about as much as four rays.
inline double virtual_lights_price(double lights) { return lights + 64; }
// A surface hides half of the directions, so twice as many as virtual lights cost as much.
inline double environment_shadows_price(double directions) { return directions + 128; }
// A pixel without lights costs about as much as one point.
inline double points_price(double points) { return points + 1; }

inline constexpr SettingRow kSettingList[] = {
    {"samples",
     "rays through each pixel",
     "",
     "samples",
     count_field<&Quality::samples_per_pixel>(Quantity::samples),
     1,
     bit(Effect::supersampling),
     kAlways,
     true,
     kAsAsked,
     {1, 2, 4, 6, 9, 12, 16},
     samples_price,
     "between -1/2, random points on an edge, and -1, a regular grid on straight edges"},
    {"depth",
     "reflections and refractions along a path",
     "",
     "depth",
     count_field<&Quality::ray_depth>(Quantity::depth),
     1,
     kReflecting,
     kSpawning,
     true,
     kRayDepthMax,
     {0, 1, 2, 3, 4, 5, 6, 7, 8},
     nullptr,
     "error falls as reflectance to the power of depth, faster than any power of time"},
    {"area-lights",
     "points per area light",
     "",
     "lights",
     count_field<&Quality::points_per_area_light>(Quantity::area_light_points),
     2,
     bit(Effect::area_light),
     bit(Effect::area_light),
     true,
     kAsAsked,
     {1, 4, 9, 16, 36, 64, 144, 256},
     points_price,
     "-1/2 for random points; a grid of n points errs by one shadow edge of n, down to -1"},
    {"cut-off",
     "largest error per pixel from skipped rays, in display levels",
     "0: trace every ray",
     "cut-off",
     real_field<&Quality::cut_off_levels>(Quantity::cut_off),
     4,
     kSpawning,
     kSpawning | bit(Effect::shadow),
     false,
     0,
     {16, 8, 4, 2, 1, 0.5, 0.25, 0},
     nullptr,
     ""},
    {"texture-filter",
     "texture filtering",
     "anisotropic: up to four samples along a pixel's footprint, sharper at grazing angles",
     nullptr,
     choice_field<&Quality::texture_filter>(kTextureFilterNames),
     1,
     bit(Effect::texture),
     bit(Effect::texture),
     true,
     double(TextureFilter::as_scene),
     {double(TextureFilter::nearest), double(TextureFilter::as_scene), double(TextureFilter::bilinear),
      double(TextureFilter::trilinear), double(TextureFilter::anisotropic)},
     nullptr,
     ""},
    {"normals",
     "normals across a triangle",
     "scene: smooth where it has normals",
     nullptr,
     choice_field<&Quality::normals>(kNormalNames),
     1,
     bit(Effect::smooth_normal),
     bit(Effect::smooth_normal),
     false,
     double(NormalMode::as_scene),
     {double(NormalMode::flat), double(NormalMode::as_scene)},
     nullptr,
     ""},
    {"indirect", "light from other surfaces",
     "auto: radiosity, stored or, on desktops, solved for a lit room; otherwise ambient. instant-radiosity is worth "
     "its time where no radiosity is stored, best with --virtual-lights 256 and --compensation rays",
     nullptr, choice_field<&Quality::indirect>(kIndirectNames.names), 1, kIndirectEffects, kIndirectEffects, true,
     kAsAsked, indirect_sweep(), nullptr, ""},
    {"reconstruction",
     "how baked radiosity is interpolated between samples",
     "quadratic and cubic also smooth triangles",
     nullptr,
     choice_field<&Quality::reconstruction>(kReconstructionNames),
     1,
     bit(Effect::radiosity),
     bit(Effect::radiosity),
     false,
     double(Reconstruction::bicubic),
     {double(Reconstruction::constant), double(Reconstruction::bilinear), double(Reconstruction::quadratic),
      double(Reconstruction::cubic), double(Reconstruction::bicubic)},
     nullptr,
     ""},
    {"virtual-lights",
     "virtual lights of instant radiosity",
     "each pixel samples 1/16 of them, hits in mirrors or behind glass sample all; "
     "--light-tolerance bounds the shadow rays",
     nullptr,
     count_field<&Quality::virtual_lights>(Quantity::virtual_lights),
     2,
     bit(Effect::instant_radiosity),
     bit(Effect::instant_radiosity),
     true,
     kAsAsked,
     {16, 32, 64, 128, 256, 512},
     virtual_lights_price,
     ""},
    {"compensation",
     "nearby indirect light that instant radiosity loses because its virtual lights are clamped",
     "rays: recovered by a short ray from each pixel's surface",
     nullptr,
     choice_field<&Quality::compensation>(kCompensationNames),
     1,
     bit(Effect::instant_radiosity),
     bit(Effect::instant_radiosity),
     true,
     double(Compensation::rays),
     {double(Compensation::none), double(Compensation::rays)},
     nullptr,
     "",
     true},
    {"selective",
     "interpolate between traced pixels whose contrast is below this",
     "0: trace every pixel; 0.2: hardly visible",
     "selective",
     real_field<&Quality::selective_contrast>(Quantity::contrast),
     4,
     bit(Effect::selective),
     kAlways,
     false,
     0,
     {0.5, 0.375, 0.25, 0.1875, 0.125, 0.0625, 0},
     nullptr,
     ""},
    {"resolution",
     "pixels to trace",
     "the others are reconstructed along edges",
     "resolution",
     choice_field<&Quality::resolution>(kResolutionNames),
     1,
     bit(Effect::undersampling),
     kAlways,
     false,
     double(Resolution::full),
     {double(Resolution::half), double(Resolution::checkerboard), double(Resolution::full)},
     nullptr,
     ""},
    {"light-tolerance",
     "with many lights, fraction of a surface's light that may skip shadow tests",
     "the strongest lights are tested, and one ray represents a group of virtual lights: a pixel traces at "
     "most 1 + 1/(16 × tolerance) rays to these; 0: test all",
     "light tolerance",
     real_field<&Quality::light_tolerance>(Quantity::light_tolerance),
     4,
     bit(Effect::source_selection) | bit(Effect::instant_radiosity),
     bit(Effect::source_selection) | bit(Effect::instant_radiosity),
     false,
     0,
     {0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625, 0},
     nullptr,
     ""},
    {"environment-shadows",
     "directions tested for the environment's shadows",
     "each pixel traces 1/16 of them, others than pixels beside it; 0: no shadows",
     nullptr,
     count_field<&Quality::environment_shadows>(Quantity::environment_shadows),
     2,
     bit(Effect::environment_shadow),
     bit(Effect::environment_shadow),
     false,
     kAsAsked,
     {0, 16, 32, 64, 128, 256},
     environment_shadows_price,
     ""},
    {"edge-samples",
     "rays added to each pixel at an edge",
     "pixels differ from their neighbours there, as displayed; 0: none; has no effect on pixels with several --samples",
     "edge samples",
     count_field<&Quality::edge_samples>(Quantity::edge_samples),
     1,
     bit(Effect::edge_sampling),
     kAlways,
     true,
     kAsAsked,
     {0, 2, 4, 6, 8, 12, 16},
     edge_samples_price,
     "",
     true},
};
constexpr int kSettingCount = sizeof kSettingList / sizeof kSettingList[0];

// Bytes of all settings on the wire.
constexpr std::uint32_t setting_wire_bytes() {
  std::uint32_t sum = 0;
  for (const SettingRow& row : kSettingList) sum += row.wire_bytes;
  return sum;
}

// Returns the row with that name, or null.
const SettingRow* find_setting(const char* name);

// Returns whether the value is within the setting's limits; false for NaN.
bool within_setting(const SettingRow& row, double value);
// "the number of samples per pixel is 99: it must lie in 1 … 16"; `name` as in check_limit().
Status check_setting(const SettingRow& row, double value, const char* name = nullptr);
// Finds the choice with that name, which need not be null-terminated; returns false if there is none.
bool find_choice(const SettingRow& row, const char* name, std::size_t name_bytes, double* value);
// Writes "1 … 16" or "scene, nearest or bilinear"; terminated, truncated to `size`.
void describe_range(const SettingRow& row, char* text, std::size_t size);
// Writes "4", "0.5" or "nearest", a real with at most `digits` significant digits; terminated, truncated to `size`.
void describe_value(const SettingRow& row, double value, int digits, char* text, std::size_t size);

bool same_quality(const Quality& a, const Quality& b);
// Returns whether both give equal light points and radiance bounds for the same scene and effects.
bool same_lights(const Quality& a, const Quality& b);
// Settings for a reference: each at its exact value if it has one, otherwise as requested.
Settings reference_settings(const Settings& asked);

constexpr bool setting_rows_valid() {
  for (const SettingRow& row : kSettingList) {
    const SettingField& field = row.field;
    if (field.kind == SettingKind::count) {
      if (row.wire_bytes != 1 && row.wire_bytes != 2) return false;
      if (limit_of(field.quantity).low < 0 || limit_of(field.quantity).high >= double(1u << 8 * row.wire_bytes))
        return false;
    }
    if (field.kind == SettingKind::real && row.wire_bytes != 4) return false;
    if (field.kind == SettingKind::choice && (row.wire_bytes > 1 || row.sweep.count != field.name_count)) return false;
    if (row.sweep.count < 2) return false;
    for (int i = 0; i < row.sweep.count; ++i) {
      bool is_choice = field.kind == SettingKind::choice;
      double low = is_choice ? 0 : limit_of(field.quantity).low;
      double high = is_choice ? field.name_count - 1 : limit_of(field.quantity).high;
      if (!(row.sweep.values[i] >= low && row.sweep.values[i] <= high)) return false;
    }
  }
  return true;
}
static_assert(setting_rows_valid(), "each row's values are within its limits and fit its bytes; all choices are swept");

}  // namespace pocketray
