// Clients that a server has at the moment.
#pragma once
#include "remote/server/state.h"

namespace pocketray {

inline int client_count(const Server& server) {
  int count = 0;
  for (const Session& session : server.sessions) count += session.phase != SessionPhase::unused;
  return count;
}

}  // namespace pocketray
