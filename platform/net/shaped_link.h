// The radio of an emulated device: a link on top of another that delivers bytes only as fast as a wireless link would.
// They are read from the inner link in any call that polls, cross the line in order, and come out when they are due.
//
// The connecting end is the device, as in null/net/null_link.h: its connections share one full-duplex radio.
// Connections accepted here pass unchanged.
#pragma once
#include "platform/devices/device.h"
#include "platform/link.h"
#include "platform/net/link_pipe.h"

namespace platform {

struct ShapedLinkSettings {
  LinkLine line;           // bytes per second of each direction
  std::uint64_t seed = 1;  // for jitter and losses
};
// Settings for the wireless link of a device.
ShapedLinkSettings shaped_link_settings(const Device& device);

// Most bytes in transit in one direction of a connection, beyond which the sender waits: the content of the line over
// one round trip, at least 64 KiB.
std::size_t shaped_pipe_bytes(const LinkLine& line);

std::size_t shaped_link_need(int stream_count_max, const ShapedLinkSettings& settings);
// `inner` must have room for as many streams; the caller keeps it, it must outlive this link, and others may share it.
// The clock is the inner one without its backward steps. `options.now_ns` is ignored.
Link* shaped_link_open(Link* inner, const LinkOptions& options, const ShapedLinkSettings& settings, Error* error);

// Functions of such a link over links of that kind, except need() and open(), which are above.
LinkBackend shaped_link_backend(const LinkBackend& inner);

}  // namespace platform
