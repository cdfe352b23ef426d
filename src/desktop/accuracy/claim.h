// Which differences between pictures can be claimed, though the reference that they are compared with is noisy.
#pragma once
#include "desktop/accuracy/result.h"

namespace pocketray {

// Blocks along each side of a picture in Distance; smaller pictures have a block for each pixel.
constexpr std::uint32_t kBlocksPerSide = 8;

// Means of the errors of width × height pixels over the blocks of the picture, row by row.
std::vector<float> block_means(const std::vector<float>& errors, std::uint32_t width, std::uint32_t height);

// Mean ꟻLIP without what the reference's noise adds, from that against the mean of its halves and against each half.
// The halves have twice the variance, to which ꟻLIP is proportional where it exceeds the noise [Richardson 1911]; a
// picture that is nearer than the noise keeps a part of it.
double without_noise(double against_mean, double against_one, double against_other);

struct Difference {
  double value = 0, error = 0;  // error: standard error from the reference's noise; 0 if the blocks are not known
};
// How much further `a` is from the reference than `b`. Both share the reference's noise; the halves, which are
// independent, and the blocks show what of the difference is due to it.
Difference difference(const Distance& a, const Distance& b);

// Two standard errors: about 95 % of such claims about equal pictures would be avoided.
bool is_claimed(const Difference& difference);

// Returns whether `b` is claimed to be nearer than `a` by a step that can be seen.
constexpr double kVisibleStep = 0.01;  // of the error; chosen
bool is_nearer(const Distance& a, const Distance& b);

const Distance& distance_to(const Measured& m, Judge judge);
const ReferenceFigures& figures_of(const Sweep& sweep, Judge judge);

// Marks the points that no other beats: in order of cost, a point joins if it is claimed to be nearer than the last
// that joined.
std::vector<bool> claimed_front(const std::vector<double>& cost, const std::vector<const Distance*>& distance);

}  // namespace pocketray
