/* Shared by the tests of pocketray.h: plain C that a C++ compiler accepts, too. */
#ifndef POCKETRAY_TESTS_API_H
#define POCKETRAY_TESTS_API_H

#include <pocketray/pocketray.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A test reports failed expectations and continues. */
extern int api_failures;
void api_fail(const char* file, int line, const char* what);
#define EXPECT(condition) ((condition) ? (void)0 : api_fail(__FILE__, __LINE__, #condition))
#define EXPECT_OK(call) EXPECT((call) == POCKETRAY_OK)

/* The tests' picture: small, with neither side a multiple of a tile. */
enum { API_WIDTH = 90, API_HEIGHT = 61, API_MEMORY = 12 << 20 };

/* Two blocks for instances, aligned to 64. */
extern unsigned char* api_memory[2];

typedef struct api_picture {
  uint32_t pixel[API_HEIGHT][API_WIDTH];
} api_picture;

/* The structures of a built-in scene at that size, and of a picture. */
pocketray_source api_builtin(const char* name);
pocketray_options api_options(void);
pocketray_pixels api_pixels(api_picture* picture);

/* Opens in a block, or ends the program. */
pocketray_instance* api_open(const char* builtin, const pocketray_options* options, int block);
/* The picture of an instance at a time. */
void api_render(pocketray_instance* instance, double seconds, api_picture* picture);
int api_same(const api_picture* a, const api_picture* b);
/* Sum of the differences of all channels of all pixels. */
long api_distance(const api_picture* a, const api_picture* b);

/* The bytes of a .pray file with animation, aligned to 64, named by the program's argument. */
extern unsigned char* api_file;
extern size_t api_file_bytes;

typedef struct api_case {
  const char* name;
  void (*run)(void);
} api_case;
extern const api_case api_open_cases[], api_frame_cases[], api_scene_cases[], api_misuse_cases[], api_coherence_cases[],
    api_material_cases[]; /* a null name ends */

#endif
