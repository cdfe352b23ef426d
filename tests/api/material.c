/* Materials: recoloured, textured anew and dimmed between frames, and what is refused. */
#include <math.h>
#include <stddef.h>

#include "api.h"

enum { kGreen = 2, kLamp = 3, kSphere = 5, kCornellMaterials = 6 };

static pocketray_options recolorable(void) {
  pocketray_options options = api_options();
  options.recolorable = 1;
  return options;
}

static pocketray_instance* open_file(const pocketray_options* options) {
  pocketray_source source = POCKETRAY_SOURCE_INIT;
  pocketray_instance* instance = NULL;
  source.bytes = api_file;
  source.byte_count = api_file_bytes;
  EXPECT_OK(pocketray_open(&source, options, api_memory[0], API_MEMORY, &instance));
  return instance;
}

static pocketray_material material_of(const pocketray_instance* instance, uint32_t index) {
  pocketray_material material = POCKETRAY_MATERIAL_INIT;
  EXPECT_OK(pocketray_get_material(instance, index, &material));
  return material;
}

static uint32_t material_count(const pocketray_instance* instance) {
  static pocketray_plan plan;
  plan.struct_size = sizeof plan;
  EXPECT_OK(pocketray_get_plan(instance, &plan));
  return plan.material_count;
}

/* Whether the file is the one with everything: its material 1 shows a texture of two, its material 2 has maps. */
static int has_everything(const pocketray_instance* instance) {
  return material_count(instance) == 3 && material_of(instance, 1).texture == 0;
}

static int same_material(const pocketray_material* a, const pocketray_material* b) {
  return memcmp(a, b, offsetof(pocketray_material, reserved)) == 0;
}

static void scale(float rgb[3], float share) {
  int c;
  for (c = 0; c < 3; ++c) rgb[c] *= share;
}

static void colours_change_and_return(void) {
  static api_picture before, changed;
  pocketray_options options = recolorable();
  pocketray_instance* instance = api_open("cornell", &options, 0);
  pocketray_material opened, material, read;
  uint32_t i;
  api_render(instance, 0, &before);
  for (i = 0; i < kCornellMaterials; ++i) {
    opened = material = material_of(instance, i);
    EXPECT_OK(pocketray_set_material(instance, i, &material));
    api_render(instance, 0, &changed);
    EXPECT(api_same(&before, &changed));
    if (i == kLamp) scale(material.emission, 0.5f);
    if (i == kSphere) scale(material.mirror, 0.5f);
    if (i != kLamp && i != kSphere) material.diffuse[2] = 0.6f;
    EXPECT_OK(pocketray_set_material(instance, i, &material));
    read = material_of(instance, i);
    EXPECT(same_material(&read, &material));
    api_render(instance, 0, &changed);
    EXPECT(api_distance(&before, &changed) > 1000);
    EXPECT_OK(pocketray_set_material(instance, i, &opened));
    api_render(instance, 0, &changed);
    EXPECT(api_same(&before, &changed));
  }
  pocketray_close(instance);
}

/* A lamp that is off stays a lamp; settings and other materials may change meanwhile. */
static void lamps_are_dimmed(void) {
  static api_picture lit, dim, off, again;
  pocketray_options options = recolorable();
  pocketray_instance* instance = api_open("cornell", &options, 0);
  pocketray_settings settings = POCKETRAY_SETTINGS_INIT;
  const pocketray_material lamp = material_of(instance, kLamp);
  pocketray_material changed = lamp;
  api_render(instance, 0, &lit);
  scale(changed.emission, 0.125f);
  EXPECT_OK(pocketray_set_material(instance, kLamp, &changed));
  api_render(instance, 0, &dim);
  scale(changed.emission, 0);
  EXPECT_OK(pocketray_set_material(instance, kLamp, &changed));
  api_render(instance, 0, &off);
  EXPECT(dim.pixel[40][20] != lit.pixel[40][20] && off.pixel[40][20] != dim.pixel[40][20]);
  EXPECT_OK(pocketray_set_number(&settings, "area-lights", 2));
  EXPECT_OK(pocketray_set_settings(instance, &settings));
  api_render(instance, 0, &again);
  EXPECT(api_same(&off, &again));
  EXPECT_OK(pocketray_set_number(&settings, "area-lights", 4));
  EXPECT_OK(pocketray_set_settings(instance, &settings));
  EXPECT_OK(pocketray_set_material(instance, kLamp, &lamp));
  api_render(instance, 0, &again);
  EXPECT(api_same(&lit, &again));
  pocketray_close(instance);
}

/* The file is used in place: its bytes stay as they are. */
static void textures_are_exchanged(void) {
  static unsigned char copy[1 << 20];
  static api_picture before, changed;
  pocketray_options options = recolorable();
  pocketray_camera camera = POCKETRAY_CAMERA_INIT;
  pocketray_instance* instance;
  pocketray_material opened, material;
  camera.eye[2] = 12; /* sees all of it */
  options.camera = &camera;
  instance = open_file(&options);
  if (!has_everything(instance)) {
    pocketray_close(instance);
    return;
  }
  opened = material = material_of(instance, 1);
  memcpy(copy, api_file, api_file_bytes);
  api_render(instance, 0, &before);
  material.texture = 1;
  EXPECT_OK(pocketray_set_material(instance, 1, &material));
  api_render(instance, 0, &changed);
  EXPECT(!api_same(&before, &changed));
  material.texture = POCKETRAY_NONE;
  EXPECT_OK(pocketray_set_material(instance, 1, &material));
  EXPECT(material_of(instance, 1).texture == POCKETRAY_NONE);
  EXPECT_OK(pocketray_set_material(instance, 1, &opened));
  api_render(instance, 0, &changed);
  EXPECT(api_same(&before, &changed));
  material = material_of(instance, 2); /* with maps: its colour texture may change */
  material.texture = 1;
  EXPECT_OK(pocketray_set_material(instance, 2, &material));
  EXPECT(memcmp(copy, api_file, api_file_bytes) == 0);
  pocketray_close(instance);
}

static void refused(pocketray_instance* instance, uint32_t index, const pocketray_material* given,
                    pocketray_result expected, const char* part) {
  const pocketray_material before = material_of(instance, index);
  const pocketray_result result = pocketray_set_material(instance, index, given);
  const char* message = pocketray_error_message();
  pocketray_material after;
  char text[160];
  snprintf(text, sizeof text, "result %d, expected %d with '%s'", (int)result, (int)expected, part);
  if (result != expected || !strstr(message, part) || strchr(message, '\n')) api_fail(__FILE__, __LINE__, text);
  after = material_of(instance, index);
  EXPECT(same_material(&before, &after));
}

static void numbers_out_of_range_are_refused(void) {
  static api_picture before, after;
  static const float odd[] = {NAN, INFINITY, -INFINITY, -0.01f, 1.01f, 2e18f};
  pocketray_options options = recolorable();
  pocketray_instance* instance = open_file(&options);
  const pocketray_material opened = material_of(instance, 1);
  pocketray_material m;
  int i, c;
  api_render(instance, 0, &before);
  for (i = 0; i < 6; ++i)
    for (c = 0; c < 3; ++c) {
#define WRONG(field)   \
  m = opened;          \
  m.field[c] = odd[i]; \
  refused(instance, 1, &m, POCKETRAY_ERROR_ARGUMENT, "materials[1]." #field)
      WRONG(diffuse);
      WRONG(specular);
      WRONG(mirror);
      WRONG(specular_tinted);
      WRONG(mirror_tinted);
      WRONG(transmission);
      if (odd[i] > 1 && odd[i] < 2) continue;
      WRONG(absorption);
      WRONG(emission);
#undef WRONG
    }
  m = opened;
  m.specular_tinted[1] = m.specular[1] * 0.9f + 0.1f;
  refused(instance, 1, &m, POCKETRAY_ERROR_ARGUMENT, "specular_tinted.y");
  m = opened;
  m.texture = POCKETRAY_NONE - 1;
  refused(instance, 1, &m, POCKETRAY_ERROR_ARGUMENT, "is texture 4294967294 of");
  m = opened;
  m.struct_size = sizeof m - 1;
  refused(instance, 1, &m, POCKETRAY_ERROR_ARGUMENT, "struct_size");
  m.struct_size = sizeof m + 1;
  refused(instance, 1, &m, POCKETRAY_ERROR_ARGUMENT, "struct_size");
  EXPECT(pocketray_get_material(instance, 1, &m) == POCKETRAY_ERROR_ARGUMENT);
  refused(instance, 1, NULL, POCKETRAY_ERROR_ARGUMENT, "null");
  EXPECT(pocketray_get_material(instance, 1, NULL) == POCKETRAY_ERROR_ARGUMENT);
  EXPECT(pocketray_set_material(instance, material_count(instance), &opened) == POCKETRAY_ERROR_ARGUMENT);
  EXPECT(strstr(pocketray_error_message(), "there is no material") != NULL);
  m = opened;
  EXPECT(pocketray_get_material(instance, POCKETRAY_NONE, &m) == POCKETRAY_ERROR_ARGUMENT);
  api_render(instance, 0, &after);
  EXPECT(api_same(&before, &after));
  pocketray_close(instance);
}

static void what_the_plan_lacks_is_refused(void) {
  static api_picture before, after;
  pocketray_options options = recolorable();
  pocketray_instance* instance = api_open("cube", &options, 0);
  pocketray_material m = material_of(instance, 1);
  api_render(instance, 0, &before);
  m.mirror[0] = 0.5f;
  refused(instance, 1, &m, POCKETRAY_ERROR_LIMIT, "calls for the effect mirror");
  m = material_of(instance, 1);
  m.transmission[1] = 0.5f;
  refused(instance, 1, &m, POCKETRAY_ERROR_LIMIT, "refraction");
  m = material_of(instance, 1);
  m.specular[1] = 0.5f;
  refused(instance, 1, &m, POCKETRAY_ERROR_LIMIT, "auto,specular");
  m = material_of(instance, 1);
  m.emission[2] = 1e-6f;
  refused(instance, 1, &m, POCKETRAY_ERROR_LIMIT, "emits nothing");
  m = material_of(instance, 1);
  m.texture = 0;
  refused(instance, 1, &m, POCKETRAY_ERROR_ARGUMENT, "texture 0 of 0");
  api_render(instance, 0, &after);
  EXPECT(api_same(&before, &after));
  pocketray_close(instance);

  options.effects = "auto,mirror";
  instance = api_open("cube", &options, 0);
  m = material_of(instance, 1);
  m.mirror[0] = 0.5f;
  EXPECT_OK(pocketray_set_material(instance, 1, &m));
  api_render(instance, 0, &after);
  EXPECT(!api_same(&before, &after));
  pocketray_close(instance);

  options = recolorable();
  options.effects = "auto,-mirror";
  instance = api_open("cube", &options, 0); /* it stays off */
  EXPECT_OK(pocketray_set_material(instance, 1, &m));
  api_render(instance, 0, &after);
  EXPECT(api_same(&before, &after));
  pocketray_close(instance);

  options = recolorable();
  instance = open_file(&options);
  if (has_everything(instance)) {
    m = material_of(instance, 2);
    m.diffuse[0] = 0.1f;
    refused(instance, 2, &m, POCKETRAY_ERROR_ARGUMENT, "a texture makes");
    m = material_of(instance, 2);
    m.mirror[0] = 0.1f;
    refused(instance, 2, &m, POCKETRAY_ERROR_ARGUMENT, "a texture makes");
  }
  pocketray_close(instance);
}

/* Bytes are planned and shown only where they are asked for. */
static void memory_is_reserved_when_asked_for(void) {
  pocketray_source source = api_builtin("cornell");
  pocketray_options options = api_options();
  pocketray_plan plain, planned;
  pocketray_instance* instance;
  pocketray_material m;
  size_t reserved = 0;
  uint32_t i;
  plain.struct_size = planned.struct_size = sizeof plain;
  EXPECT_OK(pocketray_make_plan(&source, &options, api_memory[1], API_MEMORY, &plain));
  instance = api_open("cornell", &options, 0);
  m = material_of(instance, kGreen);
  refused(instance, kGreen, &m, POCKETRAY_ERROR_LIMIT, "open with recolorable");
  pocketray_close(instance);
  options.recolorable = 1;
  options.accelerator = plain.accelerator; /* no smaller one */
  EXPECT_OK(pocketray_make_plan(&source, &options, api_memory[1], API_MEMORY, &planned));
  for (i = 0; i < plain.memory_part_count; ++i) EXPECT(strcmp(plain.memory_parts[i].name, "materials") != 0);
  for (i = 0; i < planned.memory_part_count; ++i)
    if (strcmp(planned.memory_parts[i].name, "materials") == 0) reserved = planned.memory_parts[i].bytes;
  EXPECT(reserved > 0 && plain.memory_part_count + 1 == planned.memory_part_count);
  EXPECT(plain.memory_bytes + reserved == planned.memory_bytes);
  EXPECT_OK(pocketray_open(&source, &options, api_memory[0], planned.memory_bytes, &instance));
  EXPECT_OK(pocketray_set_material(instance, kGreen, &m));
  pocketray_close(instance);
  EXPECT(pocketray_open(&source, &options, api_memory[0], plain.memory_bytes, &instance) == POCKETRAY_ERROR_MEMORY);
}

static void a_change_ends_a_frame_in_progress(void) {
  static api_picture picture;
  pocketray_options options = recolorable();
  pocketray_pixels pixels = api_pixels(&picture);
  pocketray_instance* instance = api_open("cornell", &options, 0);
  pocketray_material m = material_of(instance, kGreen);
  EXPECT_OK(pocketray_begin(instance, 0));
  EXPECT(pocketray_refine(instance, 0, &pixels) == POCKETRAY_UNFINISHED);
  EXPECT_OK(pocketray_set_material(instance, kGreen, &m));
  EXPECT(pocketray_refine(instance, 0, &pixels) == POCKETRAY_ERROR_ARGUMENT);
  pocketray_close(instance);
}

/* Coherence traces again what shows the material, and the pictures are those of an instance without it. */
static void coherence_follows_materials(void) {
  static api_picture whole, coherent;
  pocketray_options options = recolorable();
  pocketray_frame frame = POCKETRAY_FRAME_INIT;
  pocketray_instance* each[2];
  pocketray_material m;
  uint64_t traced = 0;
  int k, i;
  each[0] = api_open("cube", &options, 0);
  options.coherence = POCKETRAY_COHERENCE_ON;
  each[1] = api_open("cube", &options, 1);
  for (k = 0; k < 6; ++k) {
    for (i = 0; i < 2 && k > 0; ++i) {
      m = material_of(each[i], k < 4 ? 1 : 3);
      if (k < 4) m.diffuse[k - 1] = 0.9f - m.diffuse[k - 1];
      if (k == 4) scale(m.emission, 0.5f);
      EXPECT_OK(pocketray_set_material(each[i], k < 4 ? 1 : 3, &m));
    }
    api_render(each[0], 0, &whole);
    api_render(each[1], 0, &coherent);
    EXPECT(api_same(&whole, &coherent));
    EXPECT_OK(pocketray_get_frame(each[1], &frame));
    EXPECT((k > 0) == (frame.whole_because == NULL));
    if (k > 0 && k < 4) EXPECT(frame.pixels_traced > 0 && frame.pixels_traced < API_WIDTH * API_HEIGHT / 2);
    if (k == 4) EXPECT(frame.pixels_traced > traced);
    if (k == 5) EXPECT(frame.pixels_traced == 0);
    traced = frame.pixels_traced;
  }
  pocketray_close(each[0]);
  pocketray_close(each[1]);
}

/* Coherence is chosen by itself where materials may change, though nothing moves. */
static void coherence_is_chosen_for_materials(void) {
  static api_picture picture;
  pocketray_options options = recolorable();
  pocketray_frame frame = POCKETRAY_FRAME_INIT;
  pocketray_instance* instance;
  pocketray_material m;
  int k;
  options.coherence = POCKETRAY_COHERENCE_AUTO;
  instance = api_open("cube", &options, 0);
  for (k = 0; k < 3; ++k) api_render(instance, 0, &picture);
  EXPECT_OK(pocketray_get_frame(instance, &frame));
  EXPECT(frame.pixels_traced == 0);
  m = material_of(instance, 1);
  m.diffuse[0] = 0.9f - m.diffuse[0];
  EXPECT_OK(pocketray_set_material(instance, 1, &m));
  api_render(instance, 0, &picture);
  EXPECT_OK(pocketray_get_frame(instance, &frame));
  EXPECT(frame.pixels_traced > 0 && frame.pixels_traced < API_WIDTH * API_HEIGHT / 2);
  pocketray_close(instance);
}

const api_case api_material_cases[] = {
    {"colours_change_and_return", colours_change_and_return},
    {"lamps_are_dimmed", lamps_are_dimmed},
    {"textures_are_exchanged", textures_are_exchanged},
    {"numbers_out_of_range_are_refused", numbers_out_of_range_are_refused},
    {"what_the_plan_lacks_is_refused", what_the_plan_lacks_is_refused},
    {"memory_is_reserved_when_asked_for", memory_is_reserved_when_asked_for},
    {"a_change_ends_a_frame_in_progress", a_change_ends_a_frame_in_progress},
    {"coherence_follows_materials", coherence_follows_materials},
    {"coherence_is_chosen_for_materials", coherence_is_chosen_for_materials},
    {NULL, NULL},
};
