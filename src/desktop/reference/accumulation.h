// An accumulating reference: sums of samples, in two halves with independent seeds whose difference tells the error.
// Sums are exact, and a sample depends only on seed, pixel and index. So the result is equal bit for bit, whichever
// runs take which samples and in whatever order their sums are added.
#pragma once
#include <string>

#include "base/status.h"
#include "desktop/reference/exact_sum.h"
#include "desktop/reference/reference.h"
#include "desktop/reference/sample_set.h"

namespace pocketray {

constexpr std::uint32_t kReferenceHalfCount = 2;
constexpr std::uint32_t kReferenceSampleMax = 1u << 24;  // per pixel and half

struct Accumulation {
  std::string key;  // everything on which the samples depend, as text
  std::uint32_t width = 0, height = 0;
  std::vector<SampleSet> rows;                      // samples included in a row's sums, per half
  std::vector<ExactSum> sums[kReferenceHalfCount];  // R, G, B per pixel
};

Accumulation empty_accumulation(const std::string& key, std::uint32_t width, std::uint32_t height);

// Adds the samples of a row and half to R, G, B of each of its pixels.
void take_half(const Reference& reference, Transport transport, std::uint32_t half, std::uint32_t row,
               const SampleRange& samples, ExactSum* sums);

// Adds samples, which the row must not have yet. Threads may add to different rows concurrently.
void accumulate(const Reference& reference, Transport transport, std::uint32_t row, const SampleRange& samples,
                Accumulation* accumulation);

// Adds another accumulation of equal key and size. Fails, adding nothing, if both have a sample in common.
Status merge(const Accumulation& other, Accumulation* accumulation);

// Samples per pixel, both halves together, of the row with the fewest.
std::uint64_t samples_of(const Accumulation& accumulation);
// Mean of a half, width × height radiances; black where there are no samples yet.
std::vector<Vec3> mean_of_half(const Accumulation& accumulation, std::uint32_t half);

// Encodes a PFM picture of the mean of both halves, which any program reads, followed by the sums.
std::vector<std::uint8_t> encode_accumulation(const Accumulation& accumulation);
// Decodes such a file, whatever it holds.
Status decode_accumulation(const std::uint8_t* bytes, std::size_t byte_count, Accumulation* accumulation);

}  // namespace pocketray
