// A helper of a server on several ranks: traces the rows assigned by rank 0. It has the same scenes and as much memory
// for each client, and plans it likewise.
#pragma once
#include <string>

#include "remote/cluster/messages.h"
#include "remote/server/server.h"
#include "remote/server/session.h"

namespace pocketray {

class ClusterHelper {
 public:
  // scene_bytes_max: total for all scenes. Uses only the options about memory and tracing.
  ClusterHelper(const Team& team, const ServerOptions& options, std::uint64_t scene_bytes_max, std::string identity);
  ~ClusterHelper();
  ClusterHelper(const ClusterHelper&) = delete;
  ClusterHelper& operator=(const ClusterHelper&) = delete;

  // Allocates its memory and requests the scenes.
  Status open();
  // Handles a message of rank 0.
  Status work(const TeamMessage& message);

 private:
  Status take_scene(TeamReader* reader);
  Status prepare(TeamReader* reader);
  Status prepare_job(Session* session, const ClusterPrepare& asked);
  Status trace(TeamReader* reader);
  Status session_of(const ClusterJob& job, Session** session);
  void want(const ClusterWant& want);

  Team team_;
  ServerOptions options_;
  std::uint64_t scene_bytes_max_;
  std::string identity_;
  SceneStore store_;
  std::vector<std::uint8_t> scene_bytes_;  // of the arriving scene
  std::vector<void*> blocks_;
  std::vector<Session> sessions_;
  std::vector<std::uint32_t> row_pixels_;
  Workers* workers_ = nullptr;
};

}  // namespace pocketray
