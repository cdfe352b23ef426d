#include "platform/net/tls/tls_link.h"

#include <cstdio>
#include <cstring>

#include "platform/check.h"
#include "platform/net/tls/tls_link_state.h"

namespace platform {
namespace {

// Time for the last record to find room; chosen: as the server's kLingerNs.
constexpr std::uint64_t kFarewellNs = 2'000'000'000;
constexpr std::size_t kHeapAlignment = 16;
constexpr std::size_t kUnreadMax = 65536;  // read from a refused peer, so that it can read the reason

bool has_tls(const TlsSlot& slot) {
  return slot.phase == TlsPhase::greeting || slot.phase == TlsPhase::connected || slot.phase == TlsPhase::closing;
}

// Ends the encryption and the stream below.
void close_inner(TlsLink* link, TlsSlot* slot) {
  if (has_tls(*slot)) {
    if (slot->tls.heap.used_max > link->record.heap_bytes_max) link->record.heap_bytes_max = slot->tls.heap.used_max;
    tls_end(&slot->tls);
  }
  if (slot->inner >= 0) {
    std::snprintf(slot->name, sizeof slot->name, "%s", net(link).stream_name(link->inner, slot->inner));
    net(link).close(link->inner, slot->inner);
  }
  slot->inner = -1;
}

// If the peer's bytes were left unread, the system would discard what it has been told [RFC 1122, sec. 4.2.2.13].
void discard_input(TlsLink* link, TlsSlot* slot) {
  unsigned char part[1024];
  std::size_t count = 0;
  Error error;
  for (std::size_t sum = 0; sum < kUnreadMax; sum += count)
    if (net(link).read(link->inner, slot->inner, part, sizeof part, &count, &error) != LinkResult::done) return;
}

LinkResult break_off(TlsLink* link, TlsSlot* slot, Error* error) {
  close_inner(link, slot);
  slot->phase = TlsPhase::broken;
  *error = slot->error;
  return LinkResult::failed;
}

bool begin(TlsLink* link, TlsSlot* slot, Error* error) {
  std::snprintf(slot->name, sizeof slot->name, "%s", net(link).stream_name(link->inner, slot->inner));
  if (!tls_begin(&slot->tls, &link->config, slot->accepted, link->inner, slot->inner, slot->memory,
                 kTlsStreamHeapBytes)) {
    tls_tell(slot->tls, slot->name, error);
    return false;
  }
  slot->phase = TlsPhase::greeting;
  return true;
}

// Returns a free slot for a stream; if there is none, one that is closing gives way.
TlsSlot* take_slot(TlsLink* link, TlsPhase phase, Error* error) {
  TlsSlot* slot = free_slot(link->slots, link->slot_count, error);
  for (int i = 0; i < link->slot_count && !slot; ++i) {
    if (link->slots[i].phase != TlsPhase::closing) continue;
    tls_free_closing(link, &link->slots[i]);
    slot = free_slot(link->slots, link->slot_count, error);
  }
  if (!slot) return nullptr;
  slot->phase = phase;
  slot->inner = -1;
  slot->accepted = slot->ended = false;
  return slot;
}

int connect(Link* base, const LinkAddress& address, std::uint64_t timeout_ns, Error* error) {
  TlsLink* link = tls_of(base);
  TlsSlot* slot = take_slot(link, TlsPhase::connecting, error);
  if (!slot) return -1;
  slot->inner = net(link).connect(link->inner, address, timeout_ns, error);
  if (slot->inner < 0) slot->phase = TlsPhase::unused;
  slot->timer = link_timer(now_of(link), timeout_ns);
  return slot->inner < 0 ? -1 : stream_number(link->slots, slot);
}

LinkResult connected(Link* base, int stream, Error* error) {
  TlsSlot* slot = tls_slot_of(tls_of(base), stream);
  return slot ? tls_progress(tls_of(base), slot, error) : stale_stream(error);
}

int listen(Link* base, const LinkAddress& address, Error* error) {
  TlsLink* link = tls_of(base);
  TlsSlot* slot = take_slot(link, TlsPhase::listening, error);
  if (!slot) return -1;
  slot->inner = net(link).listen(link->inner, address, error);
  if (slot->inner < 0) slot->phase = TlsPhase::unused;
  return slot->inner < 0 ? -1 : stream_number(link->slots, slot);
}

LinkResult accept(Link* base, int listener, int* stream, Error* error) {
  TlsLink* link = tls_of(base);
  TlsSlot* from = tls_slot_of(link, listener);
  if (!from || from->phase != TlsPhase::listening) return stale_stream(error);
  // First, because a closing one also occupies an inner stream.
  TlsSlot* slot = take_slot(link, TlsPhase::connecting, error);
  int inner = -1;
  LinkResult result = net(link).accept(link->inner, from->inner, &inner, error);
  if (result == LinkResult::done && slot) {
    slot->inner = inner;
    slot->accepted = true;
    slot->timer = link_timer(now_of(link), kTlsHandshakeNs);
    *stream = stream_number(link->slots, slot);
    if (begin(link, slot, error)) return result;
    result = LinkResult::failed;
    inner = -1;
    close_inner(link, slot);
  }
  if (slot) slot->phase = TlsPhase::unused;
  if (result != LinkResult::done) return result;
  net(link).close(link->inner, inner);
  return LinkResult::failed;
}

const char* stream_name(const Link* base, int stream) {
  TlsLink* link = tls_of(const_cast<Link*>(base));
  const TlsSlot* slot = tls_slot_of(link, stream);
  if (!slot) return "";
  return slot->inner >= 0 ? net(link).stream_name(link->inner, slot->inner) : slot->name;
}

// Returns the slot of a stream whose handshake is done, if there are bytes to move; otherwise null, and what to return.
TlsSlot* find_ready(TlsLink* link, int stream, const void* bytes, std::size_t byte_count_max, LinkResult* result,
                    Error* error) {
  TlsSlot* slot = tls_slot_of(link, stream);
  *result = slot ? tls_progress(link, slot, error) : stale_stream(error);
  if (*result == LinkResult::done && byte_count_max > 0) {
    PLATFORM_CHECK(bytes != nullptr);
    return slot;
  }
  if (*result != LinkResult::failed) *result = LinkResult::later;
  return nullptr;
}

LinkResult read(Link* base, int stream, void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                Error* error) {
  *byte_count = 0;
  TlsLink* link = tls_of(base);
  LinkResult result;
  TlsSlot* slot = find_ready(link, stream, bytes, byte_count_max, &result, error);
  if (!slot) return result;
  if (slot->ended) return LinkResult::ended;
  result = tls_read(&slot->tls, bytes, byte_count_max, byte_count);
  slot->ended = result == LinkResult::ended;
  return result == LinkResult::failed ? tls_fail(link, slot, error) : result;
}

LinkResult write(Link* base, int stream, const void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                 Error* error) {
  *byte_count = 0;
  TlsLink* link = tls_of(base);
  LinkResult result;
  TlsSlot* slot = find_ready(link, stream, bytes, byte_count_max, &result, error);
  if (!slot) return result;
  result = tls_write(&slot->tls, bytes, byte_count_max, byte_count);
  return result == LinkResult::failed ? tls_fail(link, slot, error) : result;
}

std::uint64_t now_ns(Link* base) { return now_of(tls_of(base)); }

void close_stream(Link* base, int stream) {
  TlsLink* link = tls_of(base);
  TlsSlot* slot = tls_slot_of(link, stream);
  if (!slot) return;
  // A peer with lost bytes must not take the end for a regular one.
  bool regular = slot->phase == TlsPhase::connected && !tls_has_input(slot->tls);
  std::size_t count = 0;
  unsigned char byte;
  Error error;
  if (regular && !slot->ended)
    regular = net(link).read(link->inner, slot->inner, &byte, 1, &count, &error) == LinkResult::later;
  if (regular && tls_farewell(&slot->tls) == LinkResult::later) {
    slot->phase = TlsPhase::closing;
    slot->timer = link_timer(now_of(link), kFarewellNs);
    return;
  }
  close_inner(link, slot);
  slot->phase = TlsPhase::unused;
}

void close_all(Link* base) {
  TlsLink* link = tls_of(base);
  for (int i = 0; i < link->slot_count; ++i) {
    TlsSlot* slot = &link->slots[i];
    if (slot->phase == TlsPhase::unused) continue;
    if (slot->phase != TlsPhase::closing) close_stream(base, stream_number(link->slots, slot));
    if (slot->phase == TlsPhase::closing) tls_free_closing(link, slot);
  }
  tls_config_end(&link->config);
}

std::size_t no_need(int) { return 0; }

Link* no_open(const LinkOptions&, Error* error) {
  std::snprintf(error->text, sizeof error->text, "this link wraps another: open it with tls_link_open()");
  return nullptr;
}

}  // namespace

LinkResult tls_fail(TlsLink* link, TlsSlot* slot, Error* error) {
  PLATFORM_CHECK(slot->tls.fault != TlsFault::none);
  tls_tell(slot->tls, slot->name, &slot->error);
  if (slot->phase == TlsPhase::greeting) ++link->record.failures;
  if (slot->tls.fault != TlsFault::link) discard_input(link, slot);
  return break_off(link, slot, error);
}

LinkResult tls_fail_in_time(TlsLink* link, TlsSlot* slot, Error* error) {
  std::snprintf(slot->error.text, sizeof slot->error.text,
                slot->accepted ? "%.95s: it did not complete a TLS handshake"
                               : "%.95s: no answer to the TLS handshake: does it use TLS and a key (--key)?",
                slot->name);
  ++link->record.failures;
  return break_off(link, slot, error);
}

void tls_free_closing(TlsLink* link, TlsSlot* slot) {
  PLATFORM_CHECK(slot->phase == TlsPhase::closing);
  close_inner(link, slot);
  slot->phase = TlsPhase::unused;
}

LinkResult tls_greet(TlsLink* link, TlsSlot* slot, Error* error) {
  LinkResult result = tls_handshake(&slot->tls);
  if (result == LinkResult::done) {
    ++link->record.handshakes;
    slot->phase = TlsPhase::connected;
  }
  return result == LinkResult::failed ? tls_fail(link, slot, error) : result;
}

LinkResult tls_progress(TlsLink* link, TlsSlot* slot, Error* error) {
  switch (slot->phase) {
    case TlsPhase::connected:
      return LinkResult::done;
    case TlsPhase::broken:
      *error = slot->error;
      return LinkResult::failed;
    case TlsPhase::connecting: {
      LinkResult result = net(link).connected(link->inner, slot->inner, error);
      if (result == LinkResult::failed) slot->error = *error;
      if (result == LinkResult::failed || (result == LinkResult::done && !begin(link, slot, &slot->error)))
        return break_off(link, slot, error);
      if (result == LinkResult::later) return result;
      return tls_greet(link, slot, error);
    }
    case TlsPhase::greeting: {
      LinkResult result = slot->accepted ? LinkResult::later : tls_greet(link, slot, error);
      if (result != LinkResult::later || link_timer_left(&slot->timer, now_of(link)) > 0) return result;
      return tls_fail_in_time(link, slot, error);
    }
    case TlsPhase::unused:
    case TlsPhase::listening:
    case TlsPhase::closing:
      break;
  }
  return stale_stream(error);
}

LinkBackend tls_link_backend(const LinkBackend& inner) {
  return {"tls",       no_need, no_open, inner.resolve, connect, connected,    listen,   accept,
          stream_name, read,    write,   tls_poll,      now_ns,  close_stream, close_all};
}

std::size_t tls_link_need(int stream_count_max) {
  std::size_t each = sizeof(TlsSlot) + sizeof(LinkWait) + kTlsStreamHeapBytes;
  return sizeof(TlsLink) + kTlsConfigHeapBytes + 2 * kHeapAlignment + static_cast<std::size_t>(stream_count_max) * each;
}

Link* tls_link_open(Link* inner, const LinkOptions& options, const TlsLinkSettings& settings, Error* error) {
  PLATFORM_CHECK(inner != nullptr && inner->backend != nullptr);
  int count = options.stream_count_max;
  if (count < 1 || count > kLinkStreamsMax || !options.memory || options.memory_bytes < tls_link_need(count)) {
    std::snprintf(error->text, sizeof error->text,
                  "%d encrypted connections of at most %d need %zu bytes but %zu were given", count, kLinkStreamsMax,
                  tls_link_need(count), options.memory_bytes);
    return nullptr;
  }
  std::memset(options.memory, 0, tls_link_need(count));
  TlsLink* link = static_cast<TlsLink*>(options.memory);
  link->functions = tls_link_backend(*inner->backend);
  link->backend = &link->functions;
  link->inner = inner;
  link->slot_count = count;
  link->slots = reinterpret_cast<TlsSlot*>(link + 1);
  link->waits = reinterpret_cast<LinkWait*>(link->slots + count);
  auto* memory = reinterpret_cast<unsigned char*>(link->waits + count);
  memory += (kHeapAlignment - reinterpret_cast<std::uintptr_t>(memory) % kHeapAlignment) % kHeapAlignment;
  for (int i = 0; i < count; ++i, memory += kTlsStreamHeapBytes) link->slots[i].memory = memory;
  return tls_config_start(&link->config, settings.key, settings.random, memory, error) ? link : nullptr;
}

TlsLinkRecord tls_link_record(const Link* base) {
  const auto* link = static_cast<const TlsLink*>(base);
  TlsLinkRecord record = link->record;
  for (int i = 0; i < link->slot_count; ++i) {
    const TlsSlot& slot = link->slots[i];
    if (has_tls(slot) && slot.tls.heap.used_max > record.heap_bytes_max) record.heap_bytes_max = slot.tls.heap.used_max;
  }
  return record;
}

}  // namespace platform
