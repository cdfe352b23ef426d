// What goes wrong in a session, drawn from a seed: the line between a device and its servers, what breaks on it, when
// servers die, freeze and come back, what rows cost, who lies, and who else is at the servers.
#pragma once
#include <cstdint>
#include <string>

#include "platform/null/net/null_link.h"
#include "wire/message.h"

namespace pocketray {

constexpr int kFaultFrames = 10;       // in which things go wrong
constexpr int kSessionFaultsMax = 4;   // on the line
constexpr int kSessionEventsMax = 4;   // of servers
constexpr int kFaultyConnections = 5;  // the first ones, of all servers
constexpr int kSessionServersMax = 3;
constexpr int kNeighboursMax = 6;
constexpr std::uint32_t kSessionRowsMax = 64;  // of a picture

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

// What a server does that a device had better not have connected to.
enum class Malice : std::uint8_t {
  none,
  pongs,            // sends pongs that nobody asked for, without end
  entries,          // the same with descriptions of scenes
  errors,           // reports errors, one after the other
  old_rows,         // sends rows of frames that are over, well encoded, without end
  wrong_pixels,     // sends rows as they should be, but for their pixels, from some frame on
  foreign_rows,     // sends wrong pixels for rows that others are asked for
  repeated_rows,    // sends its rows twice, the second time wrong
  free_pixels,      // says that its pixels take no time
  dear_pixels,      // says that each takes it milliseconds
  random_prices,    // says anything
  wrong_scene,      // describes another scene, or sizes that cannot be
  wrong_hello,      // speaks another version, or takes no picture
  quick_pongs,      // answers pings at once, and takes its time for rows
  dawdles,          // sends each chunk just before it would be given up
  flaps,            // greets, then dies, stalls or reports an error, now here and now there
  junk,             // sends what is no message
  device_messages,  // sends what only devices send
};
constexpr int kMaliceCount = 18;
const char* malice_name(Malice malice);

// What other clients of the servers do.
enum class Nuisance : std::uint8_t {
  silent,       // connects and says nothing
  idle,         // greets and says no more
  pings,        // asks for as many answers as it can
  frames,       // asks for frames, one after the other
  views,        // asks how the scene looks with its exposure measured
  never_reads,  // asks for pieces of scenes and takes none
  junk,         // sends what is no message
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
  // Below: nothing of it where the plan is of a line and its servers alone.
  const char* rows;                  // how what they cost goes from the top to the bottom
  float row_costs[kSessionRowsMax];  // over device_ns or server_ns
  double read_ns;                    // of the device for each byte that it takes from the link
  Malice malice[kSessionServersMax];
  int check_count;  // of servers' pixels in a frame, as ClientOptions has it
  Neighbour neighbours[kNeighboursMax];
  int neighbour_count;
  bool has_scene;  // false: the device leaves all to the servers
  std::uint64_t seed;
};

// Of the line and of servers that keep to the protocol, with rows that cost the same.
FaultPlan draw_faults(std::uint64_t seed);
// The same with larger pictures, unequal rows, servers that do not keep to it and hostile neighbours.
FaultPlan draw_hostile_faults(std::uint64_t seed);
std::string plan_text(const FaultPlan& plan);

}  // namespace pocketray
