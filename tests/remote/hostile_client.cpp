#include "hostile_client.h"

#include <string>

#include "platform/null/net/null_link.h"
#include "support/scripted_client.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kConnectNs = 500 * kMs;
const platform::LinkBackend& net = platform::kNullLink;

void say(HostileClient* c, const Message& message) {
  std::vector<std::uint8_t> bytes = bytes_of(message);
  c->out.insert(c->out.end(), bytes.begin(), bytes.end());
}

FrameRequest small_frame(HostileClient* c) {
  FrameRequest request;
  request.frame = ++c->frame;
  request.scene = c->scene;
  request.settings.width = 8, request.settings.height = 8;
  request.row_end = 8;
  request.chunk_rows = 1;
  request.coding = RowCoding::lossless;
  return request;
}

// Queues its next requests.
void make_demands(HostileClient* c) {
  Message message;
  for (int i = 0; i < 8; ++i) {
    switch (c->is.nuisance) {
      case Nuisance::pings:
        message.type = MessageType::ping;
        message.ping = {c->frame++, static_cast<std::uint32_t>(c->random.below(4096))};
        break;
      case Nuisance::frames:
        message.type = MessageType::frame_request;
        message.frame_request = small_frame(c);
        i = 8;
        break;
      case Nuisance::views:
        message.type = MessageType::view_query;
        message.view_query.scene = c->scene;
        message.view_query.settings = small_frame(c).settings;
        message.view_query.measure_exposure = true;
        i = 8;
        break;
      case Nuisance::never_reads:
        message.type = MessageType::scene_fetch;
        message.scene_fetch.hash = c->scene;
        message.scene_fetch.byte_count = kPieceBytesMax;
        break;
      case Nuisance::junk:
        c->out.push_back(static_cast<std::uint8_t>(c->random.below(256)));
        continue;
      default:
        return;
    }
    say(c, message);
  }
}

}  // namespace

void step_hostile_client(platform::Link* link, const platform::LinkAddress& server, HostileClient* c) {
  platform::Error error;
  if (c->stream < 0) {
    std::string host = "10.0.0." + std::to_string(c->is.host);
    c->stream = null_link_connect_from(link, host.c_str(), server, kConnectNs, &error);
    c->out.clear(), c->frame = 0;
    if (c->is.nuisance != Nuisance::silent) say(c, hello_message());
    return;
  }
  if (c->is.nuisance == Nuisance::comes_and_goes && c->random.below(4) == 0) return close_hostile_client(link, c);
  if (c->out.empty()) make_demands(c);
  std::size_t count = 0;
  platform::LinkResult result = platform::LinkResult::later;
  if (!c->out.empty()) result = net.write(link, c->stream, c->out.data(), c->out.size(), &count, &error);
  c->out.erase(c->out.begin(), c->out.begin() + static_cast<std::ptrdiff_t>(count));
  std::uint8_t part[4096];
  while (result != platform::LinkResult::failed && c->is.nuisance != Nuisance::never_reads) {
    result = net.read(link, c->stream, part, sizeof part, &count, &error);
    if (result == platform::LinkResult::ended) result = platform::LinkResult::failed;
    if (result != platform::LinkResult::done) break;
  }
  if (result == platform::LinkResult::failed) close_hostile_client(link, c);
}

void close_hostile_client(platform::Link* link, HostileClient* c) {
  if (c->stream >= 0) net.close(link, c->stream);
  c->stream = -1;
}

}  // namespace pocketray
