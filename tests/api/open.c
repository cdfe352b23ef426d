/* Versions, plans, memory, sources and options. */
#include <stddef.h>

#include "api.h"

static void version_is_that_of_the_header(void) {
  EXPECT(pocketray_version() == POCKETRAY_VERSION_NUMBER);
  EXPECT(pocketray_error_message() != NULL);
}

static void builtin_names_end(void) {
  uint32_t count = 0;
  while (pocketray_builtin_name(count)) ++count;
  EXPECT(count >= 5);
  EXPECT(strcmp(pocketray_builtin_name(0), "cornell") == 0);
  EXPECT(pocketray_builtin_name(0xFFFFFFFFu) == NULL);
}

static pocketray_plan make_plan(const pocketray_source* source, const pocketray_options* options) {
  static pocketray_plan plan;
  plan.struct_size = sizeof plan;
  EXPECT_OK(pocketray_make_plan(source, options, api_memory[1], API_MEMORY, &plan));
  return plan;
}

/* The planned bytes suffice wherever the block starts, are not exceeded, and are not much more than needed. */
static void expect_exact(const pocketray_source* source, const pocketray_options* options) {
  static api_picture picture;
  pocketray_pixels pixels = api_pixels(&picture);
  pocketray_plan plan = make_plan(source, options);
  pocketray_instance* instance;
  size_t offset;
  for (offset = 0; offset < 64; offset += 21) {
    unsigned char* memory = api_memory[0] + offset;
    memset(memory + plan.memory_bytes, 0x5A, 64);
    EXPECT_OK(pocketray_open(source, options, memory, plan.memory_bytes, &instance));
    EXPECT(instance != NULL);
    if (!instance) return;
    EXPECT_OK(pocketray_render(instance, 0, &pixels));
    pocketray_close(instance);
    EXPECT(memory[plan.memory_bytes] == 0x5A && memory[plan.memory_bytes + 63] == 0x5A);
  }
  EXPECT(pocketray_open(source, options, api_memory[0], plan.memory_bytes - 65, &instance) == POCKETRAY_ERROR_MEMORY);
  EXPECT(instance == NULL);
}

static void planned_memory_is_what_is_needed(void) {
  const char* accelerators[] = {"bvh", "compact", "brute"};
  uint32_t scene, i;
  for (scene = 0; pocketray_builtin_name(scene); ++scene) {
    for (i = 0; i < 3; ++i) {
      pocketray_source source = api_builtin(pocketray_builtin_name(scene));
      pocketray_options options = api_options();
      options.width = i < 2 ? 8 : 2, options.height = i < 2 ? 6 : 2; /* brute force is slow */
      options.accelerator = accelerators[i];
      expect_exact(&source, &options);
    }
  }
}

static void planned_memory_holds_what_may_be_changed(void) {
  pocketray_source source = api_builtin("seesaw");
  pocketray_options options = api_options();
  pocketray_part part = {0, 0, 0};
  size_t plain;
  options.accelerator = "bvh";
  plain = make_plan(&source, &options).memory_bytes;
  options.movable = 1;
  options.light_count_max = 300;
  EXPECT(make_plan(&source, &options).memory_bytes > plain + 300 * 100);
  expect_exact(&source, &options);
  source = api_builtin("cube");
  options.movable = 0;
  part.vertex_count = make_plan(&source, &options).vertex_count;
  options.parts = &part;
  options.part_count = 1;
  expect_exact(&source, &options);
}

static void plans_need_scratch_for_scenes_made_by_code_alone(void) {
  pocketray_source source = api_builtin("cornell");
  pocketray_options options = api_options();
  pocketray_plan plan;
  plan.struct_size = sizeof plan;
  EXPECT(pocketray_make_plan(&source, &options, NULL, 0, &plan) == POCKETRAY_ERROR_MEMORY);
  EXPECT(plan.scratch_bytes > 100000 && plan.scratch_bytes < API_MEMORY);
  EXPECT_OK(pocketray_make_plan(&source, &options, api_memory[1] + 1, plan.scratch_bytes, &plan));
  EXPECT(pocketray_make_plan(&source, &options, api_memory[1], plan.scratch_bytes - 1, &plan) ==
         POCKETRAY_ERROR_MEMORY);
  source.builtin = NULL;
  source.bytes = api_file;
  source.byte_count = api_file_bytes;
  EXPECT_OK(pocketray_make_plan(&source, &options, NULL, 0, &plan));
  EXPECT(plan.scratch_bytes == 0 && plan.node_count > 0 && plan.duration_seconds > 0);
}

static const pocketray_effect* find_effect(const pocketray_plan* plan, const char* name) {
  uint32_t i;
  for (i = 0; i < plan->effect_count; ++i)
    if (strcmp(plan->effects[i].name, name) == 0) return &plan->effects[i];
  EXPECT(!"the plan has an effect of that name");
  return &plan->effects[0];
}

static void plans_say_which_effects_and_why(void) {
  pocketray_source source = api_builtin("cornell");
  pocketray_options options = api_options();
  pocketray_plan before, plan;
  pocketray_instance* instance;
  size_t sum = 0;
  uint32_t i;
  options.effects = "auto,-mirror";
  before = make_plan(&source, &options);
  EXPECT(find_effect(&before, "shadow")->on && strlen(find_effect(&before, "shadow")->called_for_by) > 0);
  EXPECT(!find_effect(&before, "mirror")->on && strstr(find_effect(&before, "mirror")->reason, "forced off"));
  EXPECT(before.triangle_count > 40000 && before.vertex_count > 20000 && before.material_count > 3);
  EXPECT(before.camera_count == 1 && !before.default_camera && !before.default_lights && before.frame_count == 1);
  EXPECT(before.duration_seconds == 0 && strcmp(before.accelerator, "bvh") == 0);
  for (i = 0; i < before.memory_part_count; ++i) sum += before.memory_parts[i].bytes;
  EXPECT(before.memory_parts[0].name && sum > 1000000 && sum < before.memory_bytes);
  instance = api_open("cornell", &options, 0);
  plan.struct_size = sizeof plan;
  EXPECT_OK(pocketray_get_plan(instance, &plan));
  EXPECT(plan.memory_bytes == before.memory_bytes && plan.triangle_count == before.triangle_count);
  for (i = 0; i < plan.effect_count; ++i)
    EXPECT(plan.effects[i].on == before.effects[i].on && !strcmp(plan.effects[i].reason, before.effects[i].reason));
  EXPECT(!find_effect(&before, "second-uv")->on && strstr(find_effect(&before, "second-uv")->reason, "none of "));
  pocketray_close(instance);
}

/* Plans, sources, options and settings of another size, as of another version's header, are refused. */
static void structures_of_other_versions_are_refused(void) {
  pocketray_source source = api_builtin("cornell");
  pocketray_options options = api_options();
  pocketray_plan plan = make_plan(&source, &options);
  pocketray_instance* instance = api_open("cornell", &options, 0);
  EXPECT(plan.effect_count > 32 && plan.effect_count <= POCKETRAY_EFFECTS_MAX);
  --plan.struct_size;
  EXPECT(pocketray_get_plan(instance, &plan) == POCKETRAY_ERROR_ARGUMENT);
  EXPECT(pocketray_make_plan(&source, &options, api_memory[1], API_MEMORY, &plan) == POCKETRAY_ERROR_ARGUMENT);
  pocketray_close(instance);
}

/* A file's bytes may be used in place, or copied from any address and discarded. */
static void files_are_used_in_place_or_copied(void) {
  static api_picture in_place, copied;
  static unsigned char elsewhere[1 << 20];
  pocketray_source source = POCKETRAY_SOURCE_INIT;
  pocketray_options options = api_options();
  pocketray_instance* instance = NULL;
  source.bytes = api_file;
  source.byte_count = api_file_bytes;
  options.accelerator = "bvh"; /* there is no smaller one to fall back on */
  EXPECT_OK(pocketray_open(&source, &options, api_memory[0], API_MEMORY, &instance));
  if (!instance) return;
  api_render(instance, 0.5, &in_place);
  pocketray_close(instance);
  memcpy(elsewhere + 1, api_file, api_file_bytes);
  source.bytes = elsewhere + 1;
  EXPECT(pocketray_open(&source, &options, api_memory[0], API_MEMORY, &instance) == POCKETRAY_ERROR_ARGUMENT);
  source.copy = 1;
  expect_exact(&source, &options);
  EXPECT_OK(pocketray_open(&source, &options, api_memory[0], API_MEMORY, &instance));
  memset(elsewhere, 0, sizeof elsewhere);
  api_render(instance, 0.5, &copied);
  pocketray_close(instance);
  EXPECT(api_same(&in_place, &copied));
}

static void damaged_files_are_refused(void) {
  static unsigned char damaged[1 << 20];
  pocketray_source source = POCKETRAY_SOURCE_INIT;
  pocketray_options options = api_options();
  pocketray_instance* instance;
  size_t bytes;
  source.bytes = damaged;
  source.copy = 1;
  for (bytes = 0; bytes < api_file_bytes; bytes += 1 + bytes / 8) {
    memcpy(damaged, api_file, api_file_bytes);
    source.byte_count = bytes;
    EXPECT(pocketray_open(&source, &options, api_memory[0], API_MEMORY, &instance) == POCKETRAY_ERROR_SCENE);
    damaged[bytes] ^= 0x40;
    source.byte_count = api_file_bytes;
    EXPECT(pocketray_open(&source, &options, api_memory[0], API_MEMORY, &instance) == POCKETRAY_ERROR_SCENE);
    EXPECT(instance == NULL);
  }
}

/* Threads, accelerators and forcing all effects on change no pixel; the memory may be reused. */
static void options_that_change_no_pixel(void) {
  static api_picture usual, other;
  pocketray_options options = api_options();
  pocketray_instance* instance = api_open("cornell", &options, 0);
  int i;
  api_render(instance, 0, &usual);
  pocketray_close(instance);
  for (i = 0; i < 3; ++i) {
    options = api_options();
    if (i == 0) options.threads = 3;
    if (i == 1) options.accelerator = "compact";
    if (i == 2) options.effects = "all";
    instance = api_open("cornell", &options, 0);
    api_render(instance, 0, &other);
    pocketray_close(instance);
    EXPECT(api_same(&usual, &other));
  }
}

static void instances_do_not_share(void) {
  static api_picture first, second, again;
  pocketray_instance *a = api_open("cube", NULL, 0), *b;
  api_render(a, 0, &first);
  b = api_open("seesaw", NULL, 1);
  api_render(b, 1, &second);
  api_render(a, 0, &again);
  EXPECT(api_same(&first, &again) && !api_same(&first, &second));
  pocketray_close(a);
  api_render(b, 1, &again);
  EXPECT(api_same(&second, &again));
  pocketray_close(b);
}

const api_case api_open_cases[] = {
    {"version_is_that_of_the_header", version_is_that_of_the_header},
    {"builtin_names_end", builtin_names_end},
    {"planned_memory_is_what_is_needed", planned_memory_is_what_is_needed},
    {"planned_memory_holds_what_may_be_changed", planned_memory_holds_what_may_be_changed},
    {"plans_need_scratch_for_scenes_made_by_code_alone", plans_need_scratch_for_scenes_made_by_code_alone},
    {"plans_say_which_effects_and_why", plans_say_which_effects_and_why},
    {"structures_of_other_versions_are_refused", structures_of_other_versions_are_refused},
    {"files_are_used_in_place_or_copied", files_are_used_in_place_or_copied},
    {"damaged_files_are_refused", damaged_files_are_refused},
    {"options_that_change_no_pixel", options_that_change_no_pixel},
    {"instances_do_not_share", instances_do_not_share},
    {NULL, NULL}};
