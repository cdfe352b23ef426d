#include "split/closed_form.h"

#include <cmath>

namespace pocketray {
namespace {

bool is_time(double ns) { return ns >= 0 && ns <= kPixelNsMax; }

ClosedSplit balance(double device_ns, double server_ns, bool server_known) {
  if (!(device_ns >= 0)) device_ns = 0;
  if (device_ns > kPixelNsMax) device_ns = kPixelNsMax;
  if (!server_known) return {1, device_ns};
  double sum = device_ns + server_ns;
  if (sum <= 0) return {1, 0};
  double share = server_ns / sum;
  return {share, share * device_ns};
}

}  // namespace

ClosedSplit closed_form_split(const PixelTimes& times) {
  return balance(times.device_ns, times.server_ns + times.transfer_ns,
                 is_time(times.server_ns) && is_time(times.transfer_ns));
}

ClosedSplit overlapped_split(const PixelTimes& times) {
  return balance(times.device_ns, std::fmax(times.server_ns, times.transfer_ns),
                 is_time(times.server_ns) && is_time(times.transfer_ns));
}

}  // namespace pocketray
