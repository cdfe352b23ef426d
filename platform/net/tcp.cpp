#include "platform/net/tcp.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "platform/check.h"
#include "platform/net/descriptors.h"
#include "platform/net/link_slots.h"
#include "platform/net/resolve.h"

namespace platform {
namespace {

enum class Phase : std::uint8_t { unused, listening, connecting, connected, broken };

struct Slot {
  Phase phase;
  int file;          // -1: none
  int spare;         // of a listener: a descriptor to give up when none are left; otherwise -1
  int generation;    // counts the streams in this slot, which exposes stale ones
  int place;         // while connecting: the place of the address being tried
  int error_number;  // of the first place that failed; when broken: the reason
  LinkTimer timer;   // while connecting
  LinkAddress address;
  char name[kLinkNameBytes];
};

struct alignas(Slot) TcpLink : Link {  // followed by its slots
  std::uint64_t (*now_ns)();
  int slot_count;
  Slot* slots;
  pollfd* files;  // for poll(), one per slot
};

constexpr int kBacklog = 64;
constexpr int kUnsentBytes = 16384;  // that a system buffers beyond what it has sent
constexpr std::uint64_t kPollNsMax = 3'600'000'000'000;
constexpr std::uint64_t kBlindRestNs = 10'000'000;  // between two attempts while the system cannot tell what is ready

TcpLink* tcp(Link* link) { return static_cast<TcpLink*>(link); }

Slot* slot_of(TcpLink* link, int stream) { return slot_at(link->slots, link->slot_count, stream); }
int stream_of(const TcpLink* link, const Slot* slot) { return stream_number(link->slots, slot); }

Slot* take_slot(TcpLink* link, Error* error) {
  Slot* slot = free_slot(link->slots, link->slot_count, error);
  if (!slot) return nullptr;
  int generation = slot->generation;
  *slot = Slot();
  slot->generation = generation;
  slot->file = slot->spare = -1;
  return slot;
}

void close_file(Slot* slot) {
  if (slot->file >= 0) close(slot->file);  // not again after EINTR: the file is closed anyway
  if (slot->spare >= 0) close(slot->spare);
  slot->file = slot->spare = -1;
}

// Describes a failed connection and how to mend it.
void tell(const char* peer, int number, Error* error) {
  const char* what = nullptr;
  switch (number) {
    case ECONNREFUSED:
      what = "nothing is listening there: start `pocketray serve`, or name another port";
      break;
    case ETIMEDOUT:
      what = "no answer: is it on and within reach, and does its firewall let this port through?";
      break;
    case ENETUNREACH:
    case EHOSTUNREACH:
    case EADDRNOTAVAIL:
    case EAFNOSUPPORT:
    case ENETDOWN:
      what = "no route leads there: is the network up, and the address right?";
      break;
    case ECONNRESET:
    case ECONNABORTED:
    case EPIPE:
      what = "the peer closed the connection: it was stopped, or rejected what it received";
      break;
    case EADDRINUSE:
      what = "another program is listening there: stop it, or use another port";
      break;
    case EACCES:
    case EPERM:
      what = "not permitted: use a port above 1023, or ask the administrator of the firewall";
      break;
    case EMFILE:
    case ENFILE:
      what = "too many files are open: close some, or raise `ulimit -n`";
      break;
    default:
      break;
  }
  if (what) {
    snprintf(error->text, sizeof error->text, "%.95s: %s", peer, what);
  } else {
    snprintf(error->text, sizeof error->text, "%.95s: %s: try again, or name another", peer, strerror(number));
  }
}

LinkResult fail(Slot* slot, int number, Error* error) {
  close_file(slot);
  slot->phase = Phase::broken;
  slot->error_number = number;
  tell(slot->name, number, error);
  return LinkResult::failed;
}

bool prepare(int file) {
  int flags = fcntl(file, F_GETFL), one = 1;
#ifdef TCP_NOTSENT_LOWAT
  // Data buffered here rather than at the caller can no longer be changed and delays more urgent data. Only a hint:
  // older systems do not know it.
  int unsent_bytes = kUnsentBytes;
  setsockopt(file, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent_bytes, sizeof unsent_bytes);
#endif
  return flags >= 0 && fcntl(file, F_SETFL, flags | O_NONBLOCK) == 0 && fcntl(file, F_SETFD, FD_CLOEXEC) == 0 &&
         setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one) == 0;
}

bool would_wait(int number) { return number == EAGAIN || number == EWOULDBLOCK || number == EINTR; }

std::size_t need(int stream_count_max) {
  return sizeof(TcpLink) + static_cast<std::size_t>(stream_count_max) * (sizeof(Slot) + sizeof(pollfd));
}

Link* open(const LinkOptions& options, Error* error) {
  int count = options.stream_count_max;
  if (count < 1 || count > kLinkStreamsMax || !options.now_ns || !options.memory ||
      options.memory_bytes < need(count)) {
    snprintf(error->text, sizeof error->text,
             "%d connections of at most %d need %zu bytes and a clock, but %zu bytes were given", count,
             kLinkStreamsMax, need(count), options.memory_bytes);
    return nullptr;
  }
  memset(options.memory, 0, need(count));
  TcpLink* link = static_cast<TcpLink*>(options.memory);
  link->backend = &kTcpLink;
  link->now_ns = options.now_ns;
  link->slot_count = count;
  link->slots = reinterpret_cast<Slot*>(link + 1);
  link->files = reinterpret_cast<pollfd*>(link->slots + count);
  return link;
}

// A socket that is assigned the very port it connects to, where nobody listens, is connected to itself [RFC 9293,
// sec. 3.5, simultaneous open]; treated as refused.
bool is_own_peer(int file) {
  SocketAddress own = {}, peer = {};
  socklen_t own_bytes = sizeof own, peer_bytes = sizeof peer;
  return getsockname(file, &own.any, &own_bytes) == 0 && getpeername(file, &peer.any, &peer_bytes) == 0 &&
         own_bytes == peer_bytes && memcmp(&own, &peer, own_bytes) == 0;
}

// Tries the places of the address from slot->place on until one does not fail at once.
void try_places(Slot* slot) {
  for (; slot->place < slot->address.place_count; ++slot->place) {
    SocketAddress at = socket_address(slot->address, slot->place);
    slot->file = socket(at.any.sa_family, SOCK_STREAM, 0);
    bool begun = slot->file >= 0 && prepare(slot->file);
    // A connection established at once, as on this machine, is still reported by progress().
    if (begun &&
        (::connect(slot->file, &at.any, socket_address_bytes(at)) == 0 || errno == EINPROGRESS || errno == EINTR))
      return;
    if (slot->error_number == 0) slot->error_number = errno;
    close_file(slot);
  }
}

int connect(Link* base, const LinkAddress& address, std::uint64_t timeout_ns, Error* error) {
  PLATFORM_CHECK(address.place_count > 0 && address.place_count <= LinkAddress::kPlacesMax);  // it has been resolved
  TcpLink* link = tcp(base);
  Slot* slot = take_slot(link, error);
  if (!slot) return -1;
  slot->phase = Phase::connecting;
  slot->address = address;
  slot->timer = link_timer(link->now_ns(), timeout_ns);
  snprintf(slot->name, sizeof slot->name, "%s", address.text);
  try_places(slot);
  if (slot->file >= 0) return stream_of(link, slot);
  tell(address.text, slot->error_number ? slot->error_number : EADDRNOTAVAIL, error);
  slot->phase = Phase::unused;
  return -1;
}

// Advances connecting.
LinkResult progress(TcpLink* link, Slot* slot, Error* error) {
  if (slot->phase == Phase::connected) return LinkResult::done;
  if (slot->phase == Phase::listening) return stale_stream(error);
  if (slot->phase == Phase::broken) return fail(slot, slot->error_number, error);
  pollfd file = {slot->file, POLLOUT, 0};
  if (::poll(&file, 1, 0) > 0) {
    int number = 0;
    socklen_t bytes = sizeof number;
    if (getsockopt(slot->file, SOL_SOCKET, SO_ERROR, &number, &bytes) != 0) number = errno;
    if (number == 0 && is_own_peer(slot->file)) number = ECONNREFUSED;
    if (number == 0) {
      SocketAddress at = socket_address(slot->address, slot->place);
      socket_address_text(at, slot->name, sizeof slot->name);
      slot->phase = Phase::connected;
      return LinkResult::done;
    }
    if (slot->error_number == 0) slot->error_number = number;
    close_file(slot);
    ++slot->place;
    try_places(slot);
    if (slot->file < 0) return fail(slot, slot->error_number, error);
  }
  if (link_timer_left(&slot->timer, link->now_ns()) > 0) return LinkResult::later;
  return fail(slot, ETIMEDOUT, error);
}

LinkResult connected(Link* base, int stream, Error* error) {
  Slot* slot = slot_of(tcp(base), stream);
  return slot ? progress(tcp(base), slot, error) : stale_stream(error);
}

int listen(Link* base, const LinkAddress& address, Error* error) {
  PLATFORM_CHECK_GT(address.place_count, 0);
  TcpLink* link = tcp(base);
  Slot* slot = take_slot(link, error);
  if (!slot) return -1;
  SocketAddress at = socket_address(address, 0);
  int one = 1;
  slot->file = socket(at.any.sa_family, SOCK_STREAM, 0);
  bool ok =
      slot->file >= 0 && prepare(slot->file) &&
      setsockopt(slot->file, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one) == 0 &&
      (at.any.sa_family != AF_INET6 || setsockopt(slot->file, IPPROTO_IPV6, IPV6_V6ONLY, &one, sizeof one) == 0) &&
      bind(slot->file, &at.any, socket_address_bytes(at)) == 0 && ::listen(slot->file, kBacklog) == 0;
  socklen_t bytes = sizeof at;
  ok = ok && getsockname(slot->file, &at.any, &bytes) == 0;
  if (!ok) {
    tell(address.text, errno, error);
    close_file(slot);
    return -1;
  }
  socket_address_text(at, slot->name, sizeof slot->name);
  slot->phase = Phase::listening;
  slot->spare = take_spare();
  return stream_of(link, slot);
}

LinkResult accept(Link* base, int listener, int* stream, Error* error) {
  PLATFORM_CHECK(stream != nullptr);
  TcpLink* link = tcp(base);
  Slot* from = slot_of(link, listener);
  if (!from || from->phase != Phase::listening) return stale_stream(error);
  SocketAddress at = {};
  socklen_t bytes = sizeof at;
  int file = ::accept(from->file, &at.any, &bytes);
  if (file < 0) {
    if (would_wait(errno) || errno == ECONNABORTED) return LinkResult::later;
    tell(from->name, errno, error);
    if (is_shortage(errno)) from->spare = turn_away(from->file, from->spare);
    return LinkResult::failed;
  }
  // A peer without room is turned away: left waiting, it would make every poll() return at once.
  Slot* slot = take_slot(link, error);
  if (!slot || !prepare(file)) {
    if (slot) tell(from->name, errno, error);
    close(file);
    return LinkResult::failed;
  }
  slot->file = file;
  slot->phase = Phase::connected;
  socket_address_text(at, slot->name, sizeof slot->name);
  *stream = stream_of(link, slot);
  return LinkResult::done;
}

const char* stream_name(const Link* base, int stream) {
  const Slot* slot = slot_of(static_cast<TcpLink*>(const_cast<Link*>(base)), stream);
  return slot ? slot->name : "";
}

LinkResult read(Link* base, int stream, void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                Error* error) {
  *byte_count = 0;
  Slot* slot = slot_of(tcp(base), stream);
  if (!slot) return stale_stream(error);
  LinkResult state = progress(tcp(base), slot, error);
  if (state != LinkResult::done || byte_count_max == 0) return state == LinkResult::failed ? state : LinkResult::later;
  PLATFORM_CHECK(bytes != nullptr);
  ssize_t n = recv(slot->file, bytes, byte_count_max, 0);
  if (n == 0) return LinkResult::ended;
  if (n < 0) return would_wait(errno) ? LinkResult::later : fail(slot, errno, error);
  *byte_count = static_cast<std::size_t>(n);
  return LinkResult::done;
}

LinkResult write(Link* base, int stream, const void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                 Error* error) {
  *byte_count = 0;
  Slot* slot = slot_of(tcp(base), stream);
  if (!slot) return stale_stream(error);
  LinkResult state = progress(tcp(base), slot, error);
  if (state != LinkResult::done || byte_count_max == 0) return state == LinkResult::failed ? state : LinkResult::later;
  PLATFORM_CHECK(bytes != nullptr);
  ssize_t n = send(slot->file, bytes, byte_count_max, MSG_NOSIGNAL);
  if (n < 0) return would_wait(errno) ? LinkResult::later : fail(slot, errno, error);
  *byte_count = static_cast<std::size_t>(n);
  return LinkResult::done;
}

// Polls the first `file_count` of link->files. If the system cannot tell, for lack of memory or because the limit on
// open files was lowered, everything counts as ready after a pause: the next call on it finds out.
int ask_system(TcpLink* link, int file_count, std::uint64_t wait_ns) {
  PLATFORM_CHECK(file_count >= 0 && file_count <= link->slot_count);
  auto time_of = [](std::uint64_t ns) {
    return timespec{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
  };
  timespec time = time_of(wait_ns);
  int woken = ppoll(link->files, static_cast<nfds_t>(file_count), &time, nullptr);
  if (woken >= 0 || errno == EINTR) return woken;
  time = time_of(wait_ns < kBlindRestNs ? wait_ns : kBlindRestNs);
  nanosleep(&time, nullptr);
  for (int i = 0; i < file_count; ++i) link->files[i].revents = link->files[i].events;
  return file_count;
}

// One round of poll(): finds what is ready after the system has waited for at most `wait_ns`. Adds time waited in vain
// to `waited_ns`.
int poll_once(TcpLink* link, LinkWait* waits, int wait_count, std::uint64_t wait_ns, std::uint64_t* waited_ns) {
  // 1. Ask the system only about open files, since it takes no more entries than files may be open. A connection that
  // fails in time is handled when its time is up.
  int file_count = 0;
  for (int i = 0; i < wait_count; ++i) {
    Slot* slot = slot_of(link, waits[i].stream);
    waits[i].can_read = waits[i].can_write = false;
    if (!waits[i].want_read && !waits[i].want_write) continue;
    if (!slot || slot->phase == Phase::broken) {
      wait_ns = 0;
      continue;
    }
    bool connecting = slot->phase == Phase::connecting;
    if (connecting) {
      std::uint64_t left = link_timer_left(&slot->timer, link->now_ns());
      if (left < wait_ns) wait_ns = left;
    }
    waits[i].can_read = true;  // the system is asked about it
    pollfd* file = &link->files[file_count++];
    *file = {slot->file, 0, 0};
    if (waits[i].want_read && !connecting) file->events |= POLLIN;
    if (waits[i].want_write || connecting) file->events |= POLLOUT;
  }
  int woken = ask_system(link, file_count, wait_ns);
  if (woken == 0) *waited_ns += wait_ns;

  // 2. Its answers, in the same order.
  int ready_count = 0;
  const pollfd* file = link->files;
  for (int i = 0; i < wait_count; ++i) {
    LinkWait* wait = &waits[i];
    if (!wait->want_read && !wait->want_write) continue;
    Slot* slot = slot_of(link, wait->stream);
    short events = wait->can_read && woken > 0 ? file->revents : 0;
    if (wait->can_read) ++file;
    wait->can_read = false;
    bool failed = !slot || slot->phase == Phase::broken || (events & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    if (slot && slot->phase == Phase::connecting) {
      Error error;
      LinkResult outcome = progress(link, slot, &error);
      failed = outcome == LinkResult::failed;
      wait->can_write = wait->want_write && outcome == LinkResult::done;
    } else {
      wait->can_write = wait->want_write && (events & POLLOUT) != 0;
      wait->can_read = wait->want_read && (events & POLLIN) != 0;
    }
    if (failed) {
      wait->can_read = wait->want_read;
      wait->can_write = wait->want_write;
    }
    if (wait->can_read || wait->can_write) ++ready_count;
  }
  return ready_count;
}

// Waits again after a signal, and when a connection moved on to the next place of its address.
int poll(Link* base, LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  PLATFORM_CHECK(wait_count == 0 || (wait_count > 0 && waits != nullptr));
  TcpLink* link = tcp(base);
  if (wait_count > link->slot_count) wait_count = link->slot_count;
  LinkTimer timer = link_timer(link->now_ns(), timeout_ns < kPollNsMax ? timeout_ns : kPollNsMax);
  std::uint64_t waited_ns = 0;  // ends the wait if the clock stands still
  for (;;) {
    std::uint64_t left = link_timer_left(&timer, link->now_ns());
    int ready_count = poll_once(link, waits, wait_count, left, &waited_ns);
    if (ready_count > 0 || left == 0 || waited_ns >= timer.timeout_ns) return ready_count;
  }
}

std::uint64_t now_ns(Link* link) { return tcp(link)->now_ns(); }

void close_stream(Link* link, int stream) {
  Slot* slot = slot_of(tcp(link), stream);
  if (!slot) return;
  close_file(slot);
  slot->phase = Phase::unused;
}

void close_all(Link* base) {
  TcpLink* link = tcp(base);
  for (int i = 0; i < link->slot_count; ++i)
    if (link->slots[i].phase != Phase::unused) close_stream(base, stream_of(link, &link->slots[i]));
}

}  // namespace

const LinkBackend kTcpLink = {"tcp", need,  open, resolve_address, connect,      connected, listen, accept, stream_name,
                              read,  write, poll, now_ns,          close_stream, close_all};

}  // namespace platform
