/* test_api FILE [SCENE PICTURE] : every function of pocketray.h at work, and with arguments that it must refuse.
 * Compiled as C and as C++, within the build and against an installed copy. FILE is a .pray file with nodes and an
 * animation. With SCENE PICTURE nothing is tested: renders the built-in scene to PICTURE at 320×240 as binary PPM; FILE
 * is not read. */
#include "api.h"

int api_failures = 0;
static unsigned char block[2][API_MEMORY + 64], file_block[(1 << 20) + 64];
unsigned char* api_memory[2];
unsigned char* api_file = NULL;
size_t api_file_bytes = 0;

static const char* case_name = "";

void api_fail(const char* file, int line, const char* what) {
  if (case_name[0]) printf("TEST CASE:  %s\n", case_name);
  case_name = "";
  printf("%s:%d: %s; the last message is '%s'\n", file, line, what, pocketray_error_message());
  ++api_failures;
}

static unsigned char* aligned(unsigned char* bytes) { return bytes + (64 - (uintptr_t)bytes % 64) % 64; }

pocketray_source api_builtin(const char* name) {
  pocketray_source source = POCKETRAY_SOURCE_INIT;
  source.builtin = name;
  return source;
}

pocketray_options api_options(void) {
  pocketray_options options = POCKETRAY_OPTIONS_INIT;
  options.width = API_WIDTH;
  options.height = API_HEIGHT;
  return options;
}

pocketray_pixels api_pixels(api_picture* picture) {
  pocketray_pixels pixels = POCKETRAY_PIXELS_INIT;
  pixels.data = picture;
  pixels.byte_count = sizeof *picture;
  pixels.line_bytes = sizeof picture->pixel[0];
  return pixels;
}

pocketray_instance* api_open(const char* builtin, const pocketray_options* options, int which) {
  pocketray_source source = api_builtin(builtin);
  pocketray_options usual = api_options();
  pocketray_instance* instance;
  if (pocketray_open(&source, options ? options : &usual, api_memory[which], API_MEMORY, &instance) == POCKETRAY_OK)
    return instance;
  printf("TEST CASE:  %s\ncannot open %s: %s\n", case_name, builtin, pocketray_error_message());
  exit(1);
}

void api_render(pocketray_instance* instance, double seconds, api_picture* picture) {
  pocketray_pixels pixels = api_pixels(picture);
  memset(picture, 0xA5, sizeof *picture);
  EXPECT_OK(pocketray_render(instance, seconds, &pixels));
}

int api_same(const api_picture* a, const api_picture* b) { return memcmp(a, b, sizeof *a) == 0; }

long api_distance(const api_picture* a, const api_picture* b) {
  const unsigned char *x = (const unsigned char*)a, *y = (const unsigned char*)b;
  long sum = 0;
  size_t i;
  for (i = 0; i < sizeof *a; ++i) sum += labs((long)x[i] - (long)y[i]);
  return sum;
}

static int read_file(const char* path) {
  FILE* file = fopen(path, "rb");
  api_file = aligned(file_block);
  if (file) api_file_bytes = fread(api_file, 1, 1 << 20, file);
  if (file) fclose(file);
  if (api_file_bytes > 1 && api_file[0] != 0x89)
    memmove(api_file, api_file + 1, --api_file_bytes); /* a fuzzer's seed */
  return api_file_bytes > 0;
}

static int write_picture(const char* scene, const char* path) {
  static unsigned char rgb[240][320][3];
  pocketray_source source = api_builtin(scene);
  pocketray_options options = POCKETRAY_OPTIONS_INIT;
  pocketray_pixels pixels = POCKETRAY_PIXELS_INIT;
  pocketray_instance* instance;
  FILE* file = fopen(path, "wb");
  pixels.data = rgb;
  pixels.byte_count = sizeof rgb;
  pixels.line_bytes = sizeof rgb[0];
  pixels.format = POCKETRAY_RGB888;
  if (!file || pocketray_open(&source, &options, api_memory[0], API_MEMORY, &instance) ||
      pocketray_render(instance, 0, &pixels))
    return printf("%s: %s\n", scene, pocketray_error_message()), 1;
  pocketray_close(instance);
  fprintf(file, "P6\n320 240\n255\n");
  fwrite(rgb, 1, sizeof rgb, file);
  return fclose(file) != 0;
}

static int run(const api_case* cases) {
  int count = 0;
  for (; cases->name; ++cases, ++count) {
    case_name = cases->name;
    cases->run();
  }
  return count;
}

int main(int argc, char** argv) {
  const char* path = argc > 1 && argv[1][0] != '-' ? argv[1] : NULL;
  int count;
  api_memory[0] = aligned(block[0]);
  api_memory[1] = aligned(block[1]);
  if (argc > 3) return write_picture(argv[2], argv[3]);
#ifdef API_FILE
  if (!path) path = API_FILE;
#endif
  if (!path || !read_file(path)) return printf("usage: test_api FILE\n"), 2;
  count = run(api_open_cases) + run(api_frame_cases) + run(api_scene_cases) + run(api_misuse_cases) +
          run(api_coherence_cases) + run(api_material_cases);
  printf("%d cases, %d failures\n", count, api_failures);
  return api_failures > 0;
}
