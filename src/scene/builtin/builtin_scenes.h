// One line per built-in scene; each pair is defined in the file of that name.
#pragma once
#include "scene/builtin/builtin.h"

namespace pocketray {

std::size_t cornell_need();
void build_cornell(Arena* arena, Scene* scene);
std::size_t statue_need();
void build_statue(Arena* arena, Scene* scene);
std::size_t seesaw_need();
void build_seesaw(Arena* arena, Scene* scene);
std::size_t cube_need();
void build_cube(Arena* arena, Scene* scene);
std::size_t furnace_need();
void build_furnace(Arena* arena, Scene* scene);
std::size_t lanterns_need();
void build_lanterns(Arena* arena, Scene* scene);

}  // namespace pocketray
