#include "wire/light_coder.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "wire/pixel_model.h"

namespace pocketray {
namespace {

constexpr int kChannels = 3;
// Levels, and the excess of one over another, have 13 bits without the sign.
constexpr std::uint32_t kDifferenceBits = 14;
static_assert(kLightLevelMax < 1u << (kDifferenceBits - 1), "differences of levels fit");

// Shared by green's levels and by the excess of red's and blue's over green's.
struct DifferenceModel {
  Probability differs[kActivities], falls[kActivities];
  NumberModelOf<kDifferenceBits> size[kActivities];
};
struct LightModels {
  DifferenceModel of[kChannels];
};
static_assert(sizeof(LightModels) % sizeof(Probability) == 0, "all members are probabilities");

template <class Coder>
int code_difference(Coder& coder, DifferenceModel* m, int activity, int value) {
  if (!coder.bit(&m->differs[activity], value != 0)) return 0;
  const bool falls = coder.bit(&m->falls[activity], value < 0) != 0;
  const auto size = static_cast<int>(
      code_number(&coder, &m->size[activity], kDifferenceBits, static_cast<std::uint32_t>(value < 0 ? -value : value)));
  return falls ? -size : size;
}

// Extrapolates the values on the left, above and between them, at an edge or on a slope [Weinberger 2000, sec.
// III-A].
int predicted(int left, int above, int corner) {
  if (corner >= std::max(left, above)) return std::min(left, above);
  if (corner <= std::min(left, above)) return std::max(left, above);
  return left + above - corner;
}

struct Levels {
  int channel[kChannels];  // green; red − green; blue − green
};
constexpr int kGreen = 1;

Levels levels_of(const Vec3& light) {
  const int green = static_cast<int>(light_level(light.y));
  return {{green, static_cast<int>(light_level(light.x)) - green, static_cast<int>(light_level(light.z)) - green}};
}
// Returns false if a level is out of range.
bool light_of(const Levels& l, Vec3* light) {
  for (int c = 0; c < kChannels; ++c) {
    const int level = c == 0 ? l.channel[0] : l.channel[0] + l.channel[c];
    if (level < 0 || level > static_cast<int>(kLightLevelMax)) return false;
    (*light)[c == 0 ? kGreen : c == 1 ? 0 : 2] = light_of_level(static_cast<std::uint32_t>(level));
  }
  return true;
}

// Context from the differences coded on the left and above.
int activity_of(int left, int above) { return std::min(left + above, static_cast<int>(kActivities) - 1); }

// Codes the lights in order; `wanted` returns a light's levels, given the predicted ones.
template <class Coder, class Wanted>
bool code_light(Coder& coder, std::uint32_t columns, std::uint32_t rows, Vec3* light, Wanted wanted) {
  CHECK_LE(columns, kLightColumnsMax);
  LightModels models;
  std::fill_n(&models.of[0].differs[0], sizeof models / sizeof(Probability), kEven);
  std::uint8_t above[kChannels][kLightColumnsMax] = {};  // sizes of the differences coded last in each column
  for (std::uint32_t row = 0; row < rows; ++row) {
    int left[kChannels] = {};
    for (std::uint32_t column = 0; column < columns; ++column) {
      Vec3* at = &light[row * columns + column];
      const Levels a = column > 0 ? levels_of(at[-1])
                       : row > 0  ? levels_of(at[-static_cast<std::ptrdiff_t>(columns)])
                                  : Levels{};
      const Levels b = row > 0 ? levels_of(at[-static_cast<std::ptrdiff_t>(columns)]) : a;
      const Levels corner = row > 0 && column > 0 ? levels_of(at[-static_cast<std::ptrdiff_t>(columns) - 1])
                            : row > 0             ? b
                                                  : a;
      Levels level;
      for (int c = 0; c < kChannels; ++c) level.channel[c] = predicted(a.channel[c], b.channel[c], corner.channel[c]);
      const Levels want = wanted(*at, level);
      for (int c = 0; c < kChannels; ++c) {
        const int difference = code_difference(coder, &models.of[c], activity_of(left[c], above[c][column]),
                                               want.channel[c] - level.channel[c]);
        level.channel[c] += difference;
        left[c] = std::min(std::abs(difference), static_cast<int>(kActivities));
        above[c][column] = static_cast<std::uint8_t>(left[c]);
      }
      if (!light_of(level, at)) return false;
    }
  }
  return true;
}

}  // namespace

std::uint32_t light_level(float value) {
  if (!(value > 0)) return value <= 0 ? 0 : kLightLevelMax;
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return std::min((bits + (1u << (kLightLevelShift - 1))) >> kLightLevelShift, kLightLevelMax);
}

float light_of_level(std::uint32_t level) {
  CHECK_LE(level, kLightLevelMax);
  const std::uint32_t bits = level << kLightLevelShift;
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

std::size_t encode_light(Vec3* light, std::uint32_t columns, std::uint32_t rows, float faintest, std::uint8_t* bytes) {
  CHECK(light != nullptr && bytes != nullptr && faintest >= 0);
  CHECK(columns > 0 && rows > 0);
  const std::size_t count = std::size_t(columns) * rows;
  RangeEncoder coder(bytes, light_bytes_max(count) - 1);
  const Vec3 least = {faintest, faintest, faintest};
  const bool coded = code_light(coder, columns, rows, light, [&](const Vec3& at, const Levels& expected) {
    Vec3 unused;
    return at.x < 0 && light_of(expected, &unused) ? expected : levels_of(max(at, least));
  });
  CHECK(coded);
  const std::size_t byte_count = coder.finish();
  if (!coder.overflows()) return byte_count;
  for (std::size_t i = 0; i < count; ++i)
    for (int c = 0; c < kChannels; ++c) {
      const std::uint32_t level = light_level(light[i][c]);
      light[i][c] = light_of_level(level);
      *bytes++ = static_cast<std::uint8_t>(level), *bytes++ = static_cast<std::uint8_t>(level >> 8);
    }
  return light_bytes_max(count);
}

bool decode_light(const std::uint8_t* bytes, std::size_t byte_count, std::uint32_t columns, std::uint32_t rows,
                  Vec3* light) {
  CHECK(light != nullptr && (bytes != nullptr || byte_count == 0));
  const std::size_t count = std::size_t(columns) * rows;
  if (byte_count > light_bytes_max(count)) return false;
  if (byte_count < light_bytes_max(count)) {
    if (byte_count > 0 && bytes[byte_count - 1] == 0) return false;
    RangeDecoder coder(bytes, byte_count);
    return code_light(coder, columns, rows, light, [](const Vec3&, const Levels& expected) { return expected; }) &&
           coder.is_at_end();
  }
  for (std::size_t i = 0; i < count; ++i)
    for (int c = 0; c < kChannels; ++c, bytes += 2) {
      const std::uint32_t level = std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8;
      if (level > kLightLevelMax) return false;
      light[i][c] = light_of_level(level);
    }
  return true;
}

}  // namespace pocketray
