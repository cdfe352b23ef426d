// The radio of an emulated device: a link over another one that lets bytes pass only as a wireless link would. They are
// taken from the inner link in any call that polls, cross the line in their turn, and come out when they are due.
//
// Whoever connects is the device, as in null/net/null_link.h: its connections share one radio, which sends and receives
// at once. Peers that are accepted here pass as they are.
#pragma once
#include "platform/devices/device.h"
#include "platform/link.h"
#include "platform/net/link_pipe.h"

namespace platform {

struct ShapedLinkSettings {
  LinkLine line;           // bytes per second of each direction
  std::uint64_t seed = 1;  // of jitter
};
// The wireless link of a device.
ShapedLinkSettings shaped_link_settings(const Device& device);

// Bytes underway in one direction of a connection at most, after which the sender waits: what the line holds over a way
// there and back, at least 64 KiB.
std::size_t shaped_pipe_bytes(const LinkLine& line);

std::size_t shaped_link_need(int stream_count_max, const ShapedLinkSettings& settings);
// `inner` has room for as many streams; it stays the caller's and must outlive this link, and others may use it, too.
// The clock is the inner one; steps of it backwards count as none. Of the options `now_ns` is not used.
Link* shaped_link_open(Link* inner, const LinkOptions& options, const ShapedLinkSettings& settings, Error* error);

// The functions of such a link over links of that kind, but for need() and open(), which are those above.
LinkBackend shaped_link_backend(const LinkBackend& inner);

}  // namespace platform
