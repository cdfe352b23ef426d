#include "platform/null/net/null_link.h"

#include <cstdio>
#include <cstring>

#include "platform/check.h"
#include "platform/null/net/null_state.h"

namespace platform {
using namespace null_link;
namespace {

const char* stream_name(const Link* base, int stream) {
  const Slot* slot = slot_of(null(const_cast<Link*>(base)), stream);
  return slot ? slot->name : "";
}

LinkResult read(Link* base, int stream, void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                Error* error) {
  *byte_count = 0;
  NullLink* link = null(base);
  Slot* slot = slot_of(link, stream);
  if (!slot) return stale_stream(error);
  LinkResult state = progress(link, slot, error);
  if (state == LinkResult::failed) return state;
  if (state == LinkResult::later || byte_count_max == 0) return LinkResult::later;
  *byte_count = pull_bytes(&slot->in, static_cast<unsigned char*>(bytes), byte_count_max, link->clock_ns);
  (slot->device ? link->record.bytes_to_device : link->record.bytes_from_device) += *byte_count;
  if (*byte_count > 0) return LinkResult::done;
  if (slot->in.reset_ns <= link->clock_ns) return fail(slot, kBrokenText, error);
  bool ended = slot->in.end_ns <= link->clock_ns && slot->in.used == 0;
  return ended ? LinkResult::ended : LinkResult::later;
}

// Returns a fault that strikes the next byte for `to`, or null; `byte_count` is then cut to end before the next fault.
const NullFault* fault_at(NullLink* link, Slot* to, std::size_t* byte_count) {
  const NullLinkSettings& settings = link->settings;
  for (int i = 0; i < settings.fault_count; ++i) {
    const NullFault& fault = settings.faults[i];
    bool struck = (to->in.faults_struck >> i & 1) != 0;
    if (struck || at_start(fault.fault) || fault.to_device != to->device || !meant_for(fault, *to)) continue;
    if (fault.at_byte <= to->in.byte_index) {
      to->in.faults_struck |= std::uint32_t{1} << i;
      ++link->record.faults_struck;
      return &fault;
    }
    std::uint64_t distance = fault.at_byte - to->in.byte_index;
    if (distance < *byte_count) *byte_count = static_cast<std::size_t>(distance);
  }
  return nullptr;
}

// Sends one piece: it occupies the line for its bytes, then takes latency and jitter.
void send_piece(NullLink* link, Slot* to, const unsigned char* bytes, std::size_t byte_count, unsigned char flip) {
  const NullLinkSettings& settings = link->settings;
  LinkPipe* pipe = &to->in;
  bool shares_radio = !pipe->trickles && !to->elsewhere && !settings.lines_apart;
  std::uint64_t* free_ns = shares_radio ? &link->line_free_ns[to->device] : &pipe->free_ns;
  std::uint64_t bytes_per_second = pipe->trickles ? 1 : to->elsewhere ? 0 : settings.bytes_per_second;
  LinkLine line = {bytes_per_second, settings.latency_ns, settings.jitter_ns, settings.lost_per_million};
  std::uint64_t arrival_ns = line_arrival_ns(line, byte_count, link->clock_ns, free_ns, &link->random);
  push_piece(pipe, bytes, byte_count, flip, pipe->silent ? kNever : arrival_ns);
  if (!pipe->silent) lose_piece(line, pipe, &link->random);
}

// Applies a fault to the line; returns false if the connection is gone.
bool strike(NullLink* link, Slot* from, Slot* to, LinkFault fault, unsigned char* flip, bool* twice) {
  switch (fault) {
    case LinkFault::reset:
      to->in.reset_ns = link->clock_ns + link->settings.latency_ns;
      break;
    case LinkFault::truncate:
      to->in.end_ns = link->clock_ns + link->settings.latency_ns;
      if (to->in.end_ns < to->in.arrival_last_ns) to->in.end_ns = to->in.arrival_last_ns;
      break;
    case LinkFault::flip:
      *flip = static_cast<unsigned char>(1u << random_u64(&link->random) % 8);
      break;
    case LinkFault::duplicate:
      *twice = true;
      break;
    case LinkFault::silence:
      to->in.silent = true;
      break;
    case LinkFault::trickle:
      to->in.trickles = true;
      break;
    case LinkFault::clock_back:
      link->set_back_ns += 1 + random_u64(&link->random) % (10 * kSecondNs);
      break;
    case LinkFault::refuse:
    case LinkFault::no_answer:
      break;
  }
  if (fault != LinkFault::reset && fault != LinkFault::truncate) return true;
  from->other = to->other = -1;
  return false;
}

LinkResult write(Link* base, int stream, const void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                 Error* error) {
  *byte_count = 0;
  NullLink* link = null(base);
  Slot* slot = slot_of(link, stream);
  if (!slot) return stale_stream(error);
  LinkResult state = progress(link, slot, error);
  if (state != LinkResult::done) return state;
  if (slot->in.reset_ns <= link->clock_ns) return fail(slot, kBrokenText, error);
  const unsigned char* next = static_cast<const unsigned char*>(bytes);
  while (*byte_count < byte_count_max) {
    // 1. To a peer that is gone: until the news arrives, bytes are silently lost.
    Slot* to = slot->other >= 0 ? &link->slots[slot->other] : nullptr;
    if (!to) {
      if (*byte_count == 0 && slot->in.end_ns <= link->clock_ns) return fail(slot, kBrokenText, error);
      *byte_count = byte_count_max;
      break;
    }
    // 2. A piece, up to the next fault.
    std::size_t room = pipe_room(to->in), take = byte_count_max - *byte_count;
    if (room == 0) break;
    if (take > room) take = room;
    if (to->in.trickles) take = 1;
    unsigned char flip = 0;
    bool twice = false;
    while (const NullFault* fault = fault_at(link, to, &take)) {
      if (strike(link, slot, to, fault->fault, &flip, &twice)) continue;
      LinkResult result = fail(slot, kBrokenText, error);
      return *byte_count > 0 ? LinkResult::done : result;
    }
    if (to->in.trickles) take = 1;
    send_piece(link, to, next + *byte_count, take, flip);
    if (twice && pipe_room(to->in) >= take) send_piece(link, to, next + *byte_count, take, flip);
    to->in.byte_index += take;
    *byte_count += take;
  }
  return *byte_count > 0 ? LinkResult::done : LinkResult::later;
}

// Sets what the stream of a wait can do now; returns when it can do more, kNever if that takes another stream.
std::uint64_t look(NullLink* link, LinkWait* wait) {
  wait->can_read = wait->can_write = false;
  Slot* slot = slot_of(link, wait->stream);
  Error error;
  if (slot && slot->phase == Phase::listening) {
    Slot* waiting = waiting_at(link, slot);
    wait->can_read = wait->want_read && waiting && waiting->news_ns <= link->clock_ns;
    return wait->want_read && waiting ? waiting->news_ns : kNever;
  }
  LinkResult state = slot ? progress(link, slot, &error) : LinkResult::failed;
  if (state == LinkResult::later) return slot->news_ns < slot->deadline_ns ? slot->news_ns : slot->deadline_ns;
  bool failed = state == LinkResult::failed;
  bool told_end = !failed && (slot->in.end_ns <= link->clock_ns || slot->in.reset_ns <= link->clock_ns);
  // A peer that is gone always has room: nothing stays in its pipe.
  bool room = !failed && (slot->other < 0 || pipe_room(link->slots[slot->other].in) > 0);
  wait->can_write = wait->want_write && (failed || told_end || room);
  std::uint64_t news_ns = failed ? 0 : pipe_news_ns(slot->in);
  wait->can_read = wait->want_read && news_ns <= link->clock_ns;
  return wait->want_read || !slot ? news_ns : slot->in.reset_ns;
}

int poll(Link* base, LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  PLATFORM_CHECK(wait_count == 0 || (wait_count > 0 && waits != nullptr));
  NullLink* link = null(base);
  if (wait_count > link->slot_count) wait_count = link->slot_count;
  std::uint64_t until_ns = timeout_ns < kClockStartNs ? link->clock_ns + timeout_ns : link->clock_ns + kClockStartNs;
  for (;;) {
    int ready_count = 0;
    std::uint64_t next_ns = until_ns;
    for (int i = 0; i < wait_count; ++i) {
      if (!waits[i].want_read && !waits[i].want_write) {
        waits[i].can_read = waits[i].can_write = false;
        continue;
      }
      std::uint64_t news_ns = look(link, &waits[i]);
      if (waits[i].can_read || waits[i].can_write) ++ready_count;
      if (news_ns > link->clock_ns && news_ns < next_ns) next_ns = news_ns;
    }
    if (ready_count > 0 || link->clock_ns == until_ns) return ready_count;
    link->clock_ns = next_ns;
  }
}

std::uint64_t now_ns(Link* base) {
  NullLink* link = null(base);
  link->clock_ns += link->settings.clock_step_ns;
  return link->clock_ns - link->set_back_ns;
}

std::size_t need(int stream_count_max) { return null_link_need(stream_count_max, NullLinkSettings()); }

Link* open(const LinkOptions& options, Error* error) { return null_link_open(options, NullLinkSettings(), error); }

}  // namespace

const LinkBackend kNullLink = {"null",      need, open,  resolve, connect, connected,    listen,   accept,
                               stream_name, read, write, poll,    now_ns,  close_stream, close_all};

std::size_t null_link_need(int stream_count_max, const NullLinkSettings& settings) {
  return sizeof(NullLink) +
         static_cast<std::size_t>(stream_count_max) * (sizeof(Slot) + pipe_need(settings.pipe_bytes));
}

Link* null_link_open(const LinkOptions& options, const NullLinkSettings& settings, Error* error) {
  PLATFORM_CHECK_EQ(reinterpret_cast<std::uintptr_t>(options.memory) % alignof(NullLink), 0u);
  int count = options.stream_count_max;
  if (count < 1 || count > kLinkStreamsMax || !options.memory || settings.fault_count > kNullFaultsMax ||
      settings.pipe_bytes == 0 || options.memory_bytes < null_link_need(count, settings)) {
    std::snprintf(error->text, sizeof error->text,
                  "%d connections of at most %d need %zu bytes but %zu were given; at most %d faults", count,
                  kLinkStreamsMax, null_link_need(count, settings), options.memory_bytes, kNullFaultsMax);
    return nullptr;
  }
  std::memset(options.memory, 0, sizeof(NullLink) + static_cast<std::size_t>(count) * sizeof(Slot));
  NullLink* link = static_cast<NullLink*>(options.memory);
  link->backend = &kNullLink;
  link->settings = settings;
  link->clock_ns = kClockStartNs;
  link->random = settings.seed;
  link->slot_count = count;
  link->port_last = 49151;
  link->slots = reinterpret_cast<Slot*>(link + 1);
  unsigned char* memory = reinterpret_cast<unsigned char*>(link->slots + count);
  for (int i = 0; i < count; ++i) place_pipe(&link->slots[i].in, settings.pipe_bytes, &memory);
  return link;
}

NullLinkRecord null_link_record(const Link* link) {
  const NullLink* of = static_cast<const NullLink*>(link);
  NullLinkRecord record = of->record;
  record.elapsed_ns = of->clock_ns - kClockStartNs;
  return record;
}

}  // namespace platform
