// Inquiry: what a device asks a render server before its first frame: which scenes it has, the baked file of one, how
// one looks that the device has no room for. One server at a time. It waits, where the link is polled, and takes memory
// from the heap: to be done before anything is sealed.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/status.h"
#include "remote/stream.h"

namespace pocketray {

struct InquiryOptions {
  std::uint64_t connect_timeout_ns = 3'000'000'000;
  std::uint64_t silence_timeout_ns = 10'000'000'000;  // without a byte
  std::uint64_t answer_timeout_ns = 60'000'000'000;   // for an answer to be whole
  std::function<bool()> stopped;                      // asked now and then; empty: nobody stops it
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

// Connects and says hello. Takes a stream of the link for as long as the inquiry lives. Errors here and below say what
// is wrong with the server, without its name.
Status open_inquiry(const InquiryOptions& options, platform::Link* link, const platform::LinkAddress& address,
                    Inquiry* inquiry);

// All scenes of the server, in its order; their names are fit for a terminal.
Status list_scenes(Inquiry* inquiry, std::vector<SceneEntry>* entries);
// The one that is called `name`; where there is none, the one that is but for the ending of either. Null: none.
const SceneEntry* find_entry(const std::vector<SceneEntry>& entries, const std::string& name);

// The baked file into entry.byte_count bytes; there is room for `byte_count_max`. What comes is what the entry told of,
// or it fails. `progress` is given the bytes that have come, and may be empty.
Status fetch_scene(Inquiry* inquiry, const SceneEntry& entry, std::uint8_t* bytes, std::size_t byte_count_max,
                   const std::function<void(std::uint64_t)>& progress);

Status ask_view(Inquiry* inquiry, const ViewQuery& query, ViewEntry* entry);

}  // namespace pocketray
