#include "platform/net/shaped_link.h"

#include <cstdio>
#include <cstring>

#include "platform/check.h"
#include "platform/net/link_slots.h"

namespace platform {
namespace {

// `passed`: a listener or an accepted peer, handled only by the inner link. `closing`: written data still has to
// cross.
enum class Phase : std::uint8_t { unused, passed, connecting, connected, closing, broken };

struct Slot {
  Phase phase;
  int generation;
  int inner;              // the inner stream; -1: closed
  LinkResult outcome;     // of connecting on the inner link
  bool in_time;           // the time to connect allows a round trip
  bool lost;              // the inner connection is gone
  bool blocked;           // the inner link has no room until poll() reports some
  std::uint64_t news_ns;  // when the outcome of connecting becomes known
  LinkPipe in, out;
  Error error;                // why it was lost
  char name[kLinkNameBytes];  // of the inner stream, once that is closed
};

struct alignas(Slot) ShapedLink : Link {  // followed by its slots
  LinkBackend functions;
  Link* inner;
  ShapedLinkSettings settings;
  std::uint64_t inner_last_ns, clock_ns;  // the inner clock, and the sum of its forward steps
  std::uint64_t line_free_ns[2];          // until when the radio is busy receiving and sending
  std::uint64_t random;
  int slot_count;
  Slot* slots;
  LinkWait* waits;  // for the inner poll(), one per slot
};

constexpr std::uint64_t kHourNs = 3600 * kSecondNs;

ShapedLink* shaped(Link* link) { return static_cast<ShapedLink*>(link); }
Slot* slot_of(ShapedLink* link, int stream) {
  Slot* slot = slot_at(link->slots, link->slot_count, stream);
  return slot && slot->phase != Phase::closing ? slot : nullptr;
}
const LinkBackend& net(const ShapedLink* link) { return *link->inner->backend; }

std::uint64_t tell_clock(ShapedLink* link) {
  std::uint64_t now_ns = net(link).now_ns(link->inner);
  if (now_ns > link->inner_last_ns) link->clock_ns += now_ns - link->inner_last_ns;
  link->inner_last_ns = now_ns;
  return link->clock_ns;
}

void close_inner(ShapedLink* link, Slot* slot) {
  if (slot->inner >= 0) {
    std::snprintf(slot->name, sizeof slot->name, "%s", net(link).stream_name(link->inner, slot->inner));
    net(link).close(link->inner, slot->inner);
  }
  slot->inner = -1;
}

// The inner connection is gone; the device learns of it after one latency.
void lose(ShapedLink* link, Slot* slot) {
  slot->lost = true;
  slot->in.reset_ns = link->clock_ns + link->settings.line.latency_ns;
}

// Forwards bytes received on the inner link to the device, as many as there is room for.
void receive(ShapedLink* link, Slot* slot) {
  const LinkLine& line = link->settings.line;
  while (!slot->lost && slot->in.end_ns == kNever && pipe_room(slot->in) > 0) {
    unsigned char part[kPieceBytesMax];
    std::size_t count = 0;
    LinkResult result = net(link).read(link->inner, slot->inner, part, pipe_room(slot->in), &count, &slot->error);
    if (result == LinkResult::later) break;
    if (result == LinkResult::failed) lose(link, slot);
    if (result == LinkResult::ended) {
      std::uint64_t end_ns = link->clock_ns + line.latency_ns;
      slot->in.end_ns = end_ns < slot->in.arrival_last_ns ? slot->in.arrival_last_ns : end_ns;
    }
    if (result != LinkResult::done) continue;
    push_piece(&slot->in, part, count, 0,
               line_arrival_ns(line, count, link->clock_ns, &link->line_free_ns[0], &link->random));
    lose_piece(line, &slot->in, &link->random);
  }
}

// Passes bytes that have crossed by `now_ns` to the inner link.
void send(ShapedLink* link, Slot* slot, std::uint64_t now_ns) {
  const unsigned char* bytes;
  slot->blocked = false;
  while (!slot->lost && !slot->blocked) {
    std::size_t due_count = due_bytes(slot->out, now_ns, &bytes), count = 0;
    if (due_count == 0) break;
    LinkResult result = net(link).write(link->inner, slot->inner, bytes, due_count, &count, &slot->error);
    if (result == LinkResult::failed) lose(link, slot);
    PLATFORM_CHECK_LE(count, due_count);
    slot->blocked = result == LinkResult::later;
    drop_bytes(&slot->out, count);
  }
}

void free_closing(ShapedLink* link, Slot* slot) {
  send(link, slot, kNever);
  close_inner(link, slot);
  slot->phase = Phase::unused;
}

// Applies everything that can happen to a stream by itself.
void move(ShapedLink* link, Slot* slot) {
  if (slot->phase == Phase::connecting && slot->outcome == LinkResult::later)
    slot->outcome = net(link).connected(link->inner, slot->inner, &slot->error);
  if (slot->phase == Phase::connected) receive(link, slot);
  if (slot->phase == Phase::connected || slot->phase == Phase::closing) send(link, slot, link->clock_ns);
  if (slot->phase == Phase::closing && (slot->lost || slot->out.used == 0)) free_closing(link, slot);
}

LinkResult fail(ShapedLink* link, Slot* slot, Error* error) {
  close_inner(link, slot);
  slot->phase = Phase::broken;
  *error = slot->error;
  return LinkResult::failed;
}

// Returns a free slot for a stream; if there is none, one that is closing gives way.
Slot* take_slot(ShapedLink* link, int inner, Phase phase, Error* error) {
  Slot* slot = free_slot(link->slots, link->slot_count, error);
  for (int i = 0; i < link->slot_count && !slot; ++i) {
    if (link->slots[i].phase != Phase::closing) continue;
    free_closing(link, &link->slots[i]);
    slot = free_slot(link->slots, link->slot_count, error);
  }
  if (!slot) return nullptr;
  slot->phase = phase;
  slot->inner = inner;
  slot->outcome = LinkResult::later;
  slot->in_time = slot->lost = slot->blocked = false;
  slot->news_ns = 0;
  reset_pipe(&slot->in);
  reset_pipe(&slot->out);
  return slot;
}

int connect(Link* base, const LinkAddress& address, std::uint64_t timeout_ns, Error* error) {
  ShapedLink* link = shaped(base);
  Slot* slot = take_slot(link, -1, Phase::connecting, error);
  if (!slot) return -1;
  slot->inner = net(link).connect(link->inner, address, timeout_ns, error);
  if (slot->inner < 0) {
    slot->phase = Phase::unused;
    return -1;
  }
  std::uint64_t round_trip_ns = 2 * link->settings.line.latency_ns;
  slot->in_time = round_trip_ns < timeout_ns;
  slot->news_ns = tell_clock(link) + (slot->in_time ? round_trip_ns : timeout_ns);
  return stream_number(link->slots, slot);
}

// Advances connecting.
LinkResult progress(ShapedLink* link, Slot* slot, Error* error) {
  if (slot->phase == Phase::connected) return LinkResult::done;
  if (slot->phase == Phase::broken) return fail(link, slot, error);
  if (slot->phase == Phase::passed) return net(link).connected(link->inner, slot->inner, error);
  move(link, slot);
  if (slot->news_ns > link->clock_ns) return LinkResult::later;
  if (!slot->in_time) {
    std::snprintf(slot->error.text, sizeof slot->error.text,
                  "%.95s: no answer: a round trip by the emulated radio takes longer than the time given",
                  net(link).stream_name(link->inner, slot->inner));
    return fail(link, slot, error);
  }
  if (slot->outcome == LinkResult::failed) return fail(link, slot, error);
  if (slot->outcome == LinkResult::done) slot->phase = Phase::connected;
  return slot->outcome;
}

LinkResult connected(Link* base, int stream, Error* error) {
  Slot* slot = slot_of(shaped(base), stream);
  if (!slot) return stale_stream(error);
  tell_clock(shaped(base));
  return progress(shaped(base), slot, error);
}

int listen(Link* base, const LinkAddress& address, Error* error) {
  ShapedLink* link = shaped(base);
  Slot* slot = take_slot(link, -1, Phase::passed, error);
  if (!slot) return -1;
  slot->inner = net(link).listen(link->inner, address, error);
  if (slot->inner < 0) slot->phase = Phase::unused;
  return slot->inner < 0 ? -1 : stream_number(link->slots, slot);
}

LinkResult accept(Link* base, int listener, int* stream, Error* error) {
  ShapedLink* link = shaped(base);
  Slot* from = slot_of(link, listener);
  if (!from || from->phase != Phase::passed) return stale_stream(error);
  Slot* slot = take_slot(link, -1, Phase::passed, error);  // first, because a closing one occupies an inner stream, too
  LinkResult result = net(link).accept(link->inner, from->inner, slot ? &slot->inner : stream, error);
  if (result == LinkResult::done && slot) {
    *stream = stream_number(link->slots, slot);
    return result;
  }
  if (slot) slot->phase = Phase::unused;
  if (result != LinkResult::done) return result;
  net(link).close(link->inner, *stream);
  return LinkResult::failed;
}

const char* stream_name(const Link* base, int stream) {
  ShapedLink* link = shaped(const_cast<Link*>(base));
  const Slot* slot = slot_of(link, stream);
  if (!slot) return "";
  return slot->inner >= 0 ? net(link).stream_name(link->inner, slot->inner) : slot->name;
}

LinkResult read(Link* base, int stream, void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                Error* error) {
  *byte_count = 0;
  ShapedLink* link = shaped(base);
  Slot* slot = slot_of(link, stream);
  if (!slot) return stale_stream(error);
  if (slot->phase == Phase::passed)
    return net(link).read(link->inner, slot->inner, bytes, byte_count_max, byte_count, error);
  tell_clock(link);
  LinkResult state = progress(link, slot, error);
  if (state != LinkResult::done || byte_count_max == 0) return state == LinkResult::failed ? state : LinkResult::later;
  move(link, slot);
  *byte_count = pull_bytes(&slot->in, static_cast<unsigned char*>(bytes), byte_count_max, link->clock_ns);
  if (*byte_count > 0) return LinkResult::done;
  if (slot->in.reset_ns <= link->clock_ns) return fail(link, slot, error);
  return slot->in.end_ns <= link->clock_ns ? LinkResult::ended : LinkResult::later;
}

LinkResult write(Link* base, int stream, const void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                 Error* error) {
  *byte_count = 0;
  ShapedLink* link = shaped(base);
  Slot* slot = slot_of(link, stream);
  if (!slot) return stale_stream(error);
  if (slot->phase == Phase::passed)
    return net(link).write(link->inner, slot->inner, bytes, byte_count_max, byte_count, error);
  tell_clock(link);
  LinkResult state = progress(link, slot, error);
  if (state != LinkResult::done) return state;
  move(link, slot);
  if (slot->in.reset_ns <= link->clock_ns) return fail(link, slot, error);
  while (*byte_count < byte_count_max) {
    std::size_t room = pipe_room(slot->out), take = byte_count_max - *byte_count;
    if (take > room) take = room;
    if (take == 0) break;
    push_piece(&slot->out, static_cast<const unsigned char*>(bytes) + *byte_count, take, 0,
               line_arrival_ns(link->settings.line, take, link->clock_ns, &link->line_free_ns[1], &link->random));
    lose_piece(link->settings.line, &slot->out, &link->random);
    *byte_count += take;
  }
  move(link, slot);
  return *byte_count > 0 ? LinkResult::done : LinkResult::later;
}

// Sets what a wait's stream can do now; returns when it can do more, kNever if only the inner link can tell.
std::uint64_t look(ShapedLink* link, Slot* slot, LinkWait* wait) {
  Error error;
  LinkResult state = slot ? progress(link, slot, &error) : LinkResult::failed;
  if (state == LinkResult::later) return slot->news_ns > link->clock_ns ? slot->news_ns : kNever;
  bool failed = state == LinkResult::failed || slot->in.reset_ns <= link->clock_ns;
  std::uint64_t news_ns = failed ? 0 : pipe_news_ns(slot->in);
  wait->can_write = wait->want_write && (failed || pipe_room(slot->out) > 0);
  wait->can_read = wait->want_read && news_ns <= link->clock_ns;
  return wait->want_read ? news_ns : failed ? kNever : slot->in.reset_ns;
}

// The wait on the inner link for a stream that is not `passed`.
LinkWait ask(const Slot& slot) {
  LinkWait wait;
  bool open = slot.phase == Phase::connected && !slot.lost;
  bool connecting = slot.phase == Phase::connecting && slot.outcome == LinkResult::later;
  wait.stream = slot.inner;
  wait.want_read = open && slot.in.end_ns == kNever && pipe_room(slot.in) > 0;
  wait.want_write = connecting || ((open || slot.phase == Phase::closing) && slot.blocked);
  return wait;
}

// One round of poll(): finds what is ready now or after the inner link has waited for at most `wait_ns`.
int poll_once(ShapedLink* link, LinkWait* waits, int wait_count, std::uint64_t wait_ns) {
  std::uint64_t next_ns = link->clock_ns + wait_ns;
  int ready_count = 0, inner_count = 0;
  auto consider = [&](std::uint64_t news_ns) {
    if (news_ns > link->clock_ns && news_ns < next_ns) next_ns = news_ns;
  };
  // 1. What the device can do now.
  for (int i = 0; i < wait_count; ++i) {
    Slot* slot = slot_of(link, waits[i].stream);
    waits[i].can_read = waits[i].can_write = false;
    if ((!waits[i].want_read && !waits[i].want_write) || (slot && slot->phase == Phase::passed)) continue;
    consider(look(link, slot, &waits[i]));
    if (waits[i].can_read || waits[i].can_write) ++ready_count;
  }
  // 2. What else moves bytes: the inner link, and bytes that cross the line to it.
  for (int i = 0; i < link->slot_count; ++i) {
    const Slot& slot = link->slots[i];
    if (slot.phase == Phase::unused || slot.phase == Phase::broken || slot.phase == Phase::passed) continue;
    LinkWait wait = ask(slot);
    if (wait.want_read || wait.want_write) link->waits[inner_count++] = wait;
    if (slot.out.piece_count > 0) consider(slot.out.pieces[slot.out.piece_first].arrival_ns);
  }
  int own_count = inner_count;
  for (int i = 0; i < wait_count && inner_count < link->slot_count; ++i) {
    Slot* slot = slot_of(link, waits[i].stream);
    if (!slot || slot->phase != Phase::passed) continue;
    link->waits[inner_count] = waits[i];
    link->waits[inner_count++].stream = slot->inner;
  }
  // 3. Wait. If the inner link reports nothing, that much time has passed, whatever its clock says.
  PLATFORM_CHECK_LE(inner_count, link->slot_count);
  std::uint64_t until_ns = ready_count > 0 ? link->clock_ns : next_ns;
  int told_count = net(link).poll(link->inner, link->waits, inner_count, until_ns - link->clock_ns);
  if (tell_clock(link) < until_ns && told_count == 0) link->clock_ns = until_ns;
  for (int i = 0, at = own_count; i < wait_count && at < inner_count; ++i) {
    Slot* slot = slot_of(link, waits[i].stream);
    if (!slot || slot->phase != Phase::passed) continue;
    waits[i].can_read = link->waits[at].can_read;
    waits[i].can_write = link->waits[at++].can_write;
    if (waits[i].can_read || waits[i].can_write) ++ready_count;
  }
  return ready_count;
}

int poll(Link* base, LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  PLATFORM_CHECK(wait_count == 0 || (wait_count > 0 && waits != nullptr));
  ShapedLink* link = shaped(base);
  if (wait_count > link->slot_count) wait_count = link->slot_count;
  std::uint64_t until_ns = tell_clock(link) + (timeout_ns < kHourNs ? timeout_ns : kHourNs);
  for (;;) {
    for (int i = 0; i < link->slot_count; ++i) move(link, &link->slots[i]);
    bool over = link->clock_ns >= until_ns;
    int ready_count = poll_once(link, waits, wait_count, over ? 0 : until_ns - link->clock_ns);
    if (ready_count > 0 || over) return ready_count;
  }
}

std::uint64_t now_ns(Link* base) { return net(shaped(base)).now_ns(shaped(base)->inner); }

void close_stream(Link* base, int stream) {
  ShapedLink* link = shaped(base);
  Slot* slot = slot_of(link, stream);
  if (!slot) return;
  bool travels = slot->phase == Phase::connected && !slot->lost;
  if (!travels) close_inner(link, slot);
  slot->phase = travels ? Phase::closing : Phase::unused;
  if (travels) move(link, slot);
}

void close_all(Link* base) {
  ShapedLink* link = shaped(base);
  for (int i = 0; i < link->slot_count; ++i)
    if (link->slots[i].phase != Phase::unused) free_closing(link, &link->slots[i]);
}

std::size_t no_need(int) { return 0; }

Link* no_open(const LinkOptions&, Error* error) {
  std::snprintf(error->text, sizeof error->text, "this link wraps another: open it with shaped_link_open()");
  return nullptr;
}

}  // namespace

LinkBackend shaped_link_backend(const LinkBackend& inner) {
  return {"shaped",    no_need, no_open, inner.resolve, connect, connected,    listen,   accept,
          stream_name, read,    write,   poll,          now_ns,  close_stream, close_all};
}

ShapedLinkSettings shaped_link_settings(const Device& device) {
  ShapedLinkSettings settings;
  settings.line = {device.link_bytes_per_second, device.link_latency_ns, device.link_jitter_ns, 0};
  return settings;
}

std::size_t shaped_pipe_bytes(const LinkLine& line) {
  constexpr std::uint64_t kLeast = 65536, kMost = kPiecesMax * kPieceBytesMax;
  std::uint64_t way_us = 2 * (line.latency_ns + line.jitter_ns) / 1000;
  if (line.bytes_per_second == 0 || line.bytes_per_second > kMost * 1'000'000 / (way_us + 1)) return kMost;
  std::uint64_t bytes = line.bytes_per_second * way_us / 1'000'000;
  return static_cast<std::size_t>(bytes < kLeast ? kLeast : bytes < kMost ? bytes : kMost);
}

std::size_t shaped_link_need(int stream_count_max, const ShapedLinkSettings& settings) {
  std::size_t each = sizeof(Slot) + 2 * pipe_need(shaped_pipe_bytes(settings.line)) + sizeof(LinkWait);
  return sizeof(ShapedLink) + static_cast<std::size_t>(stream_count_max) * each;
}

Link* shaped_link_open(Link* inner, const LinkOptions& options, const ShapedLinkSettings& settings, Error* error) {
  PLATFORM_CHECK(inner != nullptr && inner->backend != nullptr);
  int count = options.stream_count_max;
  if (count < 1 || count > kLinkStreamsMax || !options.memory ||
      options.memory_bytes < shaped_link_need(count, settings)) {
    std::snprintf(error->text, sizeof error->text,
                  "%d connections of at most %d by radio need %zu bytes but %zu were given", count, kLinkStreamsMax,
                  shaped_link_need(count, settings), options.memory_bytes);
    return nullptr;
  }
  std::memset(options.memory, 0, shaped_link_need(count, settings));
  ShapedLink* link = static_cast<ShapedLink*>(options.memory);
  link->functions = shaped_link_backend(*inner->backend);
  link->backend = &link->functions;
  link->inner = inner;
  link->settings = settings;
  link->inner_last_ns = net(link).now_ns(inner);
  link->random = settings.seed;
  link->slot_count = count;
  link->slots = reinterpret_cast<Slot*>(link + 1);
  unsigned char* memory = reinterpret_cast<unsigned char*>(link->slots + count);
  for (int i = 0; i < count; ++i) {
    place_pipe(&link->slots[i].in, shaped_pipe_bytes(settings.line), &memory);
    place_pipe(&link->slots[i].out, shaped_pipe_bytes(settings.line), &memory);
  }
  link->waits = reinterpret_cast<LinkWait*>(memory);
  return link;
}

}  // namespace platform
