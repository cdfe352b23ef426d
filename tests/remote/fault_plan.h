// The plan of a faulty session, drawn from a seed: the line between device and servers and its faults, when servers
// die, freeze and return, costs of rows, liars, and other clients of the servers.
#pragma once
#include <cstdint>
#include <string>

#include "platform/null/net/null_link.h"
#include "split/effect_choice.h"
#include "wire/message.h"

namespace pocketray {

constexpr int kFaultFrames = 10;       // frames with faults,
constexpr int kFarFrames = 200;        // and of sessions with latency
constexpr int kSessionFaultsMax = 4;   // on the line
constexpr int kSessionEventsMax = 4;   // of servers
constexpr int kFaultyConnections = 5;  // the first ones of all servers
constexpr int kSessionServersMax = 3;
constexpr int kNeighboursMax = 6;
constexpr std::uint32_t kSessionRowsMax = 64;  // of a picture

enum class ServerEvent : std::uint8_t {
  kill,    // its connections break and it stops listening
  end,     // it says goodbye before the frame
  freeze,  // it hangs, with its connections open
};

struct PlannedEvent {
  ServerEvent event;
  std::uint32_t server;
  int frame;       // the frame in which it happens
  double at;       // fraction of the frame's time alone; 0: before the frame
  int back_frame;  // the frame before which the server is back
};

// Behaviour of a malicious server.
enum class Malice : std::uint8_t {
  none,
  pongs,            // floods unrequested pongs
  entries,          // floods scene entries
  errors,           // floods errors
  old_rows,         // floods correctly encoded rows of past frames
  wrong_pixels,     // sends rows with wrong pixels from some frame on
  foreign_rows,     // sends wrong pixels for other servers' rows
  repeated_rows,    // sends its rows twice, the second time wrong
  free_pixels,      // claims that its pixels take no time
  dear_pixels,      // claims milliseconds per pixel, and to be as busy as can be
  random_prices,    // claims random times and prices
  wrong_scene,      // describes another scene or impossible sizes
  wrong_hello,      // speaks another version or accepts no picture
  quick_pongs,      // answers pings at once but is slow with rows
  dawdles,          // sends each chunk just before the time-out
  flaps,            // greets, then dies, stalls or reports an error at varying points
  junk,             // sends malformed messages
  device_messages,  // sends messages that only devices send
  coarse_pictures,  // sends coarse pictures at any time, some of another size
  no_light,         // answers pings and sends rows, but no light
  other_light,      // sends light of other frames than it was asked for, or twice
  held_rows,        // holds rows back, and sends them as those of a request for light alone
};
constexpr int kMaliceCount = 22, kRowMaliceCount = 19;  // the latter know nothing of light
const char* malice_name(Malice malice);

// Behaviour of other clients of the servers.
enum class Nuisance : std::uint8_t {
  silent,       // connects and says nothing
  idle,         // greets and says no more
  pings,        // floods pings
  frames,       // requests frame after frame
  views,        // requests views with measured exposure
  never_reads,  // requests pieces of scenes and never reads
  junk,         // sends malformed messages
  comes_and_goes,
};
constexpr int kNuisanceCount = 8;
const char* nuisance_name(Nuisance nuisance);

struct Neighbour {
  Nuisance nuisance;
  std::uint32_t server;
  int host;  // of 10.0.0.0
};

struct FaultPlan {
  std::uint32_t width, height, server_count;
  WireFormat format;
  bool dither;
  double device_ns, server_ns[kSessionServersMax];  // per pixel, on average
  double device_share;                              // below 0: the best
  platform::NullLinkSettings line;
  platform::NullFault faults[kSessionFaultsMax];
  PlannedEvent events[kSessionEventsMax];
  int event_count;
  // The fields below are unused if the plan has only a line and its servers.
  const char* rows;                  // how the cost of rows varies from top to bottom
  float row_costs[kSessionRowsMax];  // over device_ns or server_ns
  double read_ns;                    // device time per byte read from the link
  Malice malice[kSessionServersMax];
  int check_count;  // servers' pixels checked per frame, as in ClientOptions
  Neighbour neighbours[kNeighboursMax];
  int neighbour_count;
  bool has_scene;               // false: the device leaves all to the servers
  bool coarse_first;            // it asks for a coarse picture of every frame
  int frames;                   // with faults
  SplitKind split;              // by effect: the servers' light is instant radiosity
  std::uint64_t light_wait_ns;  // as in LightOptions
  std::uint64_t seed;
};

// Faults of the line and of well-behaved servers, with rows of equal cost.
FaultPlan draw_faults(std::uint64_t seed);
// The same with larger pictures, unequal rows, malicious servers and hostile neighbours.
FaultPlan draw_hostile_faults(std::uint64_t seed);
// The same over links of 5 to 500 ms there and back, for many frames, which are shared in every way.
FaultPlan draw_far_faults(std::uint64_t seed);
std::string plan_text(const FaultPlan& plan);

}  // namespace pocketray
