// absence_SCENE FRAMES : renders a built-in scene FRAMES times in a build with only the scene's effects, or
// (absence_all SCENE FRAMES) with all. Prints the plan's effects and the bytes of every part of memory. absence_test.sh
// counts its instructions with valgrind.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>

#include "engine/frame.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"

using namespace pocketray;

int main(int argument_count, char** arguments) {
  if (argument_count != 3) return std::fprintf(stderr, "usage: %s SCENE FRAMES\n", arguments[0]), 2;
  auto built = build_builtin(arguments[1]);
  Settings settings;
  settings.width = 64, settings.height = 48;
  auto test = make_renderer(built->scene, settings);
  Renderer* renderer = &test->renderer;
  std::printf("effects 0x%" PRIx64 " of 0x%" PRIx64 "\n", renderer->effects.mask, kEffectsBuilt);
  for (int i = 0; i < renderer->memory.plan.part_count; ++i)
    std::printf("%s %zu bytes\n", renderer->memory.plan.parts[i].name, renderer->memory.plan.parts[i].bytes);
  for (int frame = std::atoi(arguments[2]); frame > 0; --frame)
    if (!render_frame(renderer, 0.5).ok) return 1;
  std::printf("picture %08x\n", picture_hash(renderer->image.data, renderer->image.count));
  return 0;
}
