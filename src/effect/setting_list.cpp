#include "effect/setting_list.h"

#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/check.h"

namespace pocketray {

const SettingRow* find_setting(const char* name) {
  CHECK(name != nullptr);
  for (const SettingRow& row : kSettingList)
    if (std::strcmp(row.name, name) == 0) return &row;
  return nullptr;
}

bool within_setting(const SettingRow& row, double value) {
  const SettingField& field = row.field;
  CHECK(field.kind != SettingKind::choice || field.names != nullptr);
  if (field.kind == SettingKind::choice) return value >= 0 && value < field.name_count && value == std::floor(value);
  return within(field.quantity, value) && (field.kind == SettingKind::real || value == std::floor(value));
}

Status check_setting(const SettingRow& row, double value, const char* name) {
  if (within_setting(row, value)) return success();
  if (row.field.kind != SettingKind::choice) RETURN_IF_ERROR(check_limit(row.field.quantity, value, name));
  char range[128];
  describe_range(row, range, sizeof range);
  return failure("%s is %.10g: it must be %s", name ? name : row.name, value,
                 row.field.kind == SettingKind::choice ? range : "a whole number");
}

bool find_choice(const SettingRow& row, const char* name, std::size_t name_bytes, double* value) {
  CHECK(name != nullptr && value != nullptr);
  CHECK(row.field.kind == SettingKind::choice);
  CHECK_GT(row.field.name_count, 1);
  for (int i = 0; i < row.field.name_count; ++i) {
    const char* choice = row.field.names[i];
    if (std::strlen(choice) != name_bytes || std::memcmp(choice, name, name_bytes) != 0) continue;
    *value = i;
    return true;
  }
  return false;
}

void describe_range(const SettingRow& row, char* text, std::size_t size) {
  CHECK_GT(size, 0u);
  CHECK(text != nullptr);
  const SettingField& field = row.field;
  if (field.kind != SettingKind::choice) {
    const LimitRow& limits = limit_of(field.quantity);
    std::snprintf(text, size, "%.6g … %.6g", limits.low, limits.high);
    return;
  }
  CHECK_GT(field.name_count, 1);
  std::size_t length = 0;
  for (int i = 0; i < field.name_count && length < size; ++i) {
    const char* between = i == 0 ? "" : i + 1 < field.name_count ? ", " : " or ";
    length += static_cast<std::size_t>(std::snprintf(text + length, size - length, "%s%s", between, field.names[i]));
  }
}

void describe_value(const SettingRow& row, double value, int digits, char* text, std::size_t size) {
  CHECK(within_setting(row, value));
  CHECK_GT(digits, 0);
  CHECK(text != nullptr);
  CHECK_GT(size, 0u);
  if (row.field.kind == SettingKind::choice)
    std::snprintf(text, size, "%s", row.field.names[static_cast<int>(value)]);
  else if (row.field.kind == SettingKind::count)
    std::snprintf(text, size, "%.0f", value);
  else
    std::snprintf(text, size, "%.*g", digits, value);
}

bool same_quality(const Quality& a, const Quality& b) {
  for (const SettingRow& row : kSettingList)
    if (row.field.get(a) != row.field.get(b)) return false;
  return true;
}

bool same_lights(const Quality& a, const Quality& b) {
  for (const SettingRow& row : kSettingList)
    if (row.places_lights && row.field.get(a) != row.field.get(b)) return false;
  return true;
}

Settings reference_settings(const Settings& asked) {
  Settings settings = asked;
  for (const SettingRow& row : kSettingList)
    if (!std::isnan(row.exact)) row.field.set(&settings, row.exact);
  return settings;
}

}  // namespace pocketray
