#include "desktop/reference/accumulation.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {

Accumulation empty_accumulation(const std::string& key, std::uint32_t width, std::uint32_t height) {
  CHECK(width > 0 && height > 0);
  Accumulation a;
  a.key = key, a.width = width, a.height = height;
  a.rows.resize(height);
  for (std::vector<ExactSum>& half : a.sums) half.resize(std::size_t(width) * height * 3);
  return a;
}

void take_half(const Reference& reference, Transport transport, std::uint32_t half, std::uint32_t row,
               const SampleRange& samples, ExactSum* sums) {
  CHECK_LT(half, kReferenceHalfCount);
  ReferenceOptions options;
  options.transport = transport;
  options.first_sample = samples.begin;
  options.samples_per_pixel = samples.end - samples.begin;
  options.seed = half + 1;
  add_reference(reference, options, row, sums);
}

void accumulate(const Reference& reference, Transport transport, std::uint32_t row, const SampleRange& samples,
                Accumulation* a) {
  CHECK_LT(row, a->height);
  CHECK_EQ(a->width, static_cast<std::uint32_t>(reference.world.frame->view.camera.width));
  add_samples(samples, &a->rows[row]);
  for (std::uint32_t half = 0; half < kReferenceHalfCount; ++half)
    take_half(reference, transport, half, row, samples, a->sums[half].data() + std::size_t(row) * a->width * 3);
}

Status merge(const Accumulation& other, Accumulation* a) {
  CHECK(other.key == a->key);
  CHECK(other.width == a->width && other.height == a->height);
  for (std::uint32_t row = 0; row < a->height; ++row)
    for (const SampleRange& range : other.rows[row])
      if (sample_count(missing_samples(a->rows[row], range)) < range.end - range.begin)
        return failure("both have samples %u … %u of row %u: merge runs with different --part", range.begin,
                       range.end - 1, row);
  for (std::uint32_t row = 0; row < a->height; ++row)
    for (const SampleRange& range : other.rows[row]) add_samples(range, &a->rows[row]);
  for (std::uint32_t half = 0; half < kReferenceHalfCount; ++half)
    for (std::size_t i = 0; i < a->sums[half].size(); ++i) add(other.sums[half][i], &a->sums[half][i]);
  return success();
}

std::uint64_t samples_of(const Accumulation& a) {
  std::uint64_t least = kReferenceSampleMax;
  for (const SampleSet& row : a.rows) least = std::min(least, sample_count(row));
  return kReferenceHalfCount * least;
}

std::vector<Vec3> mean_of_half(const Accumulation& a, std::uint32_t half) {
  CHECK_LT(half, kReferenceHalfCount);
  std::vector<Vec3> mean(std::size_t(a.width) * a.height, Vec3{0, 0, 0});
  for (std::size_t i = 0; i < mean.size(); ++i) {
    std::uint64_t count = sample_count(a.rows[i / a.width]);
    if (count == 0) continue;
    for (std::size_t c = 0; c < 3; ++c)
      mean[i][static_cast<int>(c)] = static_cast<float>(value_of(a.sums[half][3 * i + c]) / static_cast<double>(count));
  }
  return mean;
}

}  // namespace pocketray
