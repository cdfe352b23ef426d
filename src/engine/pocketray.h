/* libpocketray: renders a scene into your pixels, in memory that you give it. C99 and C++.
 *
 *   static unsigned char memory[24 << 20];
 *   static uint32_t screen[240 * 320];
 *   pocketray_source source = POCKETRAY_SOURCE_INIT;
 *   pocketray_options options = POCKETRAY_OPTIONS_INIT;
 *   pocketray_pixels pixels = POCKETRAY_PIXELS_INIT;
 *   pocketray_instance* instance;
 *   source.builtin = "cornell";
 *   pixels.data = screen, pixels.byte_count = sizeof screen, pixels.line_bytes = 320 * sizeof screen[0];
 *   if (pocketray_open(&source, &options, memory, sizeof memory, &instance) || pocketray_render(instance, 0, &pixels))
 *     puts(pocketray_error_message());
 *   pocketray_close(instance);
 *
 * Conventions
 *   Units      Distances in scene units, angles in degrees, times in seconds, colours linear with sRGB primaries; +Y is
 *              up, right-handed. Vectors are float[3]: x, y, z or red, green, blue. Row 0 is the top of the picture.
 *   Results    Every call that can fail returns a pocketray_result: 0 or above is no error. Null pointers, NaN, numbers
 *              out of range and damaged files are refused with an error; a call that fails changes nothing.
 *   Memory     The library allocates nothing except its threads (options.threads − 1 of them). Arguments are copied or
 *              only used during the call; `memory`, and the bytes of a scene that is not copied, must stay in place
 *              until pocketray_close().
 *   Threads    Several threads may use several instances. One instance takes one call at a time; only
 *              pocketray_set_stop() may be called at any time, from any thread or signal handler.
 *   Versions   A structure that may grow starts with struct_size, which its _INIT sets together with the defaults. A
 *              library accepts the structures of all earlier versions with the same POCKETRAY_VERSION_MAJOR and, while
 *              that is 0, the same POCKETRAY_VERSION_MINOR.
 *   Pictures   A scene with given settings, camera and time gives the same pixels on every CPU, with any number of
 *              threads, and in the program `pocketray`.
 */
#ifndef POCKETRAY_H
#define POCKETRAY_H

#include <stddef.h>
#include <stdint.h>

#define POCKETRAY_VERSION_MAJOR 0
#define POCKETRAY_VERSION_MINOR 3
#define POCKETRAY_VERSION_PATCH 0
#define POCKETRAY_VERSION_NUMBER \
  (POCKETRAY_VERSION_MAJOR * 65536u + POCKETRAY_VERSION_MINOR * 256u + POCKETRAY_VERSION_PATCH)

#if defined(__GNUC__)
#define POCKETRAY_API __attribute__((visibility("default")))
#else
#define POCKETRAY_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* POCKETRAY_VERSION_NUMBER of the library; compare it with this header's. */
POCKETRAY_API uint32_t pocketray_version(void);

typedef enum pocketray_result {
  POCKETRAY_OK = 0,
  POCKETRAY_UNFINISHED = 1,      /* pocketray_refine(): the deadline came first */
  POCKETRAY_STOPPED = 2,         /* by pocketray_set_stop() or the progress function */
  POCKETRAY_ERROR_ARGUMENT = -1, /* a null pointer, a number out of range, a name that does not exist */
  POCKETRAY_ERROR_SCENE = -2,    /* the scene's bytes are damaged, or it cannot be rendered */
  POCKETRAY_ERROR_MEMORY = -3,   /* the memory given is too small */
  POCKETRAY_ERROR_LIMIT = -4     /* more than the options of pocketray_open() reserved */
} pocketray_result;

/* The error of the calling thread's last failed call and its remedy: one line of UTF-8. Valid until the thread's next
 * call. Empty before the first error. */
POCKETRAY_API const char* pocketray_error_message(void);

/* ---- Scenes, options, plan ----------------------------------------------------------------------------------------*/

#define POCKETRAY_NONE 0xFFFFFFFFu /* no such index */

/* Names of the built-in scenes, 0 upward; null beyond the last one. */
POCKETRAY_API const char* pocketray_builtin_name(uint32_t index);

/* What to render: either a built-in scene, or the bytes of a .pray file (`pocketray bake` makes one of a model). */
typedef struct pocketray_source {
  size_t struct_size;
  const char* builtin; /* null: `bytes` */
  const void* bytes;   /* aligned to 64 and unchanged until pocketray_close(), unless copied */
  size_t byte_count;
  int copy; /* 1: pocketray_open() copies the bytes to its memory; they need no alignment */
} pocketray_source;
#define POCKETRAY_SOURCE_INIT \
  { sizeof(pocketray_source), NULL, NULL, 0, 0 }

/* Settings that trade accuracy for time, by the names, ranges and defaults of the program's options: "samples",
 * "depth", "virtual-lights", "reconstruction", …; `pocketray render --help-all` explains them. They may change between
 * frames. Filled by pocketray_set_number() and pocketray_set_choice(); settings that are not in the list have their
 * defaults when a scene is opened, and stay as they are in pocketray_set_settings(). */
#define POCKETRAY_SETTINGS_MAX 32
typedef struct pocketray_settings {
  size_t struct_size;
  uint32_t count;
  uint32_t reserved;
  struct {
    const char* name; /* never freed */
    double value;     /* of a choice: its index */
  } list[POCKETRAY_SETTINGS_MAX];
} pocketray_settings;
#define POCKETRAY_SETTINGS_INIT         \
  {                                     \
    sizeof(pocketray_settings), 0, 0, { \
      { NULL, 0 }                       \
    }                                   \
  }

/* Names of the settings, 0 upward; null beyond the last one. */
POCKETRAY_API const char* pocketray_setting_name(uint32_t index);
/* Names of a setting's choices, 0 upward; null beyond the last one, and for a setting that is a number. */
POCKETRAY_API const char* pocketray_choice_name(const char* setting, uint32_t index);

/* Puts a setting into the list, or replaces it there. POCKETRAY_ERROR_ARGUMENT: there is no such setting or choice, or
 * the number is out of range. */
POCKETRAY_API pocketray_result pocketray_set_number(pocketray_settings* settings, const char* name, double value);
POCKETRAY_API pocketray_result pocketray_set_choice(pocketray_settings* settings, const char* name, const char* choice);
/* Puts all settings of a level of quality into the list: "draft", "low", "medium" (the defaults), "high" or "best".
 * POCKETRAY_ERROR_ARGUMENT: there is no such level. */
POCKETRAY_API pocketray_result pocketray_set_quality(pocketray_settings* settings, const char* level);
/* Stores the value in the list, otherwise the default; of a choice its index. */
POCKETRAY_API pocketray_result pocketray_get_number(const pocketray_settings* settings, const char* name,
                                                    double* value);

enum { POCKETRAY_PERSPECTIVE = 0, POCKETRAY_ORTHOGRAPHIC = 1 };

typedef struct pocketray_camera {
  size_t struct_size;
  float eye[3], target[3], up[3];
  int projection;              /* POCKETRAY_PERSPECTIVE or _ORTHOGRAPHIC */
  double vertical_fov_degrees; /* perspective: 0.001 … 179 */
  float vertical_extent;       /* orthographic: scene units from the bottom to the top of the picture */
  int reserved;
} pocketray_camera;
#define POCKETRAY_CAMERA_INIT \
  { sizeof(pocketray_camera), {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0, 45, 1, 0 }

/* A movable part of a scene without animation: a run of its vertices. Triangles between vertices of two parts
 * stretch. */
typedef struct pocketray_part {
  uint32_t vertex_begin, vertex_count; /* in the file's order; count 0: the run of vertices used by `material`, */
  uint32_t material;                   /* which no other material may use */
} pocketray_part;

/* pocketray_render() traces only what may have changed since the last frame that it rendered; the pictures stay the
 * same. AUTO: if the scene moves or is recolorable, memory allows it and it pays off; the first frame is whole. */
enum { POCKETRAY_COHERENCE_OFF = 0, POCKETRAY_COHERENCE_AUTO = 1, POCKETRAY_COHERENCE_ON = 2 };

/* Fixed from pocketray_open() on. */
typedef struct pocketray_options {
  size_t struct_size;
  int width, height;                  /* pixels, 1 … 8192 */
  int threads;                        /* tracing threads, including the caller's: 1 … 64 */
  int measure_exposure;               /* 1: measure it on the first picture, even if the scene states one */
  const pocketray_settings* settings; /* null: the defaults */
  const pocketray_camera* camera;     /* null: the scene's camera `camera_index` */
  uint32_t camera_index;
  uint32_t light_count_max;    /* reserve memory for pocketray_set_lights(); 0: lights are fixed */
  const char* effects;         /* "auto" plus or minus effects: "auto,-shadow"; null: auto, what the scene needs */
  const char* accelerator;     /* "bvh", "compact", "grid", …; null: the file's, or the fastest that fits */
  const pocketray_part* parts; /* of a scene without animation: each becomes a node, in this order */
  uint32_t part_count;
  int movable;         /* 1: reserve memory for pocketray_set_node() on the nodes of an animated scene */
  int coherence;       /* POCKETRAY_COHERENCE_… */
  int coherence_table; /* side of the tables of rays behind mirrors and glass, in blocks of pixels, 1 … 1024 */
  int recolorable;     /* 1: reserve memory for pocketray_set_material() */
  int reserved;
} pocketray_options;
#define POCKETRAY_OPTIONS_INIT \
  { sizeof(pocketray_options), 320, 240, 1, 0, NULL, NULL, 0, 0, NULL, NULL, NULL, 0, 0, 0, 16, 0, 0 }

typedef struct pocketray_effect {
  const char* name;          /* as in options.effects; never freed */
  const char* called_for_by; /* scene content that needs it; never freed */
  int on;                    /* whether it is simulated */
  char reason[96];           /* why it is on or off */
} pocketray_effect;

typedef struct pocketray_memory_part {
  const char* name; /* never freed */
  size_t bytes;
} pocketray_memory_part;

#define POCKETRAY_EFFECTS_MAX 128
#define POCKETRAY_MEMORY_PARTS_MAX 16

/* The plan for a scene, options and settings. */
typedef struct pocketray_plan {
  size_t struct_size;
  size_t memory_bytes;     /* needed by pocketray_open(); with less, it may fall back on a smaller accelerator */
  size_t scratch_bytes;    /* needed by pocketray_make_plan(); 0 for a .pray file aligned to 64, without parts */
  const char* accelerator; /* never freed */
  uint32_t vertex_count, triangle_count, material_count, light_count, camera_count, node_count;
  int default_camera, default_lights; /* 1: the scene has none and got defaults */
  uint32_t frame_count;               /* as stated by the scene */
  float frames_per_second;
  double duration_seconds; /* of its animation, which then repeats; 0: no animation */
  uint32_t effect_count, memory_part_count;
  pocketray_effect effects[POCKETRAY_EFFECTS_MAX];
  pocketray_memory_part memory_parts[POCKETRAY_MEMORY_PARTS_MAX];
} pocketray_plan;

/* Plans without rendering: which effects are simulated and why, and how much memory pocketray_open() needs with the
 * same arguments. plan->struct_size must be set. `scratch` is used during the call; it may be null if
 * plan->scratch_bytes turns out to be 0. If it is too small, the call returns POCKETRAY_ERROR_MEMORY and sets
 * plan->scratch_bytes. */
POCKETRAY_API pocketray_result pocketray_make_plan(const pocketray_source* source, const pocketray_options* options,
                                                   void* scratch, size_t scratch_bytes, pocketray_plan* plan);

/* ---- Instances ----------------------------------------------------------------------------------------------------*/

typedef struct pocketray_instance pocketray_instance; /* one scene, ready to render; lies in the memory given */

/* Opens a scene. `memory` belongs to the instance until pocketray_close(); it uses no other memory. *instance is null
 * after an error. */
POCKETRAY_API pocketray_result pocketray_open(const pocketray_source* source, const pocketray_options* options,
                                              void* memory, size_t memory_bytes, pocketray_instance** instance);
/* Ends the instance's threads and returns the memory to you. Null is allowed. */
POCKETRAY_API void pocketray_close(pocketray_instance* instance);
/* The plan, including changes made since. plan->struct_size must be set. */
POCKETRAY_API pocketray_result pocketray_get_plan(const pocketray_instance* instance, pocketray_plan* plan);

/* Settings for the next frames. Get: all of them. POCKETRAY_ERROR_LIMIT: one needs memory that was not reserved when
 * the scene was opened, as for more points per area light, or for a method of indirect light. */
POCKETRAY_API pocketray_result pocketray_get_settings(const pocketray_instance* instance, pocketray_settings* settings);
POCKETRAY_API pocketray_result pocketray_set_settings(pocketray_instance* instance, const pocketray_settings* settings);

/* The camera. Get: the last frame's, or the one set since. Set: replaces the scene's. Use scene: returns to the scene's
 * camera `camera_index`, which moves if it is animated; in a scene without cameras, index 0 is the default camera.
 */
POCKETRAY_API pocketray_result pocketray_get_camera(const pocketray_instance* instance, pocketray_camera* camera);
POCKETRAY_API pocketray_result pocketray_set_camera(pocketray_instance* instance, const pocketray_camera* camera);
POCKETRAY_API pocketray_result pocketray_use_scene_camera(pocketray_instance* instance, uint32_t camera_index);

enum { POCKETRAY_POINT_LIGHT = 0, POCKETRAY_SPOT_LIGHT = 1, POCKETRAY_DIRECTIONAL_LIGHT = 2 };

/* A light that is not a surface; emissive materials are area lights in any case. */
typedef struct pocketray_light {
  int kind;                   /* POCKETRAY_…_LIGHT */
  float position[3];          /* point, spot */
  float direction[3];         /* spot, directional: direction of travel, of length 1 */
  float intensity[3];         /* point, spot: radiant intensity; directional: irradiance on a surface that faces it */
  float range;                /* no light beyond this distance; 0: no limit */
  float cos_inner, cos_outer; /* spot: cosines of the angles of full light and of none */
  uint32_t node;              /* node it moves with, in whose space it is given; POCKETRAY_NONE: none */
} pocketray_light;
#define POCKETRAY_LIGHT_INIT \
  { 0, {0, 0, 0}, {0, -1, 0}, {1, 1, 1}, 0, 1, 0, POCKETRAY_NONE }

/* The lights as stated by the scene, before nodes move them. Writes the first `capacity` of them to `lights`, which may
 * be null if that is 0, and their total number to *light_count. */
POCKETRAY_API pocketray_result pocketray_get_lights(const pocketray_instance* instance, pocketray_light* lights,
                                                    uint32_t capacity, uint32_t* light_count);
/* Replaces all lights by at most options.light_count_max lights. */
POCKETRAY_API pocketray_result pocketray_set_lights(pocketray_instance* instance, const pocketray_light* lights,
                                                    uint32_t light_count);

/* The colours of a material, 0 … 1 each unless stated otherwise, and its texture. */
typedef struct pocketray_material {
  size_t struct_size;
  float diffuse[3];                           /* albedo; × texture × vertex colour */
  float specular[3], mirror[3];               /* reflectance of the highlight at normal incidence, and of the mirror */
  float specular_tinted[3], mirror_tinted[3]; /* the parts of these that texture and vertex colour tint, as in metals */
  float transmission[3];                      /* of glass; 0: opaque */
  float absorption[3];                        /* per scene unit within glass; 0 … 1e18 */
  float emission[3];                          /* radiance; × its own texture, which stays; 0 … 1e18 */
  uint32_t texture;                           /* of the scene, as its other materials use it, or POCKETRAY_NONE */
  uint32_t reserved;
} pocketray_material;
#define POCKETRAY_MATERIAL_INIT                                                                                       \
  {                                                                                                                   \
    sizeof(pocketray_material), {0.8f, 0.8f, 0.8f}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, \
        {0, 0, 0}, POCKETRAY_NONE, 0                                                                                  \
  }

/* One of plan.material_count materials. Get: as the next frame shows it. Set: recolours or retextures its surfaces, or
 * dims a lamp, down to 0; modify what get returned. The scene as opened fixes which effects are simulated and which
 * materials are lamps. Light that the scene stores with its surfaces (effect radiosity) stays as it was solved.
 * POCKETRAY_ERROR_LIMIT: options.recolorable is not set, the material calls for an effect that the opened scene does
 * not (a mirror, a first texture, …), or emits where none did. POCKETRAY_ERROR_ARGUMENT: a number is out of range, or a
 * texture of the material provides what was changed (metallic-roughness maps: all colours except absorption and
 * emission). */
POCKETRAY_API pocketray_result pocketray_get_material(const pocketray_instance* instance, uint32_t material,
                                                      pocketray_material* result);
POCKETRAY_API pocketray_result pocketray_set_material(pocketray_instance* instance, uint32_t material,
                                                      const pocketray_material* changed);

/* Radiance of rays that hit nothing, and of constant indirect light from all directions; 0 … 1e18. */
POCKETRAY_API pocketray_result pocketray_get_surroundings(const pocketray_instance* instance, float background[3],
                                                          float ambient[3]);
POCKETRAY_API pocketray_result pocketray_set_surroundings(pocketray_instance* instance, const float background[3],
                                                          const float ambient[3]);

/* A node: of an animated scene, or one of options.parts. Transforms are affine, three rows of four: p' = A·p + t with t
 * in the last column. */
typedef struct pocketray_node {
  size_t struct_size;
  uint32_t parent;     /* a lower index, or POCKETRAY_NONE */
  int overridden;      /* 1: set by pocketray_set_node() */
  float to_parent[12]; /* of the next frame if overridden, otherwise of the last one */
  float to_world[12];  /* of the last frame */
} pocketray_node;
#define POCKETRAY_NODE_INIT                               \
  {                                                       \
    sizeof(pocketray_node), POCKETRAY_NONE, 0, {0}, { 0 } \
  }

POCKETRAY_API pocketray_result pocketray_get_node(const pocketray_instance* instance, uint32_t node,
                                                  pocketray_node* result);
/* Places a node in its parent's space (a part: in the scene's) in all further frames, overriding its animation. Null
 * returns it to the animation, or a part to its original place. Its children, meshes, skins, lights and cameras follow.
 * A mirroring transform turns surfaces inside out. POCKETRAY_ERROR_LIMIT: neither options.movable nor options.parts
 * is set. */
POCKETRAY_API pocketray_result pocketray_set_node(pocketray_instance* instance, uint32_t node,
                                                  const float to_parent[12]);

/* The display shows exposure × radiance; 2⁻⁶⁰ … 2⁶⁰. Measuring sets the exposure that makes the geometric mean of the
 * camera's view at a time middle grey; its `exposure` may be null. */
POCKETRAY_API pocketray_result pocketray_get_exposure(const pocketray_instance* instance, float* exposure);
POCKETRAY_API pocketray_result pocketray_set_exposure(pocketray_instance* instance, float exposure);
POCKETRAY_API pocketray_result pocketray_measure_exposure(pocketray_instance* instance, double seconds,
                                                          float* exposure);
/* How light that is too bright for the display is shown. */
enum {
  POCKETRAY_TONE_CLIP = 0, /* red, green and blue end at white, each by itself; the default */
  POCKETRAY_TONE_FILM = 1  /* light above .8 of white fades to white */
};
POCKETRAY_API pocketray_result pocketray_set_tone(pocketray_instance* instance, int tone);

/* ---- Frames -------------------------------------------------------------------------------------------------------*/

enum {
  POCKETRAY_XRGB8888 = 0, /* 32 bits in the CPU's byte order, red in bits 16 … 23; the upper 8 are 0 */
  POCKETRAY_XBGR8888 = 1, /* 32 bits, blue in bits 16 … 23 */
  POCKETRAY_RGB565 = 2,   /* 16 bits in the CPU's byte order, red uppermost */
  POCKETRAY_BGR565 = 3,   /* 16 bits, blue uppermost */
  POCKETRAY_RGB888 = 4,   /* bytes red, green, blue */
  POCKETRAY_BGR888 = 5,   /* bytes blue, green, red */
  POCKETRAY_RGB_FLOAT = 6 /* three floats: linear radiance, before exposure */
};

/* Destination and format of a picture. */
typedef struct pocketray_pixels {
  size_t struct_size;
  void* data;           /* top left of the screen; aligned to the pixel size, 1, 2 or 4 bytes */
  size_t byte_count;    /* total: line_bytes for every row except the last, which may end with its pixels */
  size_t line_bytes;    /* from one screen row to the next; a multiple of the alignment */
  int format;           /* POCKETRAY_XRGB8888, … */
  int rotation_degrees; /* of the picture, clockwise: 0, 90, 180 or 270; a quarter turn puts width × height pixels on a
                           screen of height × width. POCKETRAY_RGB_FLOAT: 0 */
  int dither;           /* 1: ordered, 8 × 8 */
  int reserved;
} pocketray_pixels;
#define POCKETRAY_PIXELS_INIT \
  { sizeof(pocketray_pixels), NULL, 0, 0, 0, 0, 0, 0 }

/* Renders the scene at a time, within ±1e9 seconds. POCKETRAY_STOPPED: only the finished rows are written, from the
 * top; pocketray_get_frame() tells how many. */
POCKETRAY_API pocketray_result pocketray_render(pocketray_instance* instance, double seconds,
                                                const pocketray_pixels* pixels);

/* Renders the picture coarse first: begins a frame, then refines it for some milliseconds per call, by at least a few
 * tiles of 8 × 8 pixels. Pass the same pixels each time: only changed rows are written. POCKETRAY_OK: the frame is
 * finished; POCKETRAY_UNFINISHED: call again; POCKETRAY_STOPPED: call again when the stop flag is cleared.
 * pocketray_render() and any change of the instance end a frame in progress. */
POCKETRAY_API pocketray_result pocketray_begin(pocketray_instance* instance, double seconds);
POCKETRAY_API pocketray_result pocketray_refine(pocketray_instance* instance, double milliseconds,
                                                const pocketray_pixels* pixels);

/* 1: rendering stops within a few rows and does not restart until the flag is set to 0. May be called from any thread
 * or signal handler. A null instance is allowed. */
POCKETRAY_API void pocketray_set_stop(pocketray_instance* instance, int stop);

/* Called by pocketray_render() after every few rows, on its thread; any result other than 0 stops the frame. The only
 * calls it may make on the instance are pocketray_set_stop() and pocketray_set_progress(), which takes effect with the
 * next frame. `user` is passed on. Null: none. */
typedef int (*pocketray_progress)(void* user, uint32_t rows_done, uint32_t row_count);
POCKETRAY_API pocketray_result pocketray_set_progress(pocketray_instance* instance, pocketray_progress progress,
                                                      void* user);

/* Cost of the last frame. */
typedef struct pocketray_frame {
  size_t struct_size;
  double build_ms; /* the accelerator's, when the scene was opened */
  double pose_ms, refit_ms, trace_ms;
  uint64_t ray_count, rays_skipped; /* rays_skipped: could not have changed a display level */
  uint32_t rows_done, row_count;    /* of a frame being refined: rows of its finest grid */
  /* Of the last frame of pocketray_render(): */
  uint64_t pixels_traced;
  const char* whole_because; /* why it was traced whole; never freed; null: only possible changes were traced */
} pocketray_frame;
#define POCKETRAY_FRAME_INIT \
  { sizeof(pocketray_frame), 0, 0, 0, 0, 0, 0, 0, 0, 0, NULL }
POCKETRAY_API pocketray_result pocketray_get_frame(const pocketray_instance* instance, pocketray_frame* frame);
/* Cost of each row of the last frame, in nanoseconds of one thread; 0 if it was not traced. Rows traced together get
 * equal shares. `row_count` must be the picture's height. */
POCKETRAY_API pocketray_result pocketray_get_row_costs(const pocketray_instance* instance, uint64_t* nanoseconds,
                                                       uint32_t row_count);

#ifdef __cplusplus
}
#endif
#endif
