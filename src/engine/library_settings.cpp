// The library's settings: lists of names and values, by the rows of effect/setting_list.h.
#include <cstring>

#include "base/check.h"
#include "effect/setting_list.h"
#include "engine/library.h"
#include "plan/quality_level.h"

namespace pocketray {
namespace {

static_assert(kSettingCount <= POCKETRAY_SETTINGS_MAX, "a list holds all settings");

Status find_row(const char* name, const SettingRow** row) {
  if (!name) return failure("the setting's name is a null pointer");
  *row = find_setting(name);
  if (!*row) return failure("there is no setting '%.60s': pocketray_setting_name() lists them", name);
  return success();
}

Status check_list(const pocketray_settings* settings) {
  RETURN_IF_ERROR(check_struct("the settings", settings, sizeof *settings));
  if (settings->count <= POCKETRAY_SETTINGS_MAX) return success();
  return failure("the settings' count is %u, more than %d: initialise them with POCKETRAY_SETTINGS_INIT",
                 settings->count, POCKETRAY_SETTINGS_MAX);
}

// Returns the place of a setting in the list, or settings.count.
std::uint32_t find_entry(const pocketray_settings& settings, const SettingRow& row) {
  std::uint32_t i = 0;
  while (i < settings.count && !(settings.list[i].name && std::strcmp(settings.list[i].name, row.name) == 0)) ++i;
  return i;
}

Status set_entry(pocketray_settings* settings, const SettingRow& row, double value) {
  RETURN_IF_ERROR(check_setting(row, value));
  const std::uint32_t at = find_entry(*settings, row);
  if (at == POCKETRAY_SETTINGS_MAX)
    return failure("the settings are full with entries that are none: use POCKETRAY_SETTINGS_INIT");
  if (at == settings->count) ++settings->count;
  settings->list[at].name = row.name;
  settings->list[at].value = value;
  return success();
}

Status set_choice(pocketray_settings* settings, const char* name, const char* choice) {
  RETURN_IF_ERROR(check_list(settings));
  const SettingRow* row;
  RETURN_IF_ERROR(find_row(name, &row));
  if (!choice) return failure("the choice of %s is a null pointer", row->name);
  if (row->field.kind != SettingKind::choice)
    return failure("%s is a number: set it by pocketray_set_number()", row->name);
  double value;
  if (find_choice(*row, choice, std::strlen(choice), &value)) return set_entry(settings, *row, value);
  char range[128];
  describe_range(*row, range, sizeof range);
  return failure("%s is '%.60s': it must be %s", row->name, choice, range);
}

Status set_number(pocketray_settings* settings, const char* name, double value) {
  RETURN_IF_ERROR(check_list(settings));
  const SettingRow* row;
  RETURN_IF_ERROR(find_row(name, &row));
  return set_entry(settings, *row, value);
}

Status set_quality(pocketray_settings* settings, const char* name) {
  RETURN_IF_ERROR(check_list(settings));
  QualityLevel level;
  if (!name || !find_quality_level(name, &level))
    return failure("the quality is '%.60s': it must be draft, low, medium, high or best", name ? name : "");
  const Quality quality = builtin_level(level, 0);
  for (const SettingRow& row : kSettingList) RETURN_IF_ERROR(set_entry(settings, row, row.field.get(quality)));
  return success();
}

Status get_number(const pocketray_settings* settings, const char* name, double* value) {
  RETURN_IF_ERROR(check_list(settings));
  const SettingRow* row;
  RETURN_IF_ERROR(find_row(name, &row));
  if (!value) return failure("the value's address is null");
  const std::uint32_t at = find_entry(*settings, *row);
  *value = at < settings->count ? settings->list[at].value : row->field.get(Quality());
  return success();
}

}  // namespace

Status read_settings(const pocketray_settings* given, Settings* settings) {
  CHECK(settings != nullptr);
  RETURN_IF_ERROR(check_list(given));
  Quality read = *settings;
  for (std::uint32_t i = 0; i < given->count; ++i) {
    const SettingRow* row;
    RETURN_IF_ERROR(find_row(given->list[i].name, &row));
    RETURN_IF_ERROR(check_setting(*row, given->list[i].value));
    row->field.set(&read, given->list[i].value);
  }
  *static_cast<Quality*>(settings) = read;
  return success();
}

void write_settings(const Settings& settings, pocketray_settings* result) {
  CHECK(result != nullptr);
  *result = POCKETRAY_SETTINGS_INIT;
  for (const SettingRow& row : kSettingList) {
    result->list[result->count].name = row.name;
    result->list[result->count++].value = row.field.get(settings);
  }
}

}  // namespace pocketray

using namespace pocketray;

const char* pocketray_setting_name(std::uint32_t index) {
  return index < kSettingCount ? kSettingList[index].name : nullptr;
}

const char* pocketray_choice_name(const char* setting, std::uint32_t index) {
  const SettingRow* row = setting ? find_setting(setting) : nullptr;
  if (!row || row->field.kind != SettingKind::choice) return nullptr;
  return index < static_cast<std::uint32_t>(row->field.name_count) ? row->field.names[index] : nullptr;
}

pocketray_result pocketray_set_number(pocketray_settings* settings, const char* name, double value) {
  return to_result(set_number(settings, name, value), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_set_quality(pocketray_settings* settings, const char* level) {
  return to_result(set_quality(settings, level), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_set_choice(pocketray_settings* settings, const char* name, const char* choice) {
  return to_result(set_choice(settings, name, choice), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_get_number(const pocketray_settings* settings, const char* name, double* value) {
  return to_result(get_number(settings, name, value), POCKETRAY_ERROR_ARGUMENT);
}
