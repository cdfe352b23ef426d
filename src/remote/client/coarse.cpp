// A coarse picture of a slow frame, which a server sends before its rows, so that the screen responds at once.
#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

constexpr double kAwaitedNs = 20e6;  // chosen: a round trip and the work on a coarse picture of a long frame

}  // namespace

void want_coarse(Client* client, double frame_ns) {
  const double after_ns = client->options.coarse_after_ns;
  const bool is_long = frame_ns == 0 || frame_ns > after_ns;
  client->frame.request.coarse_first = after_ns > 0 && is_long && !client->coarse.asked;
}

bool awaits_coarse(const Client& client) {
  if (!client.coarse.asked || client.coarse.shown || client.frame.complete) return false;
  const double elapsed_ns = static_cast<double>(client_elapsed_ns(client));
  return elapsed_ns < std::max(kAwaitedNs, 0.1 * client.share.predicted_ns);
}

void show_coarse(Client* client, const CoarsePicture& coarse) {
  const std::uint32_t width = client->settings.width, height = client->settings.height;
  const std::uint32_t bytes = pixel_bytes(client->options.format), columns = coarse_count(width);
  CHECK_EQ(coarse.pixels.count, coarse_bytes(width, height, client->options.format));
  for (std::uint32_t row = 0; row < height; ++row) {
    if (is_done(client->picture.merge.rows[row])) continue;
    const std::uint8_t* from = coarse.pixels.data + std::size_t(row / kCoarseSide) * columns * bytes;
    std::uint8_t* to = merged_row(*client, row);
    for (std::uint32_t x = 0; x < width; ++x, to += bytes) std::memcpy(to, from + x / kCoarseSide * bytes, bytes);
  }
  client->coarse.shown = true;
  client->coarse.ns = client_elapsed_ns(*client);
  mark_dirty(client, 0, height);
}

}  // namespace pocketray
