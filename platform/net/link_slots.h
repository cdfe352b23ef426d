// Numbers of the backends' streams: the index of a slot, and the slot's generation, which exposes stale streams. A slot
// has a `phase`, which is `unused` if it is free, and a `generation`.
#pragma once
#include <cstdio>

#include "platform/link.h"

namespace platform {

constexpr int kLinkGenerations = 1 << 20;

template <typename Slot>
int stream_number(const Slot* slots, const Slot* slot) {
  return slot->generation * kLinkStreamsMax + static_cast<int>(slot - slots);
}

// Returns null for a stale stream, or one never assigned.
template <typename Slot>
Slot* slot_at(Slot* slots, int slot_count, int stream) {
  if (stream < 0 || stream % kLinkStreamsMax >= slot_count) return nullptr;
  Slot* slot = &slots[stream % kLinkStreamsMax];
  bool used = slot->phase != decltype(slot->phase)::unused;
  return used && slot->generation == stream / kLinkStreamsMax ? slot : nullptr;
}

// Returns a free slot with its generation incremented; null if there is none, as `error` says.
template <typename Slot>
Slot* free_slot(Slot* slots, int slot_count, Error* error) {
  for (int i = 0; i < slot_count; ++i)
    if (slots[i].phase == decltype(slots[i].phase)::unused) {
      slots[i].generation = (slots[i].generation + 1) % kLinkGenerations;
      return &slots[i];
    }
  std::snprintf(error->text, sizeof error->text, "all %d connections are in use: close one, or allow more", slot_count);
  return nullptr;
}

// The error for a call with a stale stream.
inline LinkResult stale_stream(Error* error) {
  std::snprintf(error->text, sizeof error->text, "the connection is not open: connect again");
  return LinkResult::failed;
}

}  // namespace platform
