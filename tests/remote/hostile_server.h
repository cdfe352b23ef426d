// A malicious server: speaks the protocol well enough to be used, then lies, floods, or comes and goes. It lives on the
// simulated link and takes no time except its claimed rendering time.
#pragma once
#include <memory>
#include <vector>

#include "fault_plan.h"
#include "fault_random.h"
#include "platform/link.h"
#include "wire/codec.h"
#include "wire/row_sequence.h"

namespace pocketray {

struct HostileSettings {
  Malice malice;
  double ns_per_pixel;
  std::uint64_t silence_ns;  // time-out of the device
  std::uint64_t seed;
  // The right pixels of that frame in the format of the session.
  const std::vector<std::uint8_t>& (*picture)(double seconds);
};

struct HostileConnection {
  int stream;
  std::vector<std::uint8_t> in, out;
  bool ready = false;   // has greeted and received a request
  bool silent = false;  // stalls for good
  bool holds_rows = false;
  int patience = 0;      // for flaps: number of messages it still answers
  FrameRequest request;  // the last
  RowSequence due;       // remain to be sent
  std::uint32_t chunk_rows = 0, chunk_count = 0, ping_id = 0;
  std::uint64_t due_ns = ~std::uint64_t(0);  // the next chunk
  std::vector<std::uint8_t> block;
  RowEncoder* encoder = nullptr;
};

struct HostileServer {
  HostileSettings settings;
  platform::Link* link;
  int listener;
  FaultRandom random;
  std::uint32_t honest_frames = 0;  // before it sends wrong pixels
  int old_rows_left = 300;          // limited, since encoding them would dominate a session
  std::vector<std::unique_ptr<HostileConnection>> connections;
};

std::unique_ptr<HostileServer> open_hostile_server(platform::Link* link, const platform::LinkAddress& address,
                                                   const HostileSettings& settings);
// Handles messages from devices and sends as much as fits.
void step_hostile_server(HostileServer* server);
// Nanoseconds until it has something to do; ~0: not before new input.
std::uint64_t hostile_due_ns(const HostileServer& server);
void add_hostile_waits(const HostileServer& server, std::vector<platform::LinkWait>* waits);
// Breaks its connections.
void close_hostile_server(HostileServer* server);

}  // namespace pocketray
