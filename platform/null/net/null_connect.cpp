#include <cstdio>
#include <cstring>

#include "platform/check.h"
#include "platform/null/net/null_state.h"

namespace platform {
namespace null_link {
namespace {

Slot* take_slot(NullLink* link, Phase phase, Error* error) {
  Slot* slot = free_slot(link->slots, link->slot_count, error);
  if (!slot) return nullptr;
  Slot fresh = {};
  fresh.generation = slot->generation;
  fresh.in = slot->in;
  *slot = fresh;
  slot->phase = phase;
  slot->other = slot->listener = -1;
  slot->news_ns = slot->deadline_ns = kNever;
  reset_pipe(&slot->in);
  return slot;
}

int port_of(const LinkAddress& address) {
  int port;
  std::memcpy(&port, address.places[0], sizeof port);
  return port;
}

Slot* listener_at(NullLink* link, int port) {
  for (int i = 0; i < link->slot_count; ++i)
    if (link->slots[i].phase == Phase::listening && link->slots[i].port == port) return &link->slots[i];
  return nullptr;
}

// Notifies the other end: of the end after all data sent or, as in TCP, of a reset if bytes were left unread [RFC 1122,
// sec. 4.2.2.13].
void part(NullLink* link, Slot* slot) {
  bool unread = slot->in.used > 0 || slot->phase == Phase::waiting;
  if (slot->other >= 0) {
    Slot* other = &link->slots[slot->other];
    std::uint64_t news_ns = link->clock_ns + link->settings.latency_ns;
    if (other->in.silent) {
      news_ns = kNever;
    } else if (unread) {
      other->in.reset_ns = news_ns;
    }
    other->in.end_ns = news_ns < other->in.arrival_last_ns ? other->in.arrival_last_ns : news_ns;
    other->other = -1;
  }
  slot->phase = Phase::unused;
}

// Both ends are created at once: the peer sees the connection after one latency, the outcome is known after two.
Slot* begin_connection(NullLink* link, const LinkAddress& address, std::uint64_t timeout_ns, Error* error) {
  Slot* slot = take_slot(link, Phase::connecting, error);
  if (!slot) return nullptr;
  slot->device = true;
  slot->connection = link->record.connection_count;
  slot->port = port_of(address);
  slot->deadline_ns = timeout_ns < kNever - link->clock_ns ? link->clock_ns + timeout_ns : kNever;
  std::snprintf(slot->name, sizeof slot->name, "127.0.0.1:%d", slot->port);
  slot->news_ns = link->clock_ns + 2 * link->settings.latency_ns;
  Slot* listener = listener_at(link, slot->port);
  Slot* other = listener ? take_slot(link, Phase::waiting, error) : nullptr;
  slot->refused = !other;
  if (!other) return slot;
  other->listener = index_of(link, listener);
  other->connection = slot->connection;
  other->news_ns = link->clock_ns + link->settings.latency_ns;
  other->other = index_of(link, slot);
  slot->other = index_of(link, other);
  return slot;
}

}  // namespace

bool resolve(const char* text, LinkAddress* address, Error* error) {
  PLATFORM_CHECK(text != nullptr && address != nullptr);
  *address = LinkAddress();
  char host[256];
  int port;
  if (!link_parse_address(text, host, sizeof host, &port, error)) return false;
  std::snprintf(address->text, sizeof address->text, "%s", text);
  address->loopback =
      std::strncmp(host, "127.", 4) == 0 || std::strcmp(host, "localhost") == 0 || std::strcmp(host, "::1") == 0;
  address->place_count = 1;
  std::memcpy(address->places[0], &port, sizeof port);
  return true;
}

int listen(Link* base, const LinkAddress& address, Error* error) {
  NullLink* link = null(base);
  int port = port_of(address);
  if (port == 0) port = ++link->port_last;
  if (listener_at(link, port)) {
    std::snprintf(error->text, sizeof error->text,
                  "%s: another program is listening there: stop it, or use another port", address.text);
    return -1;
  }
  Slot* slot = take_slot(link, Phase::listening, error);
  if (!slot) return -1;
  slot->port = port;
  std::snprintf(slot->name, sizeof slot->name, "127.0.0.1:%d", port);
  return stream_of(link, slot);
}

int connect(Link* base, const LinkAddress& address, std::uint64_t timeout_ns, Error* error) {
  NullLink* link = null(base);
  Slot* slot = begin_connection(link, address, timeout_ns, error);
  if (!slot) return -1;
  ++link->record.connection_count;
  const NullLinkSettings& settings = link->settings;
  for (int i = 0; i < settings.fault_count; ++i)
    if (at_start(settings.faults[i].fault) && meant_for(settings.faults[i], *slot)) {
      ++link->record.faults_struck;
      if (settings.faults[i].fault == LinkFault::no_answer) slot->news_ns = kNever;
      slot->refused = true;
      if (slot->other >= 0) link->slots[slot->other].phase = Phase::unused;
      slot->other = -1;
    }
  if (slot->other >= 0) {
    Slot* other = &link->slots[slot->other];
    std::snprintf(other->name, sizeof other->name, "127.0.0.1:%d", 49152 + slot->connection % 16384);
  }
  return stream_of(link, slot);
}

LinkResult progress(NullLink* link, Slot* slot, Error* error) {
  if (slot->phase == Phase::connected) return LinkResult::done;
  if (slot->phase == Phase::listening) return stale_stream(error);
  if (slot->phase == Phase::broken) return fail(slot, slot->broken_text, error);
  if (slot->news_ns <= link->clock_ns && slot->news_ns <= slot->deadline_ns) {
    if (slot->refused) return fail(slot, kRefusedText, error);
    slot->phase = Phase::connected;
    return LinkResult::done;
  }
  return slot->deadline_ns <= link->clock_ns ? fail(slot, kSilentText, error) : LinkResult::later;
}

LinkResult connected(Link* base, int stream, Error* error) {
  Slot* slot = slot_of(null(base), stream);
  return slot ? progress(null(base), slot, error) : stale_stream(error);
}

Slot* waiting_at(NullLink* link, const Slot* listener) {
  Slot* first = nullptr;
  for (int i = 0; i < link->slot_count; ++i) {
    Slot* slot = &link->slots[i];
    if (slot->phase != Phase::waiting || slot->listener != index_of(link, listener)) continue;
    if (!first || slot->connection < first->connection) first = slot;
  }
  return first;
}

LinkResult accept(Link* base, int listener, int* stream, Error* error) {
  PLATFORM_CHECK(stream != nullptr);
  NullLink* link = null(base);
  Slot* from = slot_of(link, listener);
  if (!from || from->phase != Phase::listening) return stale_stream(error);
  Slot* slot = waiting_at(link, from);
  if (!slot || slot->news_ns > link->clock_ns) return LinkResult::later;
  slot->phase = Phase::connected;
  *stream = stream_of(link, slot);
  return LinkResult::done;
}

void close_stream(Link* base, int stream) {
  NullLink* link = null(base);
  Slot* slot = slot_of(link, stream);
  if (!slot) return;
  if (slot->phase == Phase::listening)
    while (Slot* waiting = waiting_at(link, slot)) part(link, waiting);
  part(link, slot);
}

void close_all(Link* base) {
  NullLink* link = null(base);
  for (int i = 0; i < link->slot_count; ++i)
    if (link->slots[i].phase != Phase::unused) close_stream(base, stream_of(link, &link->slots[i]));
}

}  // namespace null_link

int null_link_connect_from(Link* base, const char* host, const LinkAddress& address, std::uint64_t timeout_ns,
                           Error* error) {
  using namespace null_link;
  NullLink* link = null(base);
  Slot* slot = begin_connection(link, address, timeout_ns, error);
  if (!slot) return -1;
  slot->elsewhere = true;
  if (slot->other < 0) return stream_of(link, slot);
  Slot* other = &link->slots[slot->other];
  other->elsewhere = true;
  std::snprintf(other->name, sizeof other->name, "%.24s:%d", host, 49152 + slot->other);
  return stream_of(link, slot);
}

}  // namespace platform
