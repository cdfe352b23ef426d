/* pocketray_options.coherence: the pictures are those of an instance without it, whatever changes between frames. */
#include <stddef.h>

#include "api.h"

typedef struct pair {
  pocketray_instance *whole, *coherent;
} pair;

static pair open_pair(const char* scene, pocketray_options options) {
  pair p;
  p.whole = api_open(scene, &options, 0);
  options.coherence = POCKETRAY_COHERENCE_ON;
  p.coherent = api_open(scene, &options, 1);
  return p;
}

static void close_pair(pair p) {
  pocketray_close(p.whole);
  pocketray_close(p.coherent);
}

static pocketray_frame frame_of(const pocketray_instance* instance) {
  pocketray_frame frame = POCKETRAY_FRAME_INIT;
  EXPECT_OK(pocketray_get_frame(instance, &frame));
  return frame;
}

/* Renders both; returns how many pixels the coherent one traced. */
static uint64_t traced(pair p, double seconds) {
  static api_picture whole, coherent;
  api_render(p.whole, seconds, &whole);
  api_render(p.coherent, seconds, &coherent);
  EXPECT(api_same(&whole, &coherent));
  EXPECT(frame_of(p.coherent).rows_done == API_HEIGHT);
  EXPECT(frame_of(p.whole).pixels_traced == API_WIDTH * API_HEIGHT);
  return frame_of(p.coherent).pixels_traced;
}

static void frames_of_an_animation_are_the_same(void) {
  pair p = open_pair("seesaw", api_options());
  uint64_t all = API_WIDTH * API_HEIGHT, sum = 0;
  int i;
  EXPECT(traced(p, 7) == all && frame_of(p.coherent).whole_because != NULL);
  for (i = 1; i < 8; ++i) {
    sum += traced(p, 7 + i / 30.0);
    EXPECT(frame_of(p.coherent).whole_because == NULL);
  }
  EXPECT(sum > 0 && sum < 2 * all);
  EXPECT(traced(p, 7 + 7 / 30.0) == 0);
  EXPECT(strstr(frame_of(p.whole).whole_because, "off") != NULL);
  close_pair(p);
}

static void changes_by_the_caller_are_followed(void) {
  const float up[12] = {1, 0, 0, 0, 0, 1, 0, 0.1f, 0, 0, 1, 0}, dark[3] = {0, 0, 0}, grey[3] = {0.2f, 0.2f, 0.3f};
  pocketray_part parts[2] = {{4, 4, 0}, {0, 4, 0}};
  pocketray_options options = api_options();
  pocketray_settings settings = POCKETRAY_SETTINGS_INIT;
  pocketray_light light = POCKETRAY_LIGHT_INIT;
  pocketray_camera camera = POCKETRAY_CAMERA_INIT;
  uint64_t all = API_WIDTH * API_HEIGHT, moved;
  pocketray_instance* each[2];
  pair p;
  int i;
  options.parts = parts;
  options.part_count = 2;
  options.light_count_max = 2;
  p = open_pair("cube", options);
  each[0] = p.whole, each[1] = p.coherent;
#define BOTH(call)                                \
  for (i = 0; i < 2; ++i) {                       \
    pocketray_instance* const instance = each[i]; \
    EXPECT_OK(call);                              \
  }
  EXPECT(traced(p, 0) == all);
  EXPECT(traced(p, 0) == 0);
  BOTH(pocketray_set_node(instance, 0, up))
  moved = traced(p, 0);
  EXPECT(moved > 0 && moved < all);
  BOTH(pocketray_set_node(instance, 0, NULL))
  EXPECT(traced(p, 0) > 0);
  EXPECT(traced(p, 0) == 0);
  BOTH(pocketray_set_surroundings(instance, grey, dark))
  EXPECT(traced(p, 0) == all);
  BOTH(pocketray_set_lights(instance, &light, 1))
  traced(p, 0);
  light.intensity[1] = 0.5f;
  BOTH(pocketray_set_lights(instance, &light, 1))
  EXPECT(traced(p, 0) > 0);
  BOTH(pocketray_get_camera(instance, &camera))
  camera.eye[0] += 0.1f;
  BOTH(pocketray_set_camera(instance, &camera))
  EXPECT(traced(p, 0) == all);
  EXPECT_OK(pocketray_set_number(&settings, "cut-off", 0));
  BOTH(pocketray_set_settings(instance, &settings))
  traced(p, 0);
  BOTH(pocketray_set_exposure(instance, 2))
  traced(p, 0);
  BOTH(pocketray_measure_exposure(instance, 0, NULL)) /* uses the image */
  traced(p, 0);
  EXPECT_OK(pocketray_begin(p.coherent, 3)); /* so does another frame */
  traced(p, 0);
  EXPECT(traced(p, 0) == 0);
  close_pair(p);
}

typedef struct stop_log {
  uint32_t calls, rows;
} stop_log;

static int stop_soon(void* user, uint32_t rows_done, uint32_t row_count) {
  stop_log* log = (stop_log*)user;
  EXPECT(rows_done >= log->rows && rows_done <= row_count);
  log->rows = rows_done;
  return ++log->calls == 1;
}

static void stopped_frames_have_their_rows(void) {
  static api_picture whole, part;
  pocketray_pixels pixels = api_pixels(&part);
  pair p = open_pair("seesaw", api_options());
  stop_log log = {0, 0};
  uint32_t rows, y;
  EXPECT_OK(pocketray_set_progress(p.coherent, stop_soon, &log));
  memset(&part, 0xA5, sizeof part);
  EXPECT(pocketray_render(p.coherent, 7, &pixels) == POCKETRAY_STOPPED);
  rows = frame_of(p.coherent).rows_done;
  EXPECT(log.calls == 1 && rows == log.rows && rows > 0 && rows < API_HEIGHT);
  api_render(p.whole, 7, &whole);
  EXPECT(memcmp(&part, &whole, rows * sizeof part.pixel[0]) == 0);
  for (y = rows; y < API_HEIGHT; ++y) EXPECT(part.pixel[y][0] == 0xA5A5A5A5u);
  pocketray_set_stop(p.coherent, 1);
  EXPECT(pocketray_render(p.coherent, 7.1, &pixels) == POCKETRAY_STOPPED);
  EXPECT(frame_of(p.coherent).rows_done == 0);
  pocketray_set_stop(p.coherent, 0);
  EXPECT_OK(pocketray_set_progress(p.coherent, NULL, NULL));
  traced(p, 7.1);
  EXPECT(traced(p, 7.2) < API_WIDTH * API_HEIGHT);
  close_pair(p);
}

/* Memory for it is planned; with less, frames are traced whole. */
static void memory_decides(void) {
  static api_picture picture;
  pocketray_source source = api_builtin("seesaw");
  pocketray_options options = api_options();
  pocketray_plan plain, coherent;
  pocketray_instance* instance;
  plain.struct_size = coherent.struct_size = sizeof plain;
  EXPECT_OK(pocketray_make_plan(&source, &options, api_memory[1], API_MEMORY, &plain));
  options.coherence = POCKETRAY_COHERENCE_AUTO;
  EXPECT_OK(pocketray_make_plan(&source, &options, api_memory[1], API_MEMORY, &coherent));
  EXPECT(coherent.memory_bytes > plain.memory_bytes + API_WIDTH * API_HEIGHT * 16);
  EXPECT_OK(pocketray_open(&source, &options, api_memory[0], coherent.memory_bytes, &instance));
  api_render(instance, 1, &picture);
  EXPECT(strcmp(frame_of(instance).whole_because, "the first frame") == 0);
  api_render(instance, 1, &picture);
  EXPECT(frame_of(instance).pixels_traced == API_WIDTH * API_HEIGHT);
  api_render(instance, 1, &picture);
  EXPECT(frame_of(instance).pixels_traced == 0);
  pocketray_close(instance);
  EXPECT_OK(pocketray_open(&source, &options, api_memory[0], plain.memory_bytes, &instance));
  api_render(instance, 1, &picture);
  api_render(instance, 1, &picture);
  EXPECT(frame_of(instance).pixels_traced == API_WIDTH * API_HEIGHT);
  EXPECT(strstr(frame_of(instance).whole_because, "fit") != NULL);
  pocketray_close(instance);
}

const api_case api_coherence_cases[] = {
    {"frames_of_an_animation_are_the_same", frames_of_an_animation_are_the_same},
    {"changes_by_the_caller_are_followed", changes_by_the_caller_are_followed},
    {"stopped_frames_have_their_rows", stopped_frames_have_their_rows},
    {"memory_decides", memory_decides},
    {NULL, NULL},
};
