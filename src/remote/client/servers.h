// The backend of session/servers.h: a Client over TCP, and a scene fetched from or left to the servers.
#pragma once
#include "platform/net/key_file.h"
#include "remote/client/client.h"
#include "session/servers.h"

namespace pocketray {

struct ConnectedServers : Servers {
  ConnectedServers();

  ServersOptions options;
  const platform::Device* emulated = nullptr;  // null: none
  std::vector<platform::LinkAddress> addresses;
  std::vector<std::max_align_t> tcp_memory, radio_memory, inquiry_memory;
  platform::Link* tcp = nullptr;
  platform::Link* link = nullptr;          // tcp, or the emulated radio over it
  platform::Link* inquiry_link = nullptr;  // encrypted link over it, for questions before the first frame; null: link
  platform::Link* client_link = nullptr;   // likewise for the client, in its arena
  platform::SharedKey key;                 // if options.key
  ContentHash scene;
  bool is_named = false;  // `scene` is the hash of the open scene
  bool is_thin = false;   // the scene does not fit on the device
  ViewEntry view;         // of the scene, if is_thin
  Client client;
  bool started = false;
  bool lied[kServerCountMax] = {};  // caught by an earlier client
  ServersTotals totals;
  FrameShare last;  // of the last complete frame
  std::atomic<bool> stopped{false};
};

inline ConnectedServers* connected(Servers* servers) { return static_cast<ConnectedServers*>(servers); }
inline const ConnectedServers& connected(const Servers& servers) {
  return static_cast<const ConnectedServers&>(servers);
}

extern const ServersBackend kRenderServers;

// Bytes of the client's encrypted link; 0 without a key.
std::size_t client_tls_need(const ConnectedServers& servers);
// Closes the client's connections, if any.
void end_client(ConnectedServers* servers);

// The backend's functions in scene.cpp.
Status open_scene_or_leave_it(Servers* servers, const CommonOptions& common, const OutputBytes& output_bytes,
                              OpenScene* opened);
void stop_opening(Servers* servers);
std::uint32_t scene_triangle_count(const Servers& servers, const Renderer& renderer);
Status list_offered_scenes(Servers* servers, std::size_t server, std::vector<OfferedScene>* scenes);

}  // namespace pocketray
