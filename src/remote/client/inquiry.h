// Inquiry: a device's questions to a render server before its first frame: the list of scenes, a scene's baked file, or
// the view of a scene that does not fit on the device. One server at a time. Blocks while polling the link and uses the
// heap, so use it before memory is sealed.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/status.h"
#include "remote/stream.h"

namespace pocketray {

struct InquiryOptions {
  // Chosen: connecting as in client.h. The others are longer, since nothing else can be done without the answer; a
  // piece of 32 KiB comes in time at 4.4 kbit/s or more.
  std::uint64_t connect_timeout_ns = 3'000'000'000;
  std::uint64_t silence_timeout_ns = 10'000'000'000;  // without a byte
  std::uint64_t answer_timeout_ns = 60'000'000'000;   // for a complete answer
  std::function<bool()> stopped;                      // called periodically; true stops the inquiry; may be empty
};

struct Inquiry {
  InquiryOptions options;
  platform::Link* link = nullptr;
  std::vector<std::uint8_t> memory;
  MessageStream messages;
  Inquiry() = default;
  Inquiry(const Inquiry&) = delete;
  Inquiry& operator=(const Inquiry&) = delete;
  ~Inquiry() { close_message_stream(&messages); }
};

// Connects and says hello. Holds a stream of the link until the inquiry ends. Errors here and below describe the
// problem without naming the server.
Status open_inquiry(const InquiryOptions& options, platform::Link* link, const platform::LinkAddress& address,
                    Inquiry* inquiry);

// All scenes of the server, in its order; names are safe to print.
Status list_scenes(Inquiry* inquiry, std::vector<SceneEntry>* entries);
// Finds the scene `name`, or else one equal except for file endings. Null if there is none.
const SceneEntry* find_entry(const std::vector<SceneEntry>& entries, const std::string& name);

// Fetches the baked file of entry.byte_count bytes into `bytes`, which holds `byte_count_max`. Fails unless the data
// matches the entry. `progress` receives the bytes so far and may be empty.
Status fetch_scene(Inquiry* inquiry, const SceneEntry& entry, std::uint8_t* bytes, std::size_t byte_count_max,
                   const std::function<void(std::uint64_t)>& progress);

Status ask_view(Inquiry* inquiry, const ViewQuery& query, ViewEntry* entry);

}  // namespace pocketray
