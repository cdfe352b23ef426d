#include "desktop/import/mtl_file.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "desktop/import/import_error.h"
#include "desktop/import/obj_lines.h"

namespace pocketray {
namespace {

constexpr float kFloatMax = std::numeric_limits<float>::max();

struct ColorRow {
  const char* key;
  Vec3 MtlMaterial::*member;
};
constexpr ColorRow kColors[] = {{"Kd", &MtlMaterial::diffuse},       {"Ks", &MtlMaterial::specular},
                                {"Ke", &MtlMaterial::emission},      {"Tf", &MtlMaterial::transmittance},
                                {"Kt", &MtlMaterial::transmittance}, {"Ka", nullptr}};

struct NumberRow {
  const char* key;
  float MtlMaterial::*member;
};
constexpr NumberRow kNumbers[] = {{"Ns", &MtlMaterial::shininess},     {"Ni", &MtlMaterial::ior},
                                  {"Pr", &MtlMaterial::roughness},     {"Pm", &MtlMaterial::metallic},
                                  {"Ps", &MtlMaterial::sheen},         {"sheen", &MtlMaterial::sheen},
                                  {"Pc", &MtlMaterial::coat},          {"Pcr", &MtlMaterial::coat_roughness},
                                  {"aniso", &MtlMaterial::anisotropy}, {"anisor", &MtlMaterial::rotation}};

struct MapRow {
  const char* key;
  MtlMap MtlMaterial::*member;
  const char* unused;  // its name in notes if it is not used
};
constexpr MapRow kMaps[] = {{"map_Kd", &MtlMaterial::diffuse_map, nullptr},
                            {"map_d", &MtlMaterial::opacity_map, nullptr},
                            {"map_Ke", &MtlMaterial::emission_map, nullptr},
                            {"map_Ka", nullptr, "ambient maps"},
                            {"map_Ks", nullptr, "specular maps"},
                            {"map_Ns", nullptr, "specular maps"},
                            {"map_bump", nullptr, "bump and normal maps"},
                            {"map_Bump", nullptr, "bump and normal maps"},
                            {"bump", nullptr, "bump and normal maps"},
                            {"norm", nullptr, "bump and normal maps"},
                            {"map_disp", nullptr, "displacement maps"},
                            {"map_Disp", nullptr, "displacement maps"},
                            {"disp", nullptr, "displacement maps"},
                            {"map_refl", nullptr, "reflection maps"},
                            {"refl", nullptr, "reflection maps"},
                            {"map_Pr", nullptr, "roughness and metallic maps"},
                            {"map_Pm", nullptr, "roughness and metallic maps"},
                            {"map_Ps", nullptr, "sheen"}};

class Reader {
 public:
  Reader(const std::string& file, SceneBuilder* builder, std::vector<MtlMaterial>* materials)
      : file_(file), builder_(builder), materials_(*materials) {}

  void read(ObjLine* line) {
    ObjWord key;
    if (!line->next(&key)) return;
    if (key.is("newmtl")) return begin_material(line->rest());
    MtlMaterial before_any;
    MtlMaterial& material = is_begun_ ? materials_.back() : before_any;
    for (const ColorRow& row : kColors)
      if (key.is(row.key)) return read_color(line, row, &material);
    for (const NumberRow& row : kNumbers)
      if (key.is(row.key)) return read_scalar(line, &(material.*row.member));
    for (const MapRow& row : kMaps)
      if (key.is(row.key)) return read_map(line, row, &material);
    if (key.is("d") || key.is("Tr")) return read_opacity(line, key.is("d"), &material);
    if (key.is("illum")) {
      float number = 0;
      read_scalar(line, &number);
      material.illumination = number >= 0 && number <= 10 ? static_cast<int>(number) : 0;
      return;
    }
    if (key.text().compare(0, 4, "map_") == 0) {
      MtlMap ignored;
      read_options(line, &ignored);
    }
    name_unused(key.text());
  }

 private:
  void begin_material(const std::string& name) {
    is_begun_ = true;
    materials_.emplace_back();
    materials_.back().name = name, materials_.back().file = file_;
  }

  void read_color(ObjLine* line, const ColorRow& row, MtlMaterial* material) {
    ObjWord word;
    if (!line->next(&word)) return;
    if (word.is("spectral") || word.is("xyz")) return note_unused(builder_, "spectral and CIE XYZ colours");
    float values[3] = {line->number(word, kFloatMax), 0, 0};
    // "The g and b arguments are optional. If only r is specified, then g, and b are assumed to be equal to r."
    const int given = 1 + line->numbers(2, kFloatMax, values + 1);
    if (given < 2) values[1] = values[0];
    if (given < 3) values[2] = values[0];
    if (row.member) material->*row.member = {values[0], values[1], values[2]};
    if (row.member == &MtlMaterial::diffuse) material->has_diffuse = true;
  }

  static void read_scalar(ObjLine* line, float* value) {
    float number;
    if (line->numbers(1, kFloatMax, &number) == 1) *value = number;
  }

  // `d` takes precedence over `Tr`, which some programs write as its complement and some as its equal.
  void read_opacity(ObjLine* line, bool is_d, MtlMaterial* material) {
    ObjLine words = *line;
    ObjWord word;
    if (words.next(&word) && word.is("-halo")) {
      note_unused(builder_, "-halo");
      *line = words;
    }
    float number;
    if (line->numbers(1, kFloatMax, &number) != 1) return;
    if (!is_d && material->has_opacity) return;
    material->has_opacity |= is_d;
    material->opacity = is_d ? number : 1 - number;
    material->opacity_line = line->number();
    char text[40];
    std::snprintf(text, sizeof text, "%s %g", is_d ? "d" : "Tr", static_cast<double>(number));
    material->opacity_text = text;
  }

  void read_map(ObjLine* line, const MapRow& row, MtlMaterial* material) {
    MtlMap map;
    read_options(line, &map);
    map.name = line->rest();
    if (map.name.size() >= 2 && map.name.front() == '"' && map.name.back() == '"')
      map.name = map.name.substr(1, map.name.size() - 2);
    if (row.member)
      material->*row.member = map;
    else if (!map.name.empty())
      note_unused(builder_, row.unused);
  }

  // Reads at least `count_min` numbers up to the first other word; keeps what follows.
  static void read_values(ObjLine* line, int count_min, int count, float* values) {
    for (int i = 0; i < count; ++i) {
      const ObjLine before = *line;
      ObjWord word;
      float number;
      if (!line->next(&word)) return;
      if (i >= count_min && !is_not_finite(word) && !read_number(word, &number)) {
        *line = before;
        return;
      }
      values[i] = line->number(word, kFloatMax);
    }
  }

  void read_options(ObjLine* line, MtlMap* map) {
    for (ObjLine before = *line;; before = *line) {
      ObjWord option, value;
      if (!line->next(&option) || *option.begin != '-') {
        *line = before;
        return;
      }
      float scale[3] = {map->scale[0], map->scale[1], 1}, offset[3] = {0, 0, 0}, range[2] = {map->base, map->gain},
            ignored[3] = {};
      if (option.is("-s")) {
        read_values(line, 1, 3, scale);
        std::copy(scale, scale + 2, map->scale);
      } else if (option.is("-o")) {
        read_values(line, 1, 3, offset);
        std::copy(offset, offset + 2, map->offset);
      } else if (option.is("-mm")) {
        read_values(line, 1, 2, range);
        map->base = range[0], map->gain = range[1];
      } else if (option.is("-t")) {
        read_values(line, 1, 3, ignored);
        if (ignored[0] != 0 || ignored[1] != 0 || ignored[2] != 0) note_unused(builder_, "turbulence of maps (-t)");
      } else if (option.is("-bm") || option.is("-boost") || option.is("-texres")) {
        read_values(line, 1, 1, ignored);
      } else if (option.is("-clamp") || option.is("-imfchan") || option.is("-blendu") || option.is("-blendv") ||
                 option.is("-cc") || option.is("-type")) {
        if (!line->next(&value)) return;
        if (option.is("-clamp")) map->clamp = value.is("on");
        if (option.is("-imfchan")) map->channel = *value.begin;
        if (option.is("-cc") && value.is("on")) note_unused(builder_, "colour correction of maps (-cc)");
      } else {  // a name that begins like an option
        *line = before;
        return;
      }
    }
  }

  void name_unused(const std::string& statement) {
    constexpr int kNamesMax = 8;  // chosen: keeps the line readable
    if (unused_count_ < kNamesMax && std::find(unused_.begin(), unused_.end(), statement) == unused_.end()) {
      ++unused_count_;
      unused_.push_back(statement);
      note_unused(builder_, "'" + statement.substr(0, 40) + "' of MTL");
    }
  }

  const std::string& file_;
  SceneBuilder* builder_;
  std::vector<MtlMaterial>& materials_;
  std::vector<std::string> unused_;
  int unused_count_ = 0;
  bool is_begun_ = false;
};

}  // namespace

void read_mtl_file(const Bytes& bytes, const std::string& name, SceneBuilder* builder,
                   std::vector<MtlMaterial>* materials) {
  Reader reader(name, builder, materials);
  for_each_line(bytes, name.c_str(), [&](ObjLine* line) {
    reader.read(line);
    require_bytes(*builder, materials->size(), 2 * sizeof(MtlMaterial), "the materials");
  });
}

}  // namespace pocketray
