// Frames shared by effect: the device renders rows with its own indirect light (ambient light, or none), a server
// renders the frame's indirect light at fewer pixels, and the device adds the difference (engine/light_map.h).
// The device has all rows, or servers have the rest of them, whole: SplitKind::automatic chooses the fastest. A
// late map is used for later frames, where its camera saw their surfaces; without any, the device's own light
// stays.
#pragma once
#include "engine/light_map.h"
#include "split/effect_choice.h"
#include "wire/message.h"

namespace pocketray {

// Pixels between the mapped ones. Chosen (tests/indirect/FIGURES.md): fewer bytes are had for less error by one map for
// several frames, and more bytes gain little.
constexpr std::uint32_t kLightPitch = 6;

struct LightOptions {
  SplitKind split = SplitKind::rows;                    // rows: no light is requested, and no memory taken
  IndirectChoice indirect = IndirectChoice::automatic;  // that the servers render
  std::uint32_t every = 1;  // frames of a moving view per map; a view at rest always gets its own
  // Wait for the frame's map once its rows are traced and it has been requested; 0: as long as tracing took. Servers
  // whose last map never came are given that long in any case.
  std::uint64_t wait_ns = 0;
};

struct ClientLight {
  LightGrid grid;                    // pitch 0: no memory is planned
  Array<Hit> first_hits;             // of the current frame
  Array<MappedSurface> surfaces[2];  // of the newest map, and of the requested one
  Array<Vec3> light[2];
  std::uint32_t newest = 0;                        // their index
  LightMap map;                                    // the newest
  FrameRequest map_request;                        // the request it answers; frame 0: there is none
  FrameRequest asked;                              // the current request; frame 0: none
  std::uint32_t asked_server = 0, last_asked = 0;  // last_asked: number of the last frame that asked
  std::uint64_t asked_ns = 0;
  CameraRays asked_camera;
  bool has_surfaces = false, has_come = false;  // of the requested map
  // The current frame.
  bool by_effect = false;
  bool rests = false;           // it shows what the last frame showed
  bool shares_rows = false;     // servers have rows of it, too
  std::uint64_t traced_ns = 0;  // when all of the device's rows were traced; 0: not yet
  std::uint32_t rows_lit = 0;   // the device's rows above this one have the map's light,
  bool is_done = false;         // as have all that get any
  EffectTimes times;
  EffectModel model;
  EffectChoice choice;
  double rows_ns = 0, effect_ns = 0;  // predicted time of a frame in either way; 0: unknown
  double rows_part = 1;               // fraction of its pixels that the device traced when it last shared by rows
  FrameRequest last;                  // the last frame's
  const char* unfit = nullptr;        // why frames cannot be shared by effect, as logged
  std::uint64_t unlit_ns = 0;         // since when frames have lacked a server's light; 0: the last one had it
  bool told_unlit = false;            // this has been logged
};

std::size_t light_need(const Settings& settings, const LightOptions& options);
// Longest message with a map.
std::size_t light_message_bytes_max(const Settings& settings, const LightOptions& options);
void make_light(const LightOptions& options, const Settings& settings, Arena* arena, ClientLight* light);

struct Client;
// Chooses how to share the next frame, and sets the renderer's indirect light accordingly.
Status choose_split(Renderer* renderer, Client* client);

}  // namespace pocketray
