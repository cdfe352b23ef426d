// Messages between rank 0 of a server and its helpers.
#pragma once
#include <type_traits>

#include "remote/cluster/row_share.h"
#include "session/team.h"

namespace pocketray {

enum ClusterWord : std::uint8_t {
  // From helpers: ClusterWant; identity and thread count; a ClusterJob, for kRefused with the reason; ClusterTraced.
  kWantScene = kTeamFirstOwn,
  kReady,
  kPrepared,
  kRefused,
  kTraced,
  // To helpers: ClusterScene and bytes of its file; ClusterPrepare; ClusterTrace.
  kScene,
  kPrepare,
  kTrace
};

// A job of one of the server's sessions.
struct ClusterJob {
  std::uint64_t number = 0;
  std::uint32_t session = 0, padding = 0;
};
struct ClusterWant {
  std::uint64_t scene, offset;
};
struct ClusterScene {
  ClusterWant part;
  std::uint64_t scene_count, byte_count;  // of all scenes; of this one
  ContentHash hash;
  char name[kNameBytes];
};
struct ClusterPrepare {
  ClusterJob job;
  FrameRequest request;
  float own_exposure;  // the scene's
};
struct ClusterTrace {
  ClusterJob job;
  RowPiece piece;
};
// If the rows are complete, the number of pixels traced of each row and the packed rows follow.
struct ClusterTraced {
  ClusterTrace asked;
  std::uint64_t took_ns;
  std::uint32_t pixels_traced, padding;
};

// Sent as in memory: ranks run the same program on CPUs of one kind.
template <class T>
void write_plain(const T& value, TeamWriter* writer) {
  static_assert(std::is_trivially_copyable<T>::value, "it is sent as bytes");
  writer->append(&value, sizeof value);
}
template <class T>
bool read_plain(TeamReader* reader, T* value) {
  static_assert(std::is_trivially_copyable<T>::value, "it is sent as bytes");
  return reader->take(value, sizeof *value);
}
template <class T>
void send_plain(const Team& team, std::uint32_t rank, ClusterWord word, const T& value) {
  static_assert(std::is_trivially_copyable<T>::value, "it is sent as bytes");
  send_to(team, rank, word, &value, sizeof value);
}

}  // namespace pocketray
