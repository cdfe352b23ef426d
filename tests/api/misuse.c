/* Every function with invalid arguments: an error code and a message for each, and no crash. The messages are for
 * people who never saw the command line. */
#include <limits.h>
#include <math.h>

#include "api.h"

static void refused(const char* what, pocketray_result result, pocketray_result expected, const char* part) {
  const char* message = pocketray_error_message();
  int fine = result == expected && strstr(message, part) && !strstr(message, "--") && !strchr(message, '\n');
  char text[200];
  if (fine) return;
  snprintf(text, sizeof text, "%s: result %d, expected %d with '%s'", what, (int)result, (int)expected, part);
  api_fail(__FILE__, __LINE__, text);
}
static void wrong(const char* what, pocketray_result result, const char* part) {
  refused(what, result, POCKETRAY_ERROR_ARGUMENT, part);
}

static const float odd_floats[] = {NAN, INFINITY, -INFINITY, 2e18f, -2e18f};
static const double odd_times[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, 2e9, -2e9, 1e300};
enum { kOddFloats = 5, kOddTimes = 6 };

/* Both ways of reading a source and options. */
static void wrong_open(const char* what, const pocketray_source* source, const pocketray_options* options,
                       const char* part) {
  static pocketray_plan plan;
  pocketray_instance* instance = (pocketray_instance*)api_memory[0];
  wrong(what, pocketray_open(source, options, api_memory[0], API_MEMORY, &instance), part);
  EXPECT(instance == NULL);
  plan.struct_size = sizeof plan;
  wrong(what, pocketray_make_plan(source, options, api_memory[1], API_MEMORY, &plan), part);
}

static void sources_that_cannot_be_read(void) {
  pocketray_options options = api_options();
  pocketray_source source = api_builtin("nothing");
  wrong_open("null source", NULL, &options, "source is a null pointer");
  wrong_open("unknown scene", &source, &options, "no built-in scene 'nothing'");
  source.builtin = NULL;
  wrong_open("no bytes", &source, &options, "bytes are a null pointer");
  source = api_builtin("cube");
  source.struct_size = 0;
  wrong_open("no size", &source, &options, "struct_size");
  source.struct_size = sizeof source + 1;
  wrong_open("too new", &source, &options, "struct_size");
  source.struct_size = (size_t)-1;
  wrong_open("huge", &source, &options, "struct_size");
  source = api_builtin("cube");
  source.copy = 2;
  wrong_open("copy", &source, &options, "copy is 2");
}

static void options_out_of_range(void) {
  const pocketray_source source = api_builtin("cube");
  const pocketray_options usual = api_options();
  pocketray_options o;
  wrong_open("null options", &source, NULL, "options is a null pointer");
#define WRONG(change, part) \
  o = usual;                \
  change;                   \
  wrong_open(#change, &source, &o, part)
  WRONG(o.struct_size = 0, "struct_size");
  WRONG(o.width = 0, "width is 0");
  WRONG(o.width = -1, "width is -1");
  WRONG(o.width = INT_MIN, "width");
  WRONG(o.height = 8193, "height is 8193");
  WRONG(o.threads = 0, "threads is 0");
  WRONG(o.threads = 65, "threads is 65");
  WRONG(o.coherence = 3, "coherence");
  WRONG(o.coherence = -1, "coherence");
  WRONG(o.coherence_table = 0, "coherence_table is 0");
  WRONG(o.coherence_table = 1025, "coherence_table is 1025");
  WRONG(o.recolorable = 2, "recolorable is 2");
  WRONG(o.recolorable = -1, "recolorable is -1");
  WRONG(o.measure_exposure = -1, "measure_exposure");
  WRONG(o.movable = 7, "movable");
  WRONG(o.camera_index = 1, "no camera 1");
  WRONG(o.camera_index = POCKETRAY_NONE, "camera");
  WRONG(o.light_count_max = POCKETRAY_NONE, "light_count_max");
  WRONG(o.effects = "auto,-nothing", "effects");
  WRONG(o.effects = "", "effects");
  WRONG(o.accelerator = "grate", "no accelerator 'grate'");
  WRONG(o.part_count = 1, "parts is a null pointer");
  WRONG(o.part_count = POCKETRAY_NONE, "parts");
#undef WRONG
}

static void parts_that_do_not_fit(void) {
  const pocketray_source cube = api_builtin("cube"), seesaw = api_builtin("seesaw");
  pocketray_part parts[3] = {{0, 4, 0}, {4, 4, 0}, {8, 4, 0}};
  pocketray_options options = api_options();
  options.parts = parts;
  options.part_count = 3;
  wrong_open("animated", &seesaw, &options, "animated");
  parts[2].vertex_begin = 9;
  wrong_open("beyond", &cube, &options, "parts[2] extends beyond");
  parts[2].vertex_begin = 0xFFFFFFFFu;
  wrong_open("far beyond", &cube, &options, "parts[2] extends beyond");
  parts[2].vertex_begin = 7;
  wrong_open("overlap", &cube, &options, "share vertices");
  parts[2].vertex_begin = 8;
  parts[0].vertex_begin = 5; /* the first of which starts after the second */
  wrong_open("overlap", &cube, &options, "share vertices");
  parts[0].vertex_begin = 0;
  parts[2].vertex_begin = 0;
  parts[2].vertex_count = 0;
  parts[2].material = 77;
  wrong_open("no such material", &cube, &options, "material 77");
  parts[2].material = 0;
  wrong_open("shared vertices", &cube, &options, "has another material");
}

static void memory_that_is_too_small(void) {
  const size_t sizes[] = {0, 1, 63, 64, 1000, 20000, 60000};
  pocketray_source source = api_builtin("cube");
  pocketray_options options = api_options();
  pocketray_instance* instance = NULL;
  pocketray_plan plan;
  int i;
  for (i = 0; i < 7; ++i)
    refused("little", pocketray_open(&source, &options, api_memory[0], sizes[i], &instance), POCKETRAY_ERROR_MEMORY,
            "memory");
  wrong("null memory", pocketray_open(&source, &options, NULL, API_MEMORY, &instance), "memory");
  wrong("null instance", pocketray_open(&source, &options, api_memory[0], API_MEMORY, NULL), "address");
  wrong("null plan", pocketray_make_plan(&source, &options, api_memory[0], API_MEMORY, NULL), "plan");
  plan.struct_size = 1;
  wrong("short plan", pocketray_make_plan(&source, &options, api_memory[0], API_MEMORY, &plan), "struct_size");
  source.builtin = NULL;
  source.bytes = api_memory[1];
  source.byte_count = (size_t)-1;
  source.copy = 1;
  refused("huge file", pocketray_open(&source, &options, api_memory[0], API_MEMORY, &instance), POCKETRAY_ERROR_MEMORY,
          "memory");
}

static void no_instance(void) {
  static api_picture picture;
  float rgb[12] = {0};
  uint64_t costs[1];
  uint32_t count;
  pocketray_plan plan;
  pocketray_settings settings = POCKETRAY_SETTINGS_INIT;
  pocketray_camera camera = POCKETRAY_CAMERA_INIT;
  pocketray_light light = POCKETRAY_LIGHT_INIT;
  pocketray_node node = POCKETRAY_NODE_INIT;
  pocketray_material material = POCKETRAY_MATERIAL_INIT;
  pocketray_frame frame = POCKETRAY_FRAME_INIT;
  pocketray_pixels pixels = api_pixels(&picture);
  const char* part = "instance";
  plan.struct_size = sizeof plan;
  pocketray_close(NULL);
  pocketray_set_stop(NULL, 1);
  wrong("get_plan", pocketray_get_plan(NULL, &plan), part);
  wrong("get_settings", pocketray_get_settings(NULL, &settings), part);
  wrong("set_settings", pocketray_set_settings(NULL, &settings), part);
  wrong("get_camera", pocketray_get_camera(NULL, &camera), part);
  wrong("set_camera", pocketray_set_camera(NULL, &camera), part);
  wrong("use_scene_camera", pocketray_use_scene_camera(NULL, 0), part);
  wrong("get_lights", pocketray_get_lights(NULL, &light, 1, &count), part);
  wrong("set_lights", pocketray_set_lights(NULL, &light, 1), part);
  wrong("set_lights", pocketray_set_lights(NULL, NULL, 0), part);
  wrong("get_surroundings", pocketray_get_surroundings(NULL, rgb, rgb), part);
  wrong("set_surroundings", pocketray_set_surroundings(NULL, rgb, rgb), part);
  wrong("get_node", pocketray_get_node(NULL, 0, &node), part);
  wrong("set_node", pocketray_set_node(NULL, 0, rgb), part);
  wrong("get_material", pocketray_get_material(NULL, 0, &material), part);
  wrong("set_material", pocketray_set_material(NULL, 0, &material), part);
  wrong("get_exposure", pocketray_get_exposure(NULL, rgb), part);
  wrong("set_exposure", pocketray_set_exposure(NULL, 1), part);
  wrong("measure_exposure", pocketray_measure_exposure(NULL, 0, rgb), part);
  wrong("set_tone", pocketray_set_tone(NULL, POCKETRAY_TONE_FILM), part);
  wrong("render", pocketray_render(NULL, 0, &pixels), part);
  wrong("begin", pocketray_begin(NULL, 0), part);
  wrong("refine", pocketray_refine(NULL, 0, &pixels), part);
  wrong("set_progress", pocketray_set_progress(NULL, NULL, NULL), part);
  wrong("get_frame", pocketray_get_frame(NULL, &frame), part);
  wrong("get_row_costs", pocketray_get_row_costs(NULL, costs, 1), part);
}

static void null_results_and_short_ones(pocketray_instance* instance) {
  float rgb[3] = {0};
  uint64_t costs[API_HEIGHT];
  uint32_t count;
  pocketray_plan plan;
  pocketray_settings settings = POCKETRAY_SETTINGS_INIT;
  pocketray_camera camera = POCKETRAY_CAMERA_INIT;
  pocketray_node node = POCKETRAY_NODE_INIT;
  pocketray_frame frame = POCKETRAY_FRAME_INIT;
  wrong("plan", pocketray_get_plan(instance, NULL), "null");
  wrong("settings", pocketray_get_settings(instance, NULL), "null");
  wrong("settings", pocketray_set_settings(instance, NULL), "null");
  wrong("camera", pocketray_get_camera(instance, NULL), "null");
  wrong("camera", pocketray_set_camera(instance, NULL), "null");
  wrong("lights", pocketray_get_lights(instance, NULL, 1, &count), "null");
  wrong("lights", pocketray_get_lights(instance, NULL, 0, NULL), "null");
  wrong("lights", pocketray_set_lights(instance, NULL, 1), "null");
  wrong("background", pocketray_get_surroundings(instance, NULL, rgb), "null");
  wrong("ambient", pocketray_get_surroundings(instance, rgb, NULL), "null");
  wrong("background", pocketray_set_surroundings(instance, NULL, rgb), "null");
  wrong("ambient", pocketray_set_surroundings(instance, rgb, NULL), "null");
  wrong("node", pocketray_get_node(instance, 0, NULL), "null");
  wrong("exposure", pocketray_get_exposure(instance, NULL), "null");
  wrong("frame", pocketray_get_frame(instance, NULL), "null");
  wrong("costs", pocketray_get_row_costs(instance, NULL, API_HEIGHT), "null");
  wrong("costs", pocketray_get_row_costs(instance, costs, API_HEIGHT - 1), "row_count");
  wrong("costs", pocketray_get_row_costs(instance, costs, API_HEIGHT + 1), "row_count");
  plan.struct_size = settings.struct_size = camera.struct_size = node.struct_size = frame.struct_size = 3;
  wrong("plan", pocketray_get_plan(instance, &plan), "struct_size");
  wrong("settings", pocketray_get_settings(instance, &settings), "struct_size");
  wrong("settings", pocketray_set_settings(instance, &settings), "struct_size");
  wrong("camera", pocketray_get_camera(instance, &camera), "struct_size");
  wrong("camera", pocketray_set_camera(instance, &camera), "struct_size");
  wrong("node", pocketray_get_node(instance, 0, &node), "struct_size");
  wrong("frame", pocketray_get_frame(instance, &frame), "struct_size");
}

/* Of what the library sets, and of lists that a caller wrote. */
static void odd_settings(pocketray_instance* instance) {
  pocketray_settings s = POCKETRAY_SETTINGS_INIT;
  pocketray_options options = api_options();
  pocketray_source source = api_builtin("cube");
  double value;
  wrong("samples", pocketray_set_number(&s, "samples", 0), "samples per pixel is 0");
  wrong("samples", pocketray_set_number(&s, "samples", -3), "samples per pixel is -3");
  wrong("samples", pocketray_set_number(&s, "samples", 1.5), "whole number");
  wrong("depth", pocketray_set_number(&s, "depth", 17), "depth");
  wrong("points", pocketray_set_number(&s, "area-lights", 257), "area light is 257");
  wrong("cut-off", pocketray_set_number(&s, "cut-off", (double)NAN), "cut-off");
  wrong("cut-off", pocketray_set_number(&s, "cut-off", -1), "cut-off");
  wrong("filter", pocketray_set_number(&s, "texture-filter", 5), "texture-filter is 5");
  wrong("normals", pocketray_set_choice(&s, "normals", "round"), "scene or flat");
  wrong("number", pocketray_set_choice(&s, "samples", "four"), "pocketray_set_number");
  wrong("name", pocketray_set_number(&s, "sample", 1), "no setting 'sample'");
  wrong("name", pocketray_set_choice(&s, NULL, "flat"), "null");
  wrong("choice", pocketray_set_choice(&s, "normals", NULL), "null");
  wrong("quality", pocketray_set_quality(&s, "superb"), "medium");
  wrong("quality", pocketray_set_quality(&s, NULL), "medium");
  wrong("value", pocketray_get_number(&s, "samples", NULL), "null");
  wrong("settings", pocketray_set_number(NULL, "samples", 1), "null");
  EXPECT(s.count == 0 && s.list[0].name == NULL);
  s.count = 1;
  wrong("no name", pocketray_set_settings(instance, &s), "null");
  s.list[0].name = "samples", s.list[0].value = 99;
  wrong("value", pocketray_set_settings(instance, &s), "samples per pixel is 99");
  options.settings = &s;
  wrong_open("value", &source, &options, "samples per pixel is 99");
  s.list[0].name = "bounces";
  wrong("name", pocketray_set_settings(instance, &s), "no setting 'bounces'");
  s.count = POCKETRAY_SETTINGS_MAX;
  wrong("full", pocketray_set_number(&s, "samples", 1), "POCKETRAY_SETTINGS_INIT");
  s.count = POCKETRAY_SETTINGS_MAX + 1;
  wrong("count", pocketray_set_settings(instance, &s), "count is 33");
  wrong("count", pocketray_get_number(&s, "samples", &value), "count is 33");
}

static void odd_cameras(pocketray_instance* instance) {
  const pocketray_camera usual = POCKETRAY_CAMERA_INIT;
  pocketray_camera c;
  int i;
  for (i = 0; i < kOddFloats; ++i) {
    c = usual, c.eye[1] = odd_floats[i];
    wrong("eye", pocketray_set_camera(instance, &c), "coordinate");
    c = usual, c.target[0] = odd_floats[i];
    wrong("target", pocketray_set_camera(instance, &c), "coordinate");
    c = usual, c.up[2] = odd_floats[i];
    wrong("up", pocketray_set_camera(instance, &c), "coordinate");
    c = usual, c.vertical_fov_degrees = (double)odd_floats[i];
    wrong("field of view", pocketray_set_camera(instance, &c), "field of view");
    c = usual, c.projection = POCKETRAY_ORTHOGRAPHIC, c.vertical_extent = odd_floats[i];
    wrong("extent", pocketray_set_camera(instance, &c), "height");
  }
  c = usual, c.target[2] = 0;
  wrong("no direction", pocketray_set_camera(instance, &c), "same point");
  c = usual, c.projection = 2;
  wrong("projection", pocketray_set_camera(instance, &c), "projection");
  wrong("scene camera", pocketray_use_scene_camera(instance, 1), "no camera 1");
  wrong("scene camera", pocketray_use_scene_camera(instance, POCKETRAY_NONE), "no camera");
}

static void odd_lights_and_surroundings(pocketray_instance* instance) {
  const pocketray_light usual = POCKETRAY_LIGHT_INIT;
  const float dark[3] = {0, 0, 0};
  pocketray_light light;
  float rgb[3] = {0, 0, 0};
  int i;
#define WRONG(change, part) \
  light = usual;            \
  change;                   \
  wrong(#change, pocketray_set_lights(instance, &light, 1), part)
  for (i = 0; i < kOddFloats; ++i) {
    WRONG(light.position[0] = odd_floats[i], "position");
    WRONG(light.direction[1] = odd_floats[i], "direction");
    WRONG(light.intensity[2] = odd_floats[i], "intensity");
    rgb[i % 3] = odd_floats[i];
    wrong("background", pocketray_set_surroundings(instance, rgb, dark), "background[");
    wrong("ambient", pocketray_set_surroundings(instance, dark, rgb), "ambient[");
    rgb[i % 3] = 0;
  }
  WRONG(light.kind = 3, "kind of a light is 3");
  WRONG(light.kind = -1, "kind of a light is -1");
  WRONG(light.direction[1] = 0, "direction");
  WRONG(light.range = -1, "range");
  WRONG(light.cos_inner = 2, "cos_inner");
  WRONG(light.cos_outer = NAN, "cos_outer");
  WRONG(light.node = 0xFFFFFFFEu, "node");
#undef WRONG
  light = usual;
  refused("many", pocketray_set_lights(instance, &light, 9), POCKETRAY_ERROR_LIMIT, "light_count_max");
  refused("very many", pocketray_set_lights(instance, &light, 0xFFFFFFFFu), POCKETRAY_ERROR_LIMIT, "light_count_max");
}

static void odd_nodes_and_exposures(pocketray_instance* instance) {
  pocketray_node node = POCKETRAY_NODE_INIT;
  float transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  int i, k;
  for (i = 0; i < kOddFloats; ++i) {
    for (k = 0; k < 12; ++k) {
      float kept = transform[k];
      transform[k] = odd_floats[i];
      wrong("transform", pocketray_set_node(instance, 0, transform), "transform");
      transform[k] = kept;
    }
    wrong("exposure", pocketray_set_exposure(instance, odd_floats[i]), "exposure");
  }
  wrong("exposure", pocketray_set_exposure(instance, 0), "exposure");
  wrong("tone", pocketray_set_tone(instance, 2), "the tone is 2");
  wrong("tone", pocketray_set_tone(instance, -1), "the tone is -1");
  wrong("node", pocketray_set_node(instance, 1000, transform), "no node 1000");
  wrong("node", pocketray_get_node(instance, POCKETRAY_NONE, &node), "no node");
}

static void odd_times_and_pixels(pocketray_instance* instance) {
  static api_picture picture;
  const pocketray_pixels usual = api_pixels(&picture);
  pocketray_pixels p = usual;
  int i;
  for (i = 0; i < kOddTimes; ++i) {
    wrong("render", pocketray_render(instance, odd_times[i], &usual), "time in seconds");
    wrong("begin", pocketray_begin(instance, odd_times[i]), "time in seconds");
    wrong("measure", pocketray_measure_exposure(instance, odd_times[i], NULL), "time in seconds");
  }
  wrong("nothing begun", pocketray_refine(instance, 0, &usual), "begin");
  EXPECT_OK(pocketray_begin(instance, 0));
  wrong("refine", pocketray_refine(instance, NAN, &usual), "milliseconds");
  wrong("refine", pocketray_refine(instance, INFINITY, &usual), "milliseconds");
  wrong("refine", pocketray_refine(instance, -1, &usual), "milliseconds");
  wrong("no pixels", pocketray_render(instance, 0, NULL), "null");
#define WRONG(change, part)                                \
  p = usual;                                               \
  change;                                                  \
  wrong(#change, pocketray_render(instance, 0, &p), part); \
  wrong(#change, pocketray_refine(instance, 0, &p), part)
  WRONG(p.struct_size = 8, "struct_size");
  WRONG(p.data = NULL, "null");
  WRONG(p.data = (unsigned char*)&picture + 1, "aligned to 4");
  WRONG(p.byte_count -= 1, "byte_count");
  WRONG(p.line_bytes -= 4, "line_bytes is 356");
  WRONG(p.line_bytes = 0, "line_bytes");
  WRONG(p.line_bytes = (size_t)-4, "line_bytes");
  WRONG(p.line_bytes += 2, "aligned to 4");
  WRONG(p.line_bytes += 4, "byte_count");
  WRONG(p.format = 7, "format is 7");
  WRONG(p.format = -1, "format is -1");
  WRONG(p.format = POCKETRAY_RGB_FLOAT, "1080 bytes");
  WRONG(p.rotation_degrees = 45, "45");
  WRONG(p.rotation_degrees = 90, "byte_count");
  WRONG((p.rotation_degrees = 180, p.format = POCKETRAY_RGB_FLOAT), "rotated");
  WRONG(p.dither = 2, "dither");
#undef WRONG
}

/* Refused calls have not changed the instance. */
static void instance_refuses_and_stays_as_it_was(void) {
  static api_picture before, after;
  pocketray_options options = api_options();
  pocketray_instance* instance;
  const double times[] = {0, -1, 1e9, -1e9};
  int i;
  options.light_count_max = 8;
  options.movable = 1;
  instance = api_open("seesaw", &options, 0);
  api_render(instance, 1, &before);
  null_results_and_short_ones(instance);
  odd_settings(instance);
  odd_cameras(instance);
  odd_lights_and_surroundings(instance);
  odd_nodes_and_exposures(instance);
  odd_times_and_pixels(instance);
  api_render(instance, 1, &after);
  EXPECT(api_same(&before, &after));
  for (i = 0; i < 4; ++i) api_render(instance, times[i], &after);
  pocketray_close(instance);
}

const api_case api_misuse_cases[] = {{"sources_that_cannot_be_read", sources_that_cannot_be_read},
                                     {"options_out_of_range", options_out_of_range},
                                     {"parts_that_do_not_fit", parts_that_do_not_fit},
                                     {"memory_that_is_too_small", memory_that_is_too_small},
                                     {"no_instance", no_instance},
                                     {"instance_refuses_and_stays_as_it_was", instance_refuses_and_stays_as_it_was},
                                     {NULL, NULL}};
