// The columns of setting_list.h.
#pragma once
#include <initializer_list>
#include <limits>
#include <type_traits>

#include "base/limit_list.h"
#include "effect/settings.h"

namespace pocketray {

enum class SettingKind : std::uint8_t { count, real, choice };

// Access to a setting's member of Quality. Values are doubles, which hold every count and float; a choice is its
// enumerator's number.
struct SettingField {
  SettingKind kind;
  Quantity quantity;         // provides the limits; a choice has only its names
  const char* const* names;  // choice: in enumerator order
  int name_count;
  double (*get)(const Quality& quality);
  void (*set)(Quality* quality, double value);  // the value must be within the limits
};

template <auto member>
double get_member(const Quality& quality) {
  return static_cast<double>(quality.*member);
}
template <auto member>
void set_member(Quality* quality, double value) {
  quality->*member = static_cast<std::decay_t<decltype(quality->*member)>>(value);
}

template <std::uint32_t Quality::*member>
constexpr SettingField count_field(Quantity limits) {
  return {SettingKind::count, limits, nullptr, 0, get_member<member>, set_member<member>};
}
template <float Quality::*member>
constexpr SettingField real_field(Quantity limits) {
  return {SettingKind::real, limits, nullptr, 0, get_member<member>, set_member<member>};
}
template <auto member, std::size_t n>
constexpr SettingField choice_field(const char* const (&names)[n]) {
  return {SettingKind::choice, Quantity(), names, static_cast<int>(n), get_member<member>, set_member<member>};
}

constexpr std::size_t text_length(const char* text) {
  std::size_t length = 0;
  while (text[length]) ++length;
  return length;
}

constexpr int kSweepValuesMax = 12;
struct SweepValues {
  double values[kSweepValuesMax] = {};
  int count = 0;
  constexpr SweepValues(std::initializer_list<double> list) {
    for (double value : list) values[count++] = value;
  }
};

constexpr EffectMask kAlways = ~EffectMask(0);
constexpr double kAsAsked = std::numeric_limits<double>::quiet_NaN();

struct SettingRow {
  const char* name;      // "samples": the name of the option --samples, and in fronts and sweeps
  const char* what;      // "rays through each pixel"
  const char* note;      // added to the option's help after `what` and the range; may be empty
  const char* hud_name;  // name in the overlay; null: not shown
  SettingField field;
  std::uint32_t wire_bytes;       // size in a request's settings, in list order; 0: shared frames do not use it
  EffectMask effects;             // effects that it controls; a sweep requires them
  EffectMask seen_with;           // it changes pictures only with one of these
  bool places_lights;             // light points or the radiance bound depend on it
  double exact;                   // value for references; kAsAsked: as requested
  SweepValues sweep;              // least accurate first
  double (*price)(double value);  // relative cost of a frame; null: hardly depends on the value
  const char* theory;             // expected slope of RMSE over time; empty: theory predicts none
  bool may_be_absent = false;     // fronts omit the default: those written before the setting existed lack it
};

}  // namespace pocketray
