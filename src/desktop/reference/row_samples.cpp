#include "desktop/reference/row_samples.h"

#include "base/check.h"

namespace pocketray {

RowSamples take_row(const Reference& reference, Transport transport, std::uint32_t row, const SampleRange& samples) {
  const auto width = static_cast<std::size_t>(reference.world.frame->view.camera.width);
  CHECK_LT(row, static_cast<std::uint32_t>(reference.world.frame->view.camera.height));
  CHECK_LT(samples.begin, samples.end);
  RowSamples taken = {row, samples, std::vector<ExactSum>(kReferenceHalfCount * width * 3)};
  for (std::uint32_t half = 0; half < kReferenceHalfCount; ++half)
    take_half(reference, transport, half, row, samples, taken.sums.data() + half * width * 3);
  return taken;
}

Status merge(const RowSamples& taken, Accumulation* a) {
  CHECK(a != nullptr);
  const std::size_t numbers = std::size_t(a->width) * 3;
  const SampleRange& range = taken.samples;
  if (taken.row >= a->height || taken.sums.size() != kReferenceHalfCount * numbers || range.begin >= range.end ||
      range.end > kReferenceSampleMax)
    return failure("samples of a row that the picture does not have");
  if (sample_count(missing_samples(a->rows[taken.row], range)) < range.end - range.begin)
    return failure("samples %u … %u of row %u were taken twice", range.begin, range.end - 1, taken.row);
  add_samples(range, &a->rows[taken.row]);
  for (std::uint32_t half = 0; half < kReferenceHalfCount; ++half)
    for (std::size_t i = 0; i < numbers; ++i)
      add(taken.sums[half * numbers + i], &a->sums[half][taken.row * numbers + i]);
  return success();
}

}  // namespace pocketray
