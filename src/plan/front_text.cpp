// Fronts as text. A file's bytes are hostile until read: nothing is looked at beyond them, every length is bounded.
#include <cinttypes>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "plan/front.h"
#include "plan/plan_effects.h"

namespace pocketray {
namespace {

constexpr char kFirstLine[] = "pocketray-front 1";
constexpr char kFirstWord[] = "pocketray-front";
constexpr const char* kFilterNames[] = {"scene", "nearest", "bilinear"};
constexpr const char* kNormalNames[] = {"scene", "flat"};
constexpr const char* kKeys[] = {"samples",        "depth",   "area-lights", "cut-off",
                                 "texture-filter", "normals", "flip",        "ns"};
enum Key : int { samples, depth, area_lights, cut_off, texture_filter, normals, flip, ns, kKeyCount };

struct Text {
  const char* begin;
  std::size_t count;
};

bool equals(const Text& text, const char* word) {
  return std::strlen(word) == text.count && std::memcmp(word, text.begin, text.count) == 0;
}

// Cuts the text before the first `end` off *rest, and the end, too.
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

template <class T, std::size_t n>
bool read_name(const Text& text, const char* const (&names)[n], T* value) {
  for (std::size_t i = 0; i < n; ++i)
    if (equals(text, names[i])) return *value = static_cast<T>(i), true;
  return false;
}

bool read_value(int key, const Text& text, Candidate* c) {
  switch (key) {
    case samples:
      return read_count(text, &c->samples_per_pixel);
    case depth:
      return read_count(text, &c->ray_depth);
    case area_lights:
      return read_count(text, &c->points_per_area_light);
    case cut_off:
      return read_real(text, &c->cut_off_levels);
    case texture_filter:
      return read_name(text, kFilterNames, &c->texture_filter);
    case normals:
      return read_name(text, kNormalNames, &c->normals);
    case flip:
      return read_real(text, &c->flip) && c->flip >= 0 && c->flip <= 1;
    default:
      return read_real(text, &c->ns_per_pixel) && c->ns_per_pixel >= kPriceNsMin && c->ns_per_pixel <= kPriceNsMax;
  }
}

// For messages: what a file says may be anything.
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
  *c = Candidate();
  while (line.count > 0) {
    Text value = cut(&line, ' ');
    if (value.count == 0) continue;
    Printable shown(value);
    Text name = cut(&value, '=');
    int key = 0;
    while (key < kKeyCount && !equals(name, kKeys[key])) ++key;
    if (key == kKeyCount || (seen >> key & 1u))
      return failure("line %u: '%s' is no setting, or the second of its name", line_number, shown.text);
    if (!read_value(key, value, c))
      return failure("line %u: '%s' has no value that it may have", line_number, shown.text);
    seen |= 1u << key;
  }
  for (int key = 0; key < kKeyCount; ++key)
    if (key != flip && !(seen >> key & 1u)) return failure("line %u: %s= is missing", line_number, kKeys[key]);
  Status status = validate_settings(with_candidate(Settings(), *c));
  return status.ok ? status : failure("line %u: %.300s", line_number, status.message);
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
        return failure("line 1: '%s': this program reads version 1 alone", Printable(line).text);
      break;
    }
    if (line.count == 0 || line.begin[0] == '#') continue;
    if (line.count > kFrontLineMax) return failure("line %u: longer than %zu characters", line_number, kFrontLineMax);
    if (front->count == kFrontCandidateMax)
      return failure("line %u: there may be %u candidates at most", line_number, kFrontCandidateMax);
    Candidate* c = &front->candidates[front->count];
    RETURN_IF_ERROR(read_candidate(line, line_number, c));
    for (std::uint32_t i = 0; i < front->count; ++i)
      if (same_quality(front->candidates[i], *c))
        return failure("line %u: these settings stand above already", line_number);
    ++front->count;
  }
  if (!is_front) return failure("line 1: a front begins with '%s'", kFirstLine);
  if (front->count == 0) return failure("line %u: no candidate stands in it", line_number);
  return success();
}

// Appends to a terminated text, cut to its size.
__attribute__((format(printf, 4, 5))) void append(char* text, std::size_t size, std::size_t* length, const char* format,
                                                  ...) {
  va_list arguments;
  va_start(arguments, format);
  int count = std::vsnprintf(text + *length, size - *length, format, arguments);
  va_end(arguments);
  *length += count < 0 ? 0 : static_cast<std::size_t>(count);
  if (*length >= size) *length = size - 1;
}

void append_quality(const Candidate& c, char* text, std::size_t size, std::size_t* length) {
  append(text, size, length, "samples=%" PRIu32 " depth=%" PRIu32 " area-lights=%" PRIu32, c.samples_per_pixel,
         c.ray_depth, c.points_per_area_light);
  append(text, size, length, " cut-off=%.9g texture-filter=%s normals=%s", static_cast<double>(c.cut_off_levels),
         kFilterNames[static_cast<int>(c.texture_filter)], kNormalNames[static_cast<int>(c.normals)]);
}

}  // namespace

Status parse_front(const void* bytes, std::size_t byte_count, Front* front) {
  *front = Front();
  Status status = parse_lines({static_cast<const char*>(bytes), byte_count}, front);
  if (!status.ok) *front = Front();
  return status;
}

std::size_t format_front(const Front& front, char* text, std::size_t size) {
  std::size_t length = 0;
  append(text, size, &length, "%s\n", kFirstLine);
  for (std::uint32_t i = 0; i < front.count; ++i) {
    const Candidate& c = front.candidates[i];
    append_quality(c, text, size, &length);
    if (!std::isnan(c.flip)) append(text, size, &length, " flip=%.9g", static_cast<double>(c.flip));
    append(text, size, &length, " ns=%.9g\n", static_cast<double>(c.ns_per_pixel));
  }
  return length;
}

void format_quality(const Candidate& c, char* text, std::size_t size) {
  std::size_t length = 0;
  append_quality(c, text, size, &length);
}

void describe_change(const Candidate& before, const Candidate& after, char* text, std::size_t size) {
  std::size_t length = 0;
  text[0] = 0;
  auto comma = [&] { return length ? ", " : ""; };
  auto count = [&](const char* name, std::uint32_t a, std::uint32_t b) {
    if (a != b) append(text, size, &length, "%s%s %" PRIu32 " to %" PRIu32, comma(), name, a, b);
  };
  count("samples", before.samples_per_pixel, after.samples_per_pixel);
  count("depth", before.ray_depth, after.ray_depth);
  count("area-lights", before.points_per_area_light, after.points_per_area_light);
  if (before.cut_off_levels != after.cut_off_levels)
    append(text, size, &length, "%scut-off %.3g to %.3g", comma(), static_cast<double>(before.cut_off_levels),
           static_cast<double>(after.cut_off_levels));
  if (before.texture_filter != after.texture_filter)
    append(text, size, &length, "%stexture-filter %s to %s", comma(),
           kFilterNames[static_cast<int>(before.texture_filter)], kFilterNames[static_cast<int>(after.texture_filter)]);
  if (before.normals != after.normals)
    append(text, size, &length, "%snormals %s to %s", comma(), kNormalNames[static_cast<int>(before.normals)],
           kNormalNames[static_cast<int>(after.normals)]);
  if (length == 0) append(text, size, &length, "nothing");
}

}  // namespace pocketray
