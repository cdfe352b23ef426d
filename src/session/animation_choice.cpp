#include "session/animation_choice.h"

#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "base/nearest_word.h"
#include "session/note.h"
#include "session/report.h"

namespace pocketray {
namespace {

template <std::size_t size>
std::string text_of(const char (&text)[size]) {
  return std::string(text, strnlen(text, size));
}

std::string name_of(const Scene& scene, std::uint32_t index) {
  return scene.animation_labels.count ? text_of(scene.animation_labels[index].name) : "";
}

// Reads a number without sign; returns false for anything else.
bool read_number(const std::string& text, std::uint32_t* number) {
  if (text.empty() || text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos) return false;
  *number = static_cast<std::uint32_t>(std::stoul(text));
  return true;
}

std::string all_names(const Scene& scene) {
  std::string names;
  std::uint32_t number = 0;
  for (std::uint32_t index : numbered_animations(scene)) {
    if (number == 8) {
      names += ", …";
      break;
    }
    const std::string name = name_of(scene, index);
    names += std::string(names.empty() ? "" : ", ") + std::to_string(number++) +
             (name.empty() ? "" : " '" + shown(name) + "'");
  }
  return names;
}

}  // namespace

std::vector<std::uint32_t> numbered_animations(const Scene& scene) {
  std::vector<std::uint32_t> list;
  for (std::uint32_t i = 0; i < scene.animations.count; ++i)
    if (scene.animation_labels.empty() || !scene.animation_labels[i].combines) list.push_back(i);
  return list;
}

Status find_animation(const Scene& scene, const std::string& asked, std::uint32_t* index) {
  CHECK(index != nullptr);
  *index = 0;
  if (asked.empty()) return success();
  const std::vector<std::uint32_t> list = numbered_animations(scene);
  for (std::uint32_t i : list)
    if (name_of(scene, i) == asked) return *index = i, success();
  if (asked == kAllAnimations) return success();
  if (asked == kNoAnimation) return *index = kNone, success();
  std::uint32_t number;
  if (read_number(asked, &number) && number < list.size()) return *index = list[number], success();
  if (list.empty()) return failure("--animation is '%.60s': the scene has no animation; drop it", asked.c_str());
  std::vector<std::string> names = {kAllAnimations, kNoAnimation};
  for (std::uint32_t i : list) names.push_back(name_of(scene, i));
  NearestWord nearest(asked.c_str());
  for (const std::string& name : names) nearest.offer(name.c_str());
  const bool is_word = asked.find_first_not_of("0123456789 +-.") != std::string::npos;
  if (is_word && nearest.name())
    return failure("--animation is '%.60s', did you mean '%.60s'?", asked.c_str(), shown(nearest.name()).c_str());
  return failure("--animation is '%.60s': it must be all, none, or a name or number of %.300s", asked.c_str(),
                 all_names(scene).c_str());
}

std::string describe_animation(const Scene& scene, std::uint32_t index) {
  if (index == kNone) return "no animation plays";
  CHECK_LT(index, scene.animations.count);
  const std::vector<std::uint32_t> list = numbered_animations(scene);
  const double seconds = static_cast<double>(scene.animations[index].duration);
  char text[80];
  if (scene.animation_labels.count && scene.animation_labels[index].combines) {
    std::snprintf(text, sizeof text, "together, %g s: ", seconds);
    return text + shown(text_of(scene.animation_labels[index].drives));
  }
  std::uint32_t number = 0;
  while (list[number] != index) ++number;
  const std::string name = name_of(scene, index);
  std::string line = "animation " + std::to_string(number) + (name.empty() ? "" : " '" + shown(name) + "'");
  std::snprintf(text, sizeof text, ", %g s: ", seconds);
  if (scene.animation_labels.count) return line + text + shown(text_of(scene.animation_labels[index].drives));
  return line + text + counted(scene.animations[index].channel_count, "channel");
}

}  // namespace pocketray
