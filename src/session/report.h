// Output of commands: one line for an error, tables for people, JSON for programs.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "engine/renderer.h"

namespace pocketray {

// Exit statuses (DESIGN: "Commands").
constexpr int kExitDone = 0, kExitInput = 1, kExitUsage = 2, kExitInterrupted = 3;

using Json = nlohmann::ordered_json;

// Prints "pocketray: message" on stderr when the status is an error; returns the exit status.
int report(const Status& status);

// Writes pretty JSON to a file, or to stdout for "-".
Status write_json(const std::string& path, const Json& json);

void print_effects(const EffectPlan& plan);
void print_memory(const MemoryPlan& plan);
Json effects_json(const EffectPlan& plan);
Json memory_json(const MemoryPlan& plan);

// ", emulating pi-zero: 550 times slower", or empty.
std::string emulation_text(const Pace& pace);

// Groups digits: "12 345 678".
std::string grouped(std::uint64_t value);
// Groups digits and adds a noun: "1 light", "12 345 lights".
std::string counted(std::uint64_t value, const char* noun);

}  // namespace pocketray
