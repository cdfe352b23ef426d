/* Everything that may be changed in an open scene: settings, camera, lights, surroundings, nodes, exposure. */
#include "api.h"

static void settings_are_those_of_opening(void) {
  static api_picture first, changed, opened, again;
  pocketray_settings settings = POCKETRAY_SETTINGS_INIT, read = POCKETRAY_SETTINGS_INIT;
  pocketray_options options = api_options();
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  uint32_t i;
  api_render(instance, 0, &first);
  EXPECT_OK(pocketray_set_number(&settings, "samples", 4));
  EXPECT_OK(pocketray_set_number(&settings, "depth", 2));
  EXPECT_OK(pocketray_set_number(&settings, "area-lights", 3));
  EXPECT_OK(pocketray_set_number(&settings, "cut-off", 0));
  EXPECT_OK(pocketray_set_choice(&settings, "normals", "flat"));
  EXPECT_OK(pocketray_set_choice(&settings, "texture-filter", "nearest"));
  EXPECT_OK(pocketray_set_settings(instance, &settings));
  EXPECT_OK(pocketray_get_settings(instance, &read));
  for (i = 0; i < settings.count; ++i) {
    double value = -1;
    EXPECT_OK(pocketray_get_number(&read, settings.list[i].name, &value));
    EXPECT(value == settings.list[i].value);
  }
  api_render(instance, 0, &changed);
  EXPECT(!api_same(&first, &changed));
  EXPECT_OK(pocketray_set_number(&settings, "area-lights", 256));
  EXPECT(pocketray_set_settings(instance, &settings) == POCKETRAY_ERROR_LIMIT);
  EXPECT_OK(pocketray_set_number(&settings, "area-lights", 3));
  EXPECT(settings.count == 6);
  api_render(instance, 0, &again);
  EXPECT(api_same(&changed, &again));
  pocketray_close(instance);
  options.settings = &settings;
  instance = api_open("cornell", &options, 0);
  api_render(instance, 0, &opened);
  EXPECT(api_same(&changed, &opened));
  pocketray_close(instance);
}

/* Each has a name, a default and a value that the library takes back; those not in a list stay as they are. */
static void every_setting_has_a_name(void) {
  pocketray_settings none = POCKETRAY_SETTINGS_INIT, read, one = POCKETRAY_SETTINGS_INIT;
  pocketray_instance* instance = api_open("cube", NULL, 0);
  uint32_t count = 0, choices = 0;
  double value, initial;
  EXPECT_OK(pocketray_set_number(&one, "samples", 2));
  EXPECT_OK(pocketray_set_settings(instance, &one));
  EXPECT_OK(pocketray_set_settings(instance, &none));
  read = none;
  EXPECT_OK(pocketray_get_settings(instance, &read));
  for (; pocketray_setting_name(count); ++count) {
    const char* name = pocketray_setting_name(count);
    EXPECT_OK(pocketray_get_number(&none, name, &initial));
    EXPECT_OK(pocketray_get_number(&read, name, &value));
    EXPECT(value == (strcmp(name, "samples") == 0 ? 2 : initial));
    EXPECT_OK(pocketray_set_number(&read, name, initial));
    if (!pocketray_choice_name(name, 0)) continue;
    ++choices;
    EXPECT_OK(pocketray_set_choice(&read, name, pocketray_choice_name(name, 0)));
    EXPECT_OK(pocketray_get_number(&read, name, &value));
    EXPECT(value == 0 && !pocketray_choice_name(name, 1000));
  }
  EXPECT(count == read.count && count > 10 && choices > 4 && choices < count);
  EXPECT(!pocketray_setting_name(count) && !pocketray_choice_name("samples", 0) && !pocketray_choice_name(NULL, 0));
  pocketray_close(instance);
}

/* A level of quality is a list of settings, which later calls replace one by one. */
static void quality_is_a_list_of_settings(void) {
  static api_picture usual, medium, best;
  pocketray_settings settings = POCKETRAY_SETTINGS_INIT;
  pocketray_options options = api_options();
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  api_render(instance, 0, &usual);
  pocketray_close(instance);
  EXPECT_OK(pocketray_set_quality(&settings, "best"));
  EXPECT_OK(pocketray_set_quality(&settings, "medium"));
  options.settings = &settings;
  instance = api_open("cornell", &options, 0);
  api_render(instance, 0, &medium);
  pocketray_close(instance);
  EXPECT(memcmp(&medium, &usual, sizeof usual) == 0);
  double samples, directions;
  EXPECT_OK(pocketray_set_quality(&settings, "best"));
  EXPECT_OK(pocketray_set_number(&settings, "samples", 2));
  EXPECT_OK(pocketray_get_number(&settings, "samples", &samples));
  EXPECT_OK(pocketray_get_number(&settings, "environment-shadows", &directions));
  EXPECT(samples == 2 && directions > 32);
  instance = api_open("cornell", &options, 0);
  api_render(instance, 0, &best);
  EXPECT(memcmp(&best, &usual, sizeof usual) != 0);
  pocketray_close(instance);
}

/* A setting that only the list of names has: more virtual lights give another picture. */
static void instant_radiosity_is_set_by_name(void) {
  static api_picture ambient, few, many;
  pocketray_settings settings = POCKETRAY_SETTINGS_INIT;
  pocketray_options options = api_options();
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  api_render(instance, 0, &ambient);
  pocketray_close(instance);
  EXPECT_OK(pocketray_set_choice(&settings, "indirect", "instant-radiosity"));
  EXPECT_OK(pocketray_set_number(&settings, "virtual-lights", 128));
  options.settings = &settings;
  instance = api_open("cornell", &options, 0);
  api_render(instance, 0, &many);
  EXPECT_OK(pocketray_set_number(&settings, "virtual-lights", 16));
  EXPECT_OK(pocketray_set_settings(instance, &settings));
  api_render(instance, 0, &few);
  EXPECT(!api_same(&ambient, &many) && !api_same(&few, &many));
  pocketray_close(instance);
}

static void cameras_are_set_and_read(void) {
  static api_picture first, turned, opened, again;
  pocketray_camera camera = POCKETRAY_CAMERA_INIT;
  pocketray_options options = api_options();
  pocketray_instance* instance = api_open("statue", NULL, 0);
  api_render(instance, 0, &first);
  EXPECT_OK(pocketray_get_camera(instance, &camera));
  EXPECT_OK(pocketray_set_camera(instance, &camera));
  api_render(instance, 0, &again);
  EXPECT(api_same(&first, &again));
  camera.eye[0] += 0.5f;
  camera.vertical_fov_degrees *= 1.5;
  EXPECT_OK(pocketray_set_camera(instance, &camera));
  api_render(instance, 0, &turned);
  EXPECT(!api_same(&first, &turned));
  EXPECT_OK(pocketray_use_scene_camera(instance, 0));
  api_render(instance, 0, &again);
  EXPECT(api_same(&first, &again));
  pocketray_close(instance);
  options.camera = &camera;
  instance = api_open("statue", &options, 0);
  api_render(instance, 0, &opened);
  EXPECT(api_same(&turned, &opened));
  camera.projection = POCKETRAY_ORTHOGRAPHIC;
  camera.vertical_extent = 2;
  EXPECT_OK(pocketray_set_camera(instance, &camera));
  EXPECT_OK(pocketray_get_camera(instance, &camera));
  EXPECT(camera.projection == POCKETRAY_ORTHOGRAPHIC && camera.vertical_extent == 2);
  api_render(instance, 0, &again);
  EXPECT(!api_same(&turned, &again));
  pocketray_close(instance);
}

static int effect_is_on(const pocketray_instance* instance, const char* name) {
  static pocketray_plan plan;
  uint32_t i;
  plan.struct_size = sizeof plan;
  EXPECT_OK(pocketray_get_plan(instance, &plan));
  for (i = 0; i < plan.effect_count; ++i)
    if (strcmp(plan.effects[i].name, name) == 0) return plan.effects[i].on;
  return -1;
}

/* One scene is static, the other moves; room for lights changes no pixel. */
static void expect_lights_change(const char* scene) {
  static api_picture plain, first, added, dark, again;
  pocketray_light lights[9], torch = POCKETRAY_LIGHT_INIT;
  pocketray_camera camera = POCKETRAY_CAMERA_INIT;
  pocketray_options options = api_options();
  uint32_t count = 99;
  float far;
  int was_on, i;
  pocketray_instance* instance = api_open(scene, &options, 0);
  api_render(instance, 1, &plain);
  EXPECT_OK(pocketray_get_lights(instance, NULL, 0, &count));
  EXPECT(pocketray_set_lights(instance, lights, 1) == POCKETRAY_ERROR_LIMIT);
  pocketray_close(instance);
  EXPECT(count <= 8);
  torch.kind = POCKETRAY_SPOT_LIGHT;
  options.light_count_max = 9;
  instance = api_open(scene, &options, 0);
  api_render(instance, 1, &first);
  EXPECT(api_same(&plain, &first));
  EXPECT_OK(pocketray_get_lights(instance, lights, 9, &count));
  was_on = effect_is_on(instance, "spot-light");
  EXPECT_OK(pocketray_get_camera(instance, &camera));
  lights[count] = torch;
  memcpy(lights[count].position, camera.eye, sizeof camera.eye);
  far = camera.target[2] - camera.eye[2]; /* these cameras look along z */
  lights[count].direction[1] = 0, lights[count].direction[2] = far > 0 ? 1.0f : -1.0f;
  for (i = 0; i < 3; ++i) lights[count].intensity[i] = far * far;
  EXPECT_OK(pocketray_set_lights(instance, lights, count + 1));
  EXPECT(effect_is_on(instance, "spot-light"));
  api_render(instance, 1, &added);
  EXPECT(!api_same(&first, &added));
  EXPECT_OK(pocketray_set_lights(instance, lights, count));
  EXPECT(effect_is_on(instance, "spot-light") == was_on);
  api_render(instance, 1, &again);
  EXPECT(api_same(&first, &again));
  if (count) {
    lights[count - 1].intensity[0] += 40;
    EXPECT_OK(pocketray_set_lights(instance, lights, count));
    api_render(instance, 1, &again);
    EXPECT(!api_same(&first, &again));
    EXPECT_OK(pocketray_set_lights(instance, NULL, 0));
    api_render(instance, 1, &dark);
    EXPECT(!api_same(&first, &dark));
  }
  pocketray_close(instance);
}

static void lights_come_change_and_go(void) {
  expect_lights_change("cornell"); /* an area light alone */
  expect_lights_change("statue");  /* lights that stand still */
  expect_lights_change("seesaw");  /* lights, and an animation */
}

static void lights_follow_their_node(void) {
  static api_picture before, after;
  const float aside[12] = {1, 0, 0, 0.5f, 0, 1, 0, 0, 0, 0, 1, 0};
  pocketray_light lights[8];
  pocketray_options options = api_options();
  pocketray_instance* instance;
  uint32_t count, i;
  options.light_count_max = 8;
  options.movable = 1;
  instance = api_open("seesaw", &options, 0);
  EXPECT_OK(pocketray_get_lights(instance, lights, 8, &count));
  for (i = 0; i < count; ++i) lights[i].node = 0;
  EXPECT_OK(pocketray_set_lights(instance, lights, count));
  EXPECT_OK(pocketray_set_node(instance, 0, aside));
  api_render(instance, 0, &before);
  for (i = 0; i < count; ++i) lights[i].node = POCKETRAY_NONE, lights[i].position[0] += 0.5f;
  EXPECT_OK(pocketray_set_lights(instance, lights, count));
  api_render(instance, 0, &after);
  EXPECT(api_same(&before, &after));
  pocketray_close(instance);
}

static void surroundings_are_set_and_read(void) {
  static api_picture first, changed, again;
  const float sky[3] = {0.25f, 0.5f, 1}, none[3] = {0, 0, 0};
  float background[3], ambient[3], read[3], read_ambient[3];
  pocketray_instance* instance = api_open("statue", NULL, 0);
  api_render(instance, 0, &first);
  EXPECT_OK(pocketray_get_surroundings(instance, background, ambient));
  EXPECT_OK(pocketray_set_surroundings(instance, sky, none));
  EXPECT(!effect_is_on(instance, "ambient"));
  EXPECT_OK(pocketray_get_surroundings(instance, read, read_ambient));
  EXPECT(memcmp(read, sky, sizeof sky) == 0 && memcmp(read_ambient, none, sizeof none) == 0);
  api_render(instance, 0, &changed);
  EXPECT(!api_same(&first, &changed));
  EXPECT_OK(pocketray_set_surroundings(instance, background, ambient));
  api_render(instance, 0, &again);
  EXPECT(api_same(&first, &again));
  pocketray_close(instance);
}

static void nodes_take_transforms_for_their_animation(void) {
  static api_picture plain, first, placed, again, later;
  const float aside[12] = {1, 0, 0, 0.25f, 0, 1, 0, 0.5f, 0, 0, 1, 0};
  pocketray_options options = api_options();
  pocketray_node node = POCKETRAY_NODE_INIT;
  pocketray_plan plan;
  pocketray_instance* instance = api_open("seesaw", NULL, 0);
  uint32_t i;
  int k;
  api_render(instance, 1, &plain);
  EXPECT(pocketray_set_node(instance, 0, aside) == POCKETRAY_ERROR_LIMIT);
  pocketray_close(instance);
  options.movable = 1;
  instance = api_open("seesaw", &options, 0);
  api_render(instance, 1, &first);
  EXPECT(api_same(&plain, &first));
  plan.struct_size = sizeof plan;
  EXPECT_OK(pocketray_get_plan(instance, &plan));
  EXPECT(plan.node_count > 0);
  /* If controlled by the animation, they stay at any time. */
  for (i = 0; i < plan.node_count; ++i) {
    EXPECT_OK(pocketray_get_node(instance, i, &node));
    EXPECT(!node.overridden && (node.parent == POCKETRAY_NONE || node.parent < i));
    EXPECT_OK(pocketray_set_node(instance, i, node.to_parent));
  }
  api_render(instance, 2, &later);
  EXPECT(api_same(&first, &later));
  for (i = 0; i < plan.node_count; ++i) {
    EXPECT_OK(pocketray_set_node(instance, i, aside));
    EXPECT_OK(pocketray_get_node(instance, i, &node));
    EXPECT(node.overridden && memcmp(node.to_parent, aside, sizeof aside) == 0);
    api_render(instance, 1, &placed);
    EXPECT_OK(pocketray_get_node(instance, i, &node));
    for (k = 0; k < 12 && node.parent == POCKETRAY_NONE; ++k) EXPECT(node.to_world[k] == aside[k]);
  }
  EXPECT(!api_same(&first, &placed));
  for (i = 0; i < plan.node_count; ++i) EXPECT_OK(pocketray_set_node(instance, i, NULL));
  api_render(instance, 1, &again);
  EXPECT(api_same(&first, &again));
  pocketray_close(instance);
}

static void render_linear(pocketray_instance* instance, float* radiance) {
  pocketray_pixels pixels = POCKETRAY_PIXELS_INIT;
  pixels.data = radiance;
  pixels.line_bytes = API_WIDTH * 3 * sizeof radiance[0];
  pixels.byte_count = pixels.line_bytes * API_HEIGHT;
  pixels.format = POCKETRAY_RGB_FLOAT;
  EXPECT_OK(pocketray_render(instance, 0, &pixels));
}

/* A static scene as one part: unmoved it is the same to the bit; moved with its camera it looks alike. */
static void parts_make_a_still_scene_movable(void) {
  static api_picture still, first, moved, followed, again;
  static float still_radiance[API_HEIGHT * API_WIDTH * 3], radiance[API_HEIGHT * API_WIDTH * 3];
  const float aside[12] = {1, 0, 0, 0.25f, 0, 1, 0, 0.5f, 0, 0, 1, -0.125f};
  const char* scenes[] = {"cube", "cornell"};
  pocketray_part part = {0, 0, 0};
  pocketray_camera camera = POCKETRAY_CAMERA_INIT;
  pocketray_plan plan;
  int i, axis, accelerator;
  for (i = 0; i < 4; ++i) {
    pocketray_options options = api_options();
    pocketray_instance* instance;
    accelerator = i / 2;
    if (accelerator) options.accelerator = "compact";
    instance = api_open(scenes[i % 2], &options, 0);
    plan.struct_size = sizeof plan;
    EXPECT_OK(pocketray_get_plan(instance, &plan));
    EXPECT(pocketray_set_node(instance, 0, aside) == POCKETRAY_ERROR_ARGUMENT);
    api_render(instance, 0, &still);
    render_linear(instance, still_radiance);
    pocketray_close(instance);
    part.vertex_count = plan.vertex_count;
    options.parts = &part;
    options.part_count = 1;
    instance = api_open(scenes[i % 2], &options, 0);
    api_render(instance, 0, &first);
    EXPECT(api_same(&still, &first));
    render_linear(instance, radiance);
    EXPECT(memcmp(radiance, still_radiance, sizeof radiance) == 0);
    EXPECT_OK(pocketray_get_camera(instance, &camera));
    EXPECT_OK(pocketray_set_node(instance, 0, aside));
    api_render(instance, 0, &moved);
    EXPECT(api_distance(&first, &moved) > API_WIDTH * API_HEIGHT);
    for (axis = 0; axis < 3; ++axis)
      camera.eye[axis] += aside[4 * axis + 3], camera.target[axis] += aside[4 * axis + 3];
    EXPECT_OK(pocketray_set_camera(instance, &camera));
    api_render(instance, 0, &followed);
    EXPECT(api_distance(&first, &followed) < API_WIDTH * API_HEIGHT / 2);
    EXPECT_OK(pocketray_use_scene_camera(instance, 0));
    EXPECT_OK(pocketray_set_node(instance, 0, NULL));
    api_render(instance, 0, &again);
    EXPECT(api_same(&still, &again));
    pocketray_close(instance);
  }
}

/* Parts are given by vertices or by a material, in any order, and move independently. */
static void parts_move_by_themselves(void) {
  static api_picture still, one, other, both;
  const float up[12] = {1, 0, 0, 0, 0, 1, 0, 0.1f, 0, 0, 1, 0}, flat[12] = {0};
  pocketray_part parts[2] = {{4, 4, 0}, {0, 4, 0}};
  pocketray_options options = api_options();
  pocketray_instance* instance;
  pocketray_node node = POCKETRAY_NODE_INIT;
  options.parts = parts;
  options.part_count = 2;
  instance = api_open("cube", &options, 0);
  api_render(instance, 0, &still);
  EXPECT_OK(pocketray_set_node(instance, 0, up));
  api_render(instance, 0, &one);
  EXPECT_OK(pocketray_get_node(instance, 0, &node));
  EXPECT(node.parent == POCKETRAY_NONE && node.overridden && node.to_world[7] == up[7]);
  EXPECT_OK(pocketray_get_node(instance, 1, &node));
  EXPECT(!node.overridden && node.to_world[7] == 0);
  EXPECT_OK(pocketray_set_node(instance, 1, up));
  api_render(instance, 0, &both);
  EXPECT_OK(pocketray_set_node(instance, 0, NULL));
  api_render(instance, 0, &other);
  EXPECT(!api_same(&still, &one) && !api_same(&still, &other) && !api_same(&one, &other) && !api_same(&one, &both));
  pocketray_close(instance);

  parts[0].vertex_begin = 0, parts[0].vertex_count = 0, parts[0].material = 0; /* all of it is of one material */
  options.part_count = 1;
  instance = api_open("furnace", &options, 0);
  api_render(instance, 0, &still);
  EXPECT_OK(pocketray_set_node(instance, 0, flat));
  api_render(instance, 0, &one);
  EXPECT(!api_same(&still, &one));
  pocketray_close(instance);
}

static void exposure_is_set_and_measured(void) {
  static api_picture first, brighter, again;
  pocketray_options options = api_options();
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  float before = 0, after = 0, measured = 0, opened = 0;
  api_render(instance, 0, &first);
  EXPECT_OK(pocketray_get_exposure(instance, &before));
  EXPECT_OK(pocketray_set_exposure(instance, before * 2));
  EXPECT_OK(pocketray_get_exposure(instance, &after));
  EXPECT(before > 0 && after == before * 2);
  api_render(instance, 0, &brighter);
  EXPECT((brighter.pixel[30][45] & 255) > (first.pixel[30][45] & 255));
  EXPECT_OK(pocketray_set_tone(instance, POCKETRAY_TONE_FILM));
  api_render(instance, 0, &again);
  EXPECT(!api_same(&brighter, &again)); /* the lamp is no longer white */
  EXPECT_OK(pocketray_set_tone(instance, POCKETRAY_TONE_CLIP));
  api_render(instance, 0, &again);
  EXPECT(api_same(&brighter, &again));
  EXPECT_OK(pocketray_measure_exposure(instance, 0, &measured));
  EXPECT_OK(pocketray_get_exposure(instance, &after));
  EXPECT(measured > 0 && measured != before && after == measured);
  api_render(instance, 0, &again);
  EXPECT(!api_same(&brighter, &again));
  pocketray_close(instance);
  options.measure_exposure = 1;
  instance = api_open("cornell", &options, 0);
  EXPECT_OK(pocketray_get_exposure(instance, &opened));
  EXPECT(opened > measured * 0.99f && opened < measured * 1.01f); /* cut off at another exposure */
  pocketray_close(instance);
}

const api_case api_scene_cases[] = {
    {"settings_are_those_of_opening", settings_are_those_of_opening},
    {"every_setting_has_a_name", every_setting_has_a_name},
    {"quality_is_a_list_of_settings", quality_is_a_list_of_settings},
    {"instant_radiosity_is_set_by_name", instant_radiosity_is_set_by_name},
    {"cameras_are_set_and_read", cameras_are_set_and_read},
    {"lights_come_change_and_go", lights_come_change_and_go},
    {"lights_follow_their_node", lights_follow_their_node},
    {"surroundings_are_set_and_read", surroundings_are_set_and_read},
    {"nodes_take_transforms_for_their_animation", nodes_take_transforms_for_their_animation},
    {"parts_make_a_still_scene_movable", parts_make_a_still_scene_movable},
    {"parts_move_by_themselves", parts_move_by_themselves},
    {"exposure_is_set_and_measured", exposure_is_set_and_measured},
    {NULL, NULL}};
