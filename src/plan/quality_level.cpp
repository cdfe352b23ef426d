#include "plan/quality_level.h"

#include <cstring>

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {

bool find_quality_level(const char* name, QualityLevel* level) {
  CHECK(name != nullptr && level != nullptr);
  for (int i = 0; i < kQualityLevelCount; ++i)
    if (std::strcmp(name, kQualityLevelNames[i]) == 0) return *level = static_cast<QualityLevel>(i), true;
  return false;
}

Candidate level_of(const Front& measured, QualityLevel level) {
  CHECK_GT(measured.count, 0u);
  CHECK(errors_known(measured));
  Front front = measured;
  sort_front(&front);
  const double fastest = static_cast<double>(front.candidates[0].ns_per_pixel);
  const double slowest = static_cast<double>(front.candidates[front.count - 1].ns_per_pixel);
  const double share = static_cast<double>(static_cast<int>(level)) / (kQualityLevelCount - 1);
  constexpr double kRounding = 1 + 1e-6;  // prices are floats
  const double most = fastest * det_exp(share * det_log(slowest / fastest)) * kRounding;
  std::uint32_t chosen = level == QualityLevel::best ? front.count - 1 : 0;
  while (chosen + 1 < front.count && static_cast<double>(front.candidates[chosen + 1].ns_per_pixel) <= most) ++chosen;
  return front.candidates[chosen];
}

Quality builtin_level(QualityLevel level, EffectMask effects) {
  Quality q;
  switch (level) {
    case QualityLevel::draft:
      q.ray_depth = 2, q.points_per_area_light = 1, q.cut_off_levels = 4;
      q.selective_contrast = 0.5f, q.resolution = Resolution::half, q.light_tolerance = 0.5f;
      break;
    case QualityLevel::low:
      q.ray_depth = 4, q.points_per_area_light = 2, q.selective_contrast = 0.25f, q.light_tolerance = 0.25f;
      break;
    case QualityLevel::medium:
      break;
    case QualityLevel::high:
      q.edge_samples = 8, q.points_per_area_light = 16, q.environment_shadows = 64, q.virtual_lights = 256;
      break;
    case QualityLevel::best:
      q.samples_per_pixel = 16, q.environment_shadows = 128, q.virtual_lights = 512;
      break;
  }
  if (level >= QualityLevel::high && lacks_indirect_light(effects)) {
    q.indirect = indirect_choice(Effect::instant_radiosity);
    q.compensation = Compensation::rays;
  } else {
    q.virtual_lights = Quality().virtual_lights;
  }
  return q;
}

}  // namespace pocketray
