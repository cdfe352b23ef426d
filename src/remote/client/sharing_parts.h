// What sharing.cpp and shared_scene.cpp have in common.
#pragma once
#include "remote/client/client.h"
#include "remote/client/sharing.h"

namespace pocketray {

struct Sharing {
  SharingOptions options;
  std::vector<platform::LinkAddress> addresses;
  std::vector<std::max_align_t> tcp_memory, radio_memory;
  platform::Link* tcp = nullptr;
  platform::Link* link = nullptr;  // tcp, or the emulated radio over it
  ContentHash scene;
  bool is_named = false;  // the scene above is the one to share
  bool is_thin = false;   // the device has no room for it
  ViewEntry view;         // of it, where that is so
  Client client;
  bool started = false;
  bool lied[kServerCountMax] = {};  // found out by a client before this one
  ShareTotals totals;
  FrameShare last;  // of the last complete frame
  std::atomic<bool> stopped{false};
};

// Closes the connections of the client, if there is one.
void end_sharing(Sharing* sharing);

}  // namespace pocketray
