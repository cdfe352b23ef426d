// Fronts as text. A file's bytes are hostile: nothing is read beyond them, every length is bounded.
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "plan/front.h"

namespace pocketray {
namespace {

constexpr char kFirstLine[] = "pocketray-front 2";
constexpr char kFirstWord[] = "pocketray-front";
// Settings come first, in list order.
enum Key : int { flip = kSettingCount, flip888, ns, kKeyCount };
static_assert(kKeyCount <= 32, "one bit per key");
const char* key_name(int key) {
  constexpr const char* kOthers[] = {"flip", "flip888", "ns"};
  return key < kSettingCount ? kSettingList[key].name : kOthers[key - kSettingCount];
}
bool is_error(int key) { return key == flip || key == flip888; }

struct Text {
  const char* begin;
  std::size_t count;
};

bool equals(const Text& text, const char* word) {
  return std::strlen(word) == text.count && std::memcmp(word, text.begin, text.count) == 0;
}

// Removes the text up to and including the first `end` from the front of *rest; returns it without the end.
Text cut(Text* rest, char end) {
  const void* at = rest->count ? std::memchr(rest->begin, end, rest->count) : nullptr;
  std::size_t count = at ? static_cast<std::size_t>(static_cast<const char*>(at) - rest->begin) : rest->count;
  Text head = {rest->begin, count};
  std::size_t skipped = at ? count + 1 : count;
  rest->begin += skipped;
  rest->count -= skipped;
  return head;
}

bool read_count(const Text& text, std::uint32_t* value) {
  if (text.count == 0 || text.count > 6) return false;
  *value = 0;
  for (std::size_t i = 0; i < text.count; ++i) {
    if (text.begin[i] < '0' || text.begin[i] > '9') return false;
    *value = *value * 10 + static_cast<std::uint32_t>(text.begin[i] - '0');
  }
  return true;
}

bool read_real(const Text& text, float* value) {
  char digits[32];
  if (text.count == 0 || text.count >= sizeof digits) return false;
  for (std::size_t i = 0; i < text.count; ++i)
    if (!std::strchr("0123456789.eE+-", text.begin[i]) || text.begin[i] == 0) return false;
  std::memcpy(digits, text.begin, text.count);
  digits[text.count] = 0;
  char* end;
  *value = std::strtof(digits, &end);
  return *end == 0 && end != digits && std::isfinite(*value);
}

// Returns false if the text is not a value of the setting's kind; check_setting() checks the limits.
bool read_setting(const SettingRow& row, const Text& text, double* value) {
  std::uint32_t count;
  float real;
  switch (row.field.kind) {
    case SettingKind::count:
      return read_count(text, &count) && (*value = count, true);
    case SettingKind::real:
      return read_real(text, &real) && (*value = static_cast<double>(real), true);
    case SettingKind::choice:
      return find_choice(row, text.begin, text.count, value);
  }
  return false;
}

bool read_value(int key, const Text& text, Candidate* c, double* setting) {
  if (is_error(key)) {
    float* error = key == flip ? &c->flip : &c->flip888;
    return read_real(text, error) && *error >= 0 && *error <= 1;
  }
  if (key == ns)
    return read_real(text, &c->ns_per_pixel) && c->ns_per_pixel >= kPriceNsMin && c->ns_per_pixel <= kPriceNsMax;
  return read_setting(kSettingList[key], text, setting);
}

// Makes a file's text safe to print in messages: it may contain anything.
struct Printable {
  char text[41];
  explicit Printable(const Text& t) {
    std::size_t count = t.count < sizeof text - 1 ? t.count : sizeof text - 1;
    for (std::size_t i = 0; i < count; ++i) text[i] = t.begin[i] >= ' ' && t.begin[i] < 127 ? t.begin[i] : '?';
    text[count] = 0;
  }
};

Status read_candidate(Text line, unsigned line_number, Candidate* c) {
  unsigned seen = 0;
  double settings[kKeyCount] = {};
  *c = Candidate();
  while (line.count > 0) {
    Text value = cut(&line, ' ');
    if (value.count == 0) continue;
    Printable shown(value);
    Text name = cut(&value, '=');
    int key = 0;
    while (key < kKeyCount && !equals(name, key_name(key))) ++key;
    if (key == kKeyCount || (seen >> key & 1u))
      return failure("line %u: '%s' is an unknown or repeated setting", line_number, shown.text);
    if (!read_value(key, value, c, &settings[key]))
      return failure("line %u: '%s' has an invalid value", line_number, shown.text);
    seen |= 1u << key;
  }
  for (int key = 0; key < kSettingCount; ++key)
    if (!(seen >> key & 1u) && kSettingList[key].may_be_absent)
      settings[key] = kSettingList[key].field.get(Quality()), seen |= 1u << key;
  for (int key = 0; key < kKeyCount; ++key)
    if (!is_error(key) && !(seen >> key & 1u)) return failure("line %u: %s= is missing", line_number, key_name(key));
  for (int i = 0; i < kSettingCount; ++i) {
    Status status = check_setting(kSettingList[i], settings[i]);
    if (!status.ok) return failure("line %u: %.300s", line_number, status.message);
    kSettingList[i].field.set(c, settings[i]);
  }
  return success();
}

Status parse_lines(Text rest, Front* front) {
  unsigned line_number = 0;
  bool is_front = false;
  while (rest.count > 0) {
    Text line = cut(&rest, '\n');
    if (line.count > 0 && line.begin[line.count - 1] == '\r') --line.count;
    if (++line_number == 1) {
      is_front = equals(line, kFirstLine);
      if (is_front) continue;
      if (line.count >= sizeof kFirstWord && std::memcmp(line.begin, kFirstWord, sizeof kFirstWord - 1) == 0)
        return failure("line 1: '%s': this program only reads version 2: measure the front with `pocketray accuracy`",
                       Printable(line).text);
      break;
    }
    if (line.count == 0 || line.begin[0] == '#') continue;
    if (line.count > kFrontLineMax) return failure("line %u: longer than %zu characters", line_number, kFrontLineMax);
    if (front->count == kFrontCandidateMax)
      return failure("line %u: more than %u candidates", line_number, kFrontCandidateMax);
    Candidate* c = &front->candidates[front->count];
    RETURN_IF_ERROR(read_candidate(line, line_number, c));
    for (std::uint32_t i = 0; i < front->count; ++i)
      if (same_quality(front->candidates[i], *c))
        return failure("line %u: these settings are already listed above", line_number);
    ++front->count;
  }
  if (!is_front) return failure("line 1: a front begins with '%s'", kFirstLine);
  if (front->count == 0) return failure("line %u: the front has no candidate", line_number);
  return success();
}

// Appends to a terminated text, truncated to its size.
__attribute__((format(printf, 4, 5))) void append(char* text, std::size_t size, std::size_t* length, const char* format,
                                                  ...) {
  CHECK_LT(*length, size);
  va_list arguments;
  va_start(arguments, format);
  int count = std::vsnprintf(text + *length, size - *length, format, arguments);
  va_end(arguments);
  *length += count < 0 ? 0 : static_cast<std::size_t>(count);
  if (*length >= size) *length = size - 1;
}

struct Value {
  char text[32];
  Value(const SettingRow& row, const Quality& quality, int digits) {
    describe_value(row, row.field.get(quality), digits, text, sizeof text);
  }
};

void append_quality(const Quality& quality, char* text, std::size_t size, std::size_t* length) {
  CHECK(text != nullptr);
  constexpr int kDigits = 9;  // as many as a float needs
  for (const SettingRow& row : kSettingList) {
    if (row.may_be_absent && row.field.get(quality) == row.field.get(Quality())) continue;
    append(text, size, length, "%s%s=%s", *length && text[*length - 1] != '\n' ? " " : "", row.name,
           Value(row, quality, kDigits).text);
  }
}

}  // namespace

Status parse_front(const void* bytes, std::size_t byte_count, Front* front) {
  CHECK(front != nullptr);
  CHECK(bytes != nullptr || byte_count == 0);
  *front = Front();
  Status status = parse_lines({static_cast<const char*>(bytes), byte_count}, front);
  if (!status.ok) *front = Front();
  return status;
}

std::size_t format_front(const Front& front, char* text, std::size_t size) {
  CHECK(text != nullptr && size > 0);
  CHECK_LE(front.count, kFrontCandidateMax);
  std::size_t length = 0;
  append(text, size, &length, "%s\n", kFirstLine);
  for (std::uint32_t i = 0; i < front.count; ++i) {
    const Candidate& c = front.candidates[i];
    append_quality(c, text, size, &length);
    if (!std::isnan(c.flip)) append(text, size, &length, " flip=%.9g", static_cast<double>(c.flip));
    if (!std::isnan(c.flip888)) append(text, size, &length, " flip888=%.9g", static_cast<double>(c.flip888));
    append(text, size, &length, " ns=%.9g\n", static_cast<double>(c.ns_per_pixel));
  }
  return length;
}

void format_quality(const Quality& quality, char* text, std::size_t size) {
  std::size_t length = 0;
  append_quality(quality, text, size, &length);
}

void format_hud_quality(const Quality& quality, char* text, std::size_t size) {
  CHECK(text != nullptr && size > 0);
  constexpr int kDigits = 2;
  std::size_t length = 0;
  text[0] = 0;
  for (const SettingRow& row : kSettingList)
    if (row.hud_name)
      append(text, size, &length, "%s%s %s", length ? " " : "", row.hud_name, Value(row, quality, kDigits).text);
}

void describe_change(const Quality& before, const Quality& after, char* text, std::size_t size) {
  CHECK(text != nullptr && size > 0);
  constexpr int kDigits = 3;
  std::size_t length = 0;
  text[0] = 0;
  for (const SettingRow& row : kSettingList)
    if (row.field.get(before) != row.field.get(after))
      append(text, size, &length, "%s%s %s to %s", length ? ", " : "", row.name, Value(row, before, kDigits).text,
             Value(row, after, kDigits).text);
  if (length == 0) append(text, size, &length, "nothing");
}

}  // namespace pocketray
