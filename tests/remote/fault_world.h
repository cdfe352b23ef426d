// The simulated world of a faulty session: a device, its servers and other clients, on one clock. Deterministic for a
// given plan.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "fault_plan.h"
#include "hostile_client.h"
#include "hostile_server.h"
#include "remote/client/frame.h"
#include "remote/server/server.h"
#include "support/scripted_client.h"

namespace pocketray {

constexpr const char* kFaultScene = "seesaw";
constexpr std::uint64_t kSilenceNs = 2'000 * kMs, kConnectNs = 500 * kMs;
constexpr std::uint64_t kRetryMinNs = 100 * kMs, kRetryMaxNs = 1'000 * kMs;
constexpr std::uint64_t kServerIdleNs = 4'000 * kMs;
// Animation times of successive frames; some stand still.
constexpr double kFaultSeconds[] = {0, 0.3, 0.3, 0.7, 1.1, 1.1, 1.1};

// The place of a server, which may be empty.
struct Place {
  platform::LinkAddress address;
  Server* server = nullptr;
  std::unique_ptr<HostileServer> hostile;
  bool frozen = false;
  bool is_there() const { return server || hostile; }
};

struct FaultWorld {
  FaultPlan plan;
  platform::Link* link = nullptr;
  Place places[kSessionServersMax];
  HostileClient neighbours[kNeighboursMax];
  std::uint64_t neighbours_due_ns = 0;
  Client client;
  std::vector<unsigned char> client_memory;
  std::vector<std::string> log;

  int frame = 0;
  std::uint64_t frame_begin_ns = 0, lit_ns = 0;  // lit_ns: when the last frame with a server's light was complete
  std::uint64_t local_ns = 0;                    // frame time of the device alone
  std::uint64_t lost_ns = 0;       // time in the frame that the device cannot know of, as its clock was set back
  std::uint64_t set_back_ns = 0;   // so far
  int reads = 0;                   // by the device since it last waited
  bool stuck = false;              // a flood has held the device
  bool peace = false;              // no more faults
  bool disturbed = false;          // a fault has struck in this frame
  std::uint64_t disturbed_ns = 0;  // time of the last fault
  int faults_struck = 0;
  bool done[kSessionEventsMax] = {};
  std::vector<platform::LinkWait> waits;

  std::uint64_t elapsed() const { return platform::null_link_record(link).elapsed_ns; }
};

// How long the device may wait for light in a frame: for an overture, and until each server has been given up.
inline double light_wait_max_ns(const FaultPlan& plan) {
  if (plan.light_wait_ns == 0) return 0;
  return plan.server_count * 2.0 * static_cast<double>(kSilenceNs) + 40 * static_cast<double>(plan.line.latency_ns);
}

// Opens the world, with the device not yet connected. Only one world at a time.
void open_fault_world(const FaultPlan& plan, FaultWorld* world);
void close_fault_world(FaultWorld* world);
// The device's renderer for pictures of that size, and its reference pixels for a given time: with the light that is
// asked for, its own indirect light, or none. They are the same where frames are only shared by rows.
enum class Lighting : std::uint8_t { asked, own, direct };
Renderer* device_renderer(const FaultPlan& plan);
const std::vector<std::uint8_t>& device_picture(const FaultPlan& plan, int second, Lighting = Lighting::asked);

// Applies planned events: those before the frame, or those due within it.
void look_for_events(bool before);
void note_faults();
// Brings a dead or frozen server back; after make_peace(), a well-behaved one.
void bring_back(std::uint32_t server);
// Ends all faults and malice.
void make_peace();
// Lets time pass for everyone.
void let_pass(std::uint64_t ns);

}  // namespace pocketray
