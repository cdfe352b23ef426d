// The simulated world of a session that goes wrong: a device, its servers and who else is there, by one clock. The same
// plan takes the same course.
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

constexpr const char* kFaultScene = "cube";
constexpr std::uint64_t kSilenceNs = 2'000 * kMs, kConnectNs = 500 * kMs;
constexpr std::uint64_t kRetryMinNs = 100 * kMs, kRetryMaxNs = 1'000 * kMs;
constexpr std::uint64_t kServerIdleNs = 4'000 * kMs;
constexpr double kFaultSeconds[] = {0, 0.3, 0.7, 1.1};  // of the animation, one frame after the other

// Where a server is, or is not.
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
  std::uint64_t frame_begin_ns = 0;
  std::uint64_t local_ns = 0;      // what a frame takes the device alone
  std::uint64_t lost_ns = 0;       // of the frame, what the device cannot know of: its clock was set back
  std::uint64_t set_back_ns = 0;   // so far
  int reads = 0;                   // of the device since it last waited
  bool stuck = false;              // who floods has held the device
  bool peace = false;              // nothing goes wrong any more
  bool disturbed = false;          // something has gone wrong in this frame
  std::uint64_t disturbed_ns = 0;  // when it last did
  int faults_struck = 0;
  bool done[kSessionEventsMax] = {};
  std::vector<platform::LinkWait> waits;

  std::uint64_t elapsed() const { return platform::null_link_record(link).elapsed_ns; }
};

// With the device connected to nobody yet. There is one world at a time.
void open_fault_world(const FaultPlan& plan, FaultWorld* world);
void close_fault_world(FaultWorld* world);
// The device's renderer for pictures of that size, and what its own frames look like: the pixels of a second.
Renderer* device_renderer(const FaultPlan& plan);
const std::vector<std::uint8_t>& device_picture(const FaultPlan& plan, int second);

// What the plan has for before the frame, or for within it by now.
void look_for_events(bool before);
void note_faults();
// A server that is gone or frozen is there again; in times of peace one that keeps to the protocol.
void bring_back(std::uint32_t server);
// Nobody does harm any more.
void make_peace();
// Lets time pass, for all.
void let_pass(std::uint64_t ns);

}  // namespace pocketray
