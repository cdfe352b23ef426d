#include "session/report.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/printable.h"
#include "effect/effect_list.h"
#include "session/note.h"
#include "session/output.h"
#include "session/terminal.h"

namespace pocketray {

std::string shown(std::string text) {
  make_printable(&text[0], text.size());
  return text;
}

void print_note(const std::string& text) {
  const std::string line = shown(text);
  std::fprintf(stderr, "pocketray: %s\n", wants_ascii() ? as_ascii(line).c_str() : line.c_str());
}

int report(const Status& status) {
  if (status.ok) return kExitDone;
  print_note(status.message);
  return kExitInput;
}

Status write_json(const std::string& path, const Json& json) {
  return write_file(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void print_effects(const EffectPlan& plan) {
  std::printf("effects\n");
  for (const EffectRow& row : kEffectList) {
    const EffectDecision& d = plan.decisions[static_cast<int>(row.effect)];
    std::printf("  %-18s %-4s %s\n", row.name, d.on ? "on" : "-", d.reason);
  }
}

void print_memory(const MemoryPlan& plan) {
  char text[4096];
  draw_memory_plan(plan, text, sizeof text);
  std::printf("memory\n%s", text);
}

Json effects_json(const EffectPlan& plan) {
  Json list = Json::array();
  for (const EffectRow& row : kEffectList) {
    const EffectDecision& d = plan.decisions[static_cast<int>(row.effect)];
    list.push_back({{"name", row.name}, {"on", d.on}, {"reason", d.reason}});
  }
  return list;
}

Json memory_json(const MemoryPlan& plan) {
  Json parts = Json::array();
  for (int i = 0; i < plan.part_count; ++i)
    parts.push_back({{"name", plan.parts[i].name},
                     {"arena", kArenaNames[static_cast<int>(plan.parts[i].arena)]},
                     {"bytes", plan.parts[i].bytes}});
  return {{"parts", parts}, {"total_bytes", plan.total_bytes}, {"limit_bytes", plan.limit_bytes}};
}

std::string emulation_text(const Pace& pace) {
  if (!pace.device) return "";
  char text[80];
  std::snprintf(text, sizeof text, ", emulating %.40s: %.*g times slower", pace.device, pace.slowdown < 1000 ? 3 : 6,
                pace.slowdown);
  return text;
}

std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(static_cast<std::size_t>(at), " ");
  return digits;
}

std::string counted(std::uint64_t value, const char* noun) {
  return grouped(value) + " " + noun + (value == 1 ? "" : "s");
}

}  // namespace pocketray
