// A session that goes wrong: a device and its servers in one simulated world, drawn from a seed with the line between
// them, what breaks on it, and when servers die, freeze and come back. The same seed takes the same course.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "app/server.h"
#include "app/shared_frame.h"
#include "platform/null/null_link.h"
#include "support/scripted_client.h"

namespace pocketray {

constexpr int kFaultFrames = 10;       // in which things go wrong
constexpr int kSessionFaultsMax = 4;   // on the line
constexpr int kSessionEventsMax = 4;   // of servers
constexpr int kFaultyConnections = 5;  // the first ones, of all servers

enum class ServerEvent : std::uint8_t {
  kill,    // its connections break, it listens no more
  end,     // it takes its leave; before the frame
  freeze,  // it does nothing any more, and its connections stay
};

struct PlannedEvent {
  ServerEvent event;
  std::uint32_t server;
  int frame;       // in which it happens
  double at;       // so much of the frame's time alone is over; 0: before it
  int back_frame;  // before which the server is back
};

struct FaultPlan {
  std::uint32_t width, height, server_count;
  WireFormat format;
  bool dither;
  double device_ns, server_ns[3];  // per pixel
  double device_share;             // below 0: the best
  platform::NullLinkSettings line;
  platform::NullFault faults[kSessionFaultsMax];
  PlannedEvent events[kSessionEventsMax];
  int event_count;
};
FaultPlan draw_faults(std::uint64_t seed);
std::string plan_text(const FaultPlan& plan);

// Of one session, for the sum of all.
struct SessionResult {
  std::string failure;  // empty: none
  int frames = 0, frames_disturbed = 0, faults_struck = 0, losses = 0;
  int struck[platform::kLinkFaultCount] = {};  // drawn, of sessions in which as many struck
  double worst_calm = 0, worst_disturbed = 0;  // time of a frame less two rows over the device's alone
  std::uint64_t return_ns = 0;                 // till all servers were in use again
};
SessionResult run_fault_session(std::uint64_t seed);

}  // namespace pocketray
