/* Pictures: formats, progress, stop, refinement, costs. */
#include <pthread.h>

#include "api.h"

static void formats_show_the_same_picture(void) {
  static api_picture xrgb, xbgr;
  static uint16_t rgb565[API_HEIGHT][API_WIDTH], bgr565[API_HEIGHT][API_WIDTH];
  static unsigned char rgb888[API_HEIGHT][API_WIDTH][3], bgr888[API_HEIGHT][API_WIDTH][3];
  static float linear[API_HEIGHT][API_WIDTH][3];
  void* data[7] = {&xrgb, &xbgr, rgb565, bgr565, rgb888, bgr888, linear};
  const size_t pixel_bytes[7] = {4, 4, 2, 2, 3, 3, 12};
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  int format, x, y, lit = 0;
  for (format = 0; format < 7; ++format) {
    pocketray_pixels pixels = POCKETRAY_PIXELS_INIT;
    pixels.data = data[format];
    pixels.line_bytes = API_WIDTH * pixel_bytes[format];
    pixels.byte_count = pixels.line_bytes * API_HEIGHT;
    pixels.format = format;
    EXPECT_OK(pocketray_render(instance, 0, &pixels));
  }
  for (y = 0; y < API_HEIGHT; ++y) {
    for (x = 0; x < API_WIDTH; ++x) {
      uint32_t p = xrgb.pixel[y][x], red = p >> 16 & 255, green = p >> 8 & 255, blue = p & 255;
      const unsigned char *rgb = rgb888[y][x], *bgr = bgr888[y][x];
      EXPECT((xbgr.pixel[y][x] & 0xffffff) == (blue << 16 | green << 8 | red));
      EXPECT(rgb[0] == red && rgb[1] == green && rgb[2] == blue);
      EXPECT(bgr[2] == red && bgr[1] == green && bgr[0] == blue);
      EXPECT(labs((long)(rgb565[y][x] >> 11) * 255 / 31 - (long)red) < 6);
      EXPECT((rgb565[y][x] >> 11) == (bgr565[y][x] & 31) && (rgb565[y][x] & 31) == (bgr565[y][x] >> 11));
      EXPECT((linear[y][x][1] > 0) == (green > 0) || linear[y][x][1] < 1e-3f);
      lit += linear[y][x][1] > 0.1f && green > 90;
    }
  }
  EXPECT(lit > API_WIDTH * API_HEIGHT / 10);
  pocketray_close(instance);
}

/* Wide rows, a rotated picture, and bytes beyond it that stay unchanged. */
static void pictures_turn_and_stay_within_their_rows(void) {
  enum { kWide = 100, kTall = 90 };
  static api_picture upright;
  static uint32_t turned[kTall][kWide];
  pocketray_pixels pixels = POCKETRAY_PIXELS_INIT;
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  int x, y;
  api_render(instance, 0, &upright);
  memset(turned, 0xA5, sizeof turned);
  pixels.data = turned;
  pixels.line_bytes = sizeof turned[0];
  pixels.byte_count = sizeof turned - (kWide - API_HEIGHT) * sizeof turned[0][0];
  pixels.rotation_degrees = 90;
  EXPECT_OK(pocketray_render(instance, 0, &pixels));
  for (y = 0; y < API_WIDTH; ++y)
    for (x = 0; x < kWide; ++x)
      EXPECT(turned[y][x] == (x < API_HEIGHT ? upright.pixel[API_HEIGHT - 1 - x][y] : 0xA5A5A5A5u));
  pixels = api_pixels(&upright);
  pixels.dither = 1;
  pixels.format = POCKETRAY_RGB565;
  EXPECT_OK(pocketray_render(instance, 0, &pixels));
  pocketray_close(instance);
}

typedef struct band_log {
  uint32_t calls, rows, count, stop_after;
  pocketray_instance* instance;
} band_log;

static int log_band(void* user, uint32_t rows_done, uint32_t row_count) {
  band_log* log = (band_log*)user;
  EXPECT(rows_done > log->rows && rows_done <= row_count);
  ++log->calls;
  log->rows = rows_done;
  log->count = row_count;
  if (log->instance && log->calls == log->stop_after) pocketray_set_stop(log->instance, 1);
  return !log->instance && log->calls == log->stop_after;
}

static uint32_t rows_done(const pocketray_instance* instance) {
  pocketray_frame frame = POCKETRAY_FRAME_INIT;
  EXPECT_OK(pocketray_get_frame(instance, &frame));
  return frame.rows_done;
}

/* Stopped frames have the rows that they report, and leave the others unchanged. */
static void expect_rows(const api_picture* part, const api_picture* whole, uint32_t rows) {
  uint32_t y;
  EXPECT(memcmp(part, whole, rows * sizeof part->pixel[0]) == 0);
  for (y = rows; y < API_HEIGHT; ++y) EXPECT(part->pixel[y][0] == 0xA5A5A5A5u);
}

static void progress_is_told_and_stops(void) {
  static api_picture whole, part;
  pocketray_pixels pixels = api_pixels(&part);
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  band_log log = {0, 0, 0, 0, NULL};
  api_render(instance, 0, &whole);
  EXPECT(rows_done(instance) == API_HEIGHT);
  EXPECT_OK(pocketray_set_progress(instance, log_band, &log));
  api_render(instance, 0, &part);
  EXPECT(api_same(&whole, &part));
  EXPECT(log.calls >= 2 && log.rows == API_HEIGHT && log.count == API_HEIGHT);

  memset(&log, 0, sizeof log);
  log.stop_after = 1;
  memset(&part, 0xA5, sizeof part);
  EXPECT(pocketray_render(instance, 0, &pixels) == POCKETRAY_STOPPED);
  EXPECT(log.calls == 1 && log.rows == rows_done(instance) && log.rows < API_HEIGHT);
  expect_rows(&part, &whole, log.rows);

  memset(&log, 0, sizeof log);
  log.stop_after = 1;
  log.instance = instance;
  memset(&part, 0xA5, sizeof part);
  EXPECT(pocketray_render(instance, 0, &pixels) == POCKETRAY_STOPPED);
  EXPECT(rows_done(instance) == log.rows);
  pocketray_set_stop(instance, 0);
  EXPECT_OK(pocketray_set_progress(instance, NULL, NULL));
  api_render(instance, 0, &part);
  EXPECT(api_same(&whole, &part));
  pocketray_close(instance);
}

/* The function may be replaced by none from within a call: that holds from the next frame on. */
static int clear_count;
static int clear_progress(void* user, uint32_t rows_done, uint32_t row_count) {
  EXPECT(rows_done <= row_count);
  ++clear_count;
  EXPECT_OK(pocketray_set_progress((pocketray_instance*)user, NULL, NULL));
  return 0;
}

static void progress_may_be_cleared_while_it_is_told(void) {
  static api_picture whole, part;
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  api_render(instance, 0, &whole);
  EXPECT_OK(pocketray_set_progress(instance, clear_progress, instance));
  api_render(instance, 0, &part);
  EXPECT(api_same(&whole, &part));
  EXPECT(clear_count > 1); /* all of that frame's calls */
  const int count = clear_count;
  api_render(instance, 0, &part);
  EXPECT(clear_count == count);
  pocketray_close(instance);
}

static void* stop_soon(void* user) {
  pocketray_set_stop((pocketray_instance*)user, 1);
  return NULL;
}

static void stop_holds_until_it_is_cleared(void) {
  static api_picture whole, part;
  pocketray_pixels pixels = api_pixels(&part);
  pocketray_options options = api_options();
  pocketray_instance* instance;
  pocketray_result result = POCKETRAY_OK;
  pthread_t thread;
  int i;
  options.threads = 2;
  instance = api_open("cornell", &options, 0);
  api_render(instance, 0, &whole);
  pocketray_set_stop(instance, 1);
  memset(&part, 0xA5, sizeof part);
  EXPECT(pocketray_render(instance, 0, &pixels) == POCKETRAY_STOPPED);
  expect_rows(&part, &whole, 0);
  EXPECT_OK(pocketray_begin(instance, 0));
  EXPECT(pocketray_refine(instance, 1000, &pixels) == POCKETRAY_STOPPED);
  pocketray_set_stop(instance, 0);
  EXPECT(pthread_create(&thread, NULL, stop_soon, instance) == 0);
  for (i = 0; i < 100000 && result == POCKETRAY_OK; ++i) {
    memset(&part, 0xA5, sizeof part);
    result = pocketray_render(instance, 0, &pixels);
  }
  pthread_join(thread, NULL);
  EXPECT(result == POCKETRAY_STOPPED);
  expect_rows(&part, &whole, rows_done(instance));
  pocketray_close(instance);
}

static void refined_frames_are_whole_ones(void) {
  static api_picture whole, refined;
  static uint64_t costs[API_HEIGHT];
  pocketray_pixels pixels = api_pixels(&refined);
  pocketray_instance* instance = api_open("seesaw", NULL, 0);
  pocketray_result result;
  pocketray_frame frame = POCKETRAY_FRAME_INIT;
  int calls = 0, row;
  api_render(instance, 1.5, &whole);
  memset(&refined, 0, sizeof refined);
  EXPECT_OK(pocketray_begin(instance, 1.5));
  while ((result = pocketray_refine(instance, 0, &pixels)) == POCKETRAY_UNFINISHED && calls < 10000) {
    if (++calls > 1) continue; /* the coarsest grid, of 12 × 8 pixels, is traced at once */
    EXPECT(refined.pixel[API_HEIGHT - 1][API_WIDTH - 1] != 0);
    EXPECT(!api_same(&whole, &refined) && rows_done(instance) == 0);
  }
  EXPECT(result == POCKETRAY_OK && api_same(&whole, &refined));
  EXPECT(calls > API_HEIGHT / 8 && rows_done(instance) == API_HEIGHT);
  EXPECT_OK(pocketray_refine(instance, 0, &pixels));
  EXPECT_OK(pocketray_get_row_costs(instance, costs, API_HEIGHT));
  for (row = 0; row < API_HEIGHT; ++row) EXPECT(costs[row] > 0);
  EXPECT_OK(pocketray_get_frame(instance, &frame));
  EXPECT(frame.trace_ms > 0 && frame.ray_count >= API_WIDTH * API_HEIGHT);

  memset(&refined, 0, sizeof refined);
  EXPECT_OK(pocketray_begin(instance, 1.5));
  EXPECT_OK(pocketray_refine(instance, 1e9, &pixels));
  EXPECT(api_same(&whole, &refined));
  pocketray_close(instance);
}

/* Every change ends a frame in progress. */
static void changes_end_a_frame(void) {
  static api_picture picture;
  const float colour[3] = {0.1f, 0.1f, 0.1f}, still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  pocketray_pixels pixels = api_pixels(&picture);
  pocketray_settings settings = POCKETRAY_SETTINGS_INIT;
  pocketray_camera camera = POCKETRAY_CAMERA_INIT;
  pocketray_light light = POCKETRAY_LIGHT_INIT;
  pocketray_options options = api_options();
  pocketray_instance* instance;
  int change;
  options.movable = 1;
  options.light_count_max = 8;
  instance = api_open("seesaw", &options, 0);
  for (change = -1; change < 10; ++change) {
    EXPECT_OK(pocketray_begin(instance, 0));
    EXPECT(pocketray_refine(instance, 0, &pixels) == POCKETRAY_UNFINISHED);
    if (change == 0) EXPECT_OK(pocketray_set_settings(instance, &settings));
    if (change == 1) EXPECT_OK(pocketray_set_camera(instance, &camera));
    if (change == 2) EXPECT_OK(pocketray_use_scene_camera(instance, 0));
    if (change == 3) EXPECT_OK(pocketray_set_lights(instance, &light, 1));
    if (change == 4) EXPECT_OK(pocketray_set_surroundings(instance, colour, colour));
    if (change == 5) EXPECT_OK(pocketray_set_node(instance, 0, still));
    if (change == 6) EXPECT_OK(pocketray_set_node(instance, 0, NULL));
    if (change == 7) EXPECT_OK(pocketray_set_exposure(instance, 2));
    if (change == 8) EXPECT_OK(pocketray_measure_exposure(instance, 0, NULL));
    if (change == 9) api_render(instance, 0, &picture);
    EXPECT(pocketray_refine(instance, 0, &pixels) == (change < 0 ? POCKETRAY_UNFINISHED : POCKETRAY_ERROR_ARGUMENT));
  }
  pocketray_close(instance);
}

static void costs_are_of_the_last_frame(void) {
  static api_picture picture;
  static uint64_t costs[API_HEIGHT];
  pocketray_frame frame = POCKETRAY_FRAME_INIT;
  pocketray_pixels pixels = api_pixels(&picture);
  pocketray_instance* instance = api_open("cornell", NULL, 0);
  int row;
  api_render(instance, 0, &picture);
  EXPECT_OK(pocketray_get_row_costs(instance, costs, API_HEIGHT));
  for (row = 0; row < API_HEIGHT; ++row) EXPECT(costs[row] > 0);
  EXPECT_OK(pocketray_get_frame(instance, &frame));
  EXPECT(frame.build_ms > 0 && frame.trace_ms > 0 && frame.ray_count > API_WIDTH * API_HEIGHT);
  EXPECT(frame.rows_done == API_HEIGHT && frame.row_count == API_HEIGHT);
  pocketray_set_stop(instance, 1);
  EXPECT(pocketray_render(instance, 0, &pixels) == POCKETRAY_STOPPED);
  EXPECT_OK(pocketray_get_row_costs(instance, costs, API_HEIGHT));
  for (row = 0; row < API_HEIGHT; ++row) EXPECT(costs[row] == 0);
  pocketray_close(instance);
}

const api_case api_frame_cases[] = {
    {"formats_show_the_same_picture", formats_show_the_same_picture},
    {"pictures_turn_and_stay_within_their_rows", pictures_turn_and_stay_within_their_rows},
    {"progress_is_told_and_stops", progress_is_told_and_stops},
    {"progress_may_be_cleared_while_it_is_told", progress_may_be_cleared_while_it_is_told},
    {"stop_holds_until_it_is_cleared", stop_holds_until_it_is_cleared},
    {"refined_frames_are_whole_ones", refined_frames_are_whole_ones},
    {"changes_end_a_frame", changes_end_a_frame},
    {"costs_are_of_the_last_frame", costs_are_of_the_last_frame},
    {NULL, NULL}};
