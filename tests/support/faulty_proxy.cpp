#include "support/faulty_proxy.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "wire/message.h"

namespace pocketray {
namespace {

sockaddr_in local_address(int port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

void send_all(int to, const std::uint8_t* bytes, std::size_t byte_count) {
  while (byte_count > 0) {
    ssize_t sent = send(to, bytes, byte_count, MSG_NOSIGNAL);
    if (sent <= 0) return;
    bytes += sent, byte_count -= static_cast<std::size_t>(sent);
  }
}

}  // namespace

// Duplicate pings do no harm: only rows are to be repeated.
bool FaultyProxy::is_meant(const std::vector<std::uint8_t>& message) const {
  bool repeats =
      plan.fault == ProxyFault::duplicate || plan.fault == ProxyFault::swap || plan.fault == ProxyFault::replay;
  return !repeats || message[0] == static_cast<std::uint8_t>(MessageType::row_chunk);
}

const char* proxy_fault_name(ProxyFault fault) {
  static const char* const kNames[] = {"none",    "kill",    "stop",      "truncate", "reset",  "flip",
                                       "silence", "trickle", "duplicate", "swap",     "replay", "replace"};
  return kNames[static_cast<int>(fault)];
}

ServerProcess::~ServerProcess() { kill(); }

void ServerProcess::start(const std::function<void(int)>& run) {
  kill();
  int ends[2];
  if (pipe(ends) != 0) return;
  pid = fork();
  if (pid == 0) {
    for (int file = 3; file < 256;
         ++file)  // other ends of connections, which would keep them open when the others close them
      if (file != ends[1]) close(file);
    signal(SIGTERM, SIG_DFL);  // not the tests' handler
    run(ends[1]);
    _exit(1);
  }
  close(ends[1]);
  if (read(ends[0], &port, sizeof port) != sizeof port) port = 0;
  close(ends[0]);
}

void ServerProcess::kill() {
  if (pid <= 0) return;
  ::kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  pid = -1;
}

void ServerProcess::stop() {
  if (pid > 0) ::kill(pid, SIGSTOP);
}

int listen_locally(int* port) {
  int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = local_address(0);
  socklen_t length = sizeof address;
  if (bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 || listen(listener, 8) != 0 ||
      getsockname(listener, reinterpret_cast<sockaddr*>(&address), &length) != 0) {
    close(listener);
    return -1;
  }
  *port = ntohs(address.sin_port);
  return listener;
}

struct FaultyProxy::Connection {
  int device, server;
  bool faulty;
  int message_count = 0;
  bool silent = false, trickles = false;
  std::vector<std::uint8_t> input;             // from the server
  std::vector<std::uint8_t> held;              // to be sent after later messages
  int held_for = 0;                            // number of these messages
  std::vector<std::uint8_t> slow;              // trickles
  std::chrono::steady_clock::time_point last;  // last byte of it
};

FaultyProxy::FaultyProxy(const ProxyPlan& given, ServerProcess* of) : plan(given), server(of) {
  listener = listen_locally(&port);
  fcntl(listener, F_SETFL, O_NONBLOCK);
  thread = std::thread([this] { run(); });
}

FaultyProxy::~FaultyProxy() {
  quit = true;
  thread.join();
  close(listener);
}

void FaultyProxy::run() {
  while (!quit) {
    pollfd wait = {listener, POLLIN, 0};
    if (poll(&wait, 1, 5) <= 0) continue;
    int device = accept(listener, nullptr, nullptr);
    if (device < 0) continue;
    Connection connection = {};
    connection.device = device;
    connection.server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    timeval limit = {0, 50'000};  // a stopped server accepts nothing
    setsockopt(connection.server, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    connection.faulty = faulty && plan.fault != ProxyFault::none;
    faulty = false;
    sockaddr_in address = local_address(server->port);
    if (connect(connection.server, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) serve(&connection);
    close(connection.server);
    close(device);
  }
}

// Carries bytes until one side ends; passes the server's data on message by message.
void FaultyProxy::serve(Connection* c) {
  std::uint8_t bytes[8192];
  while (!quit) {
    pollfd waits[2] = {{c->device, POLLIN, 0}, {c->server, POLLIN, 0}};
    poll(waits, 2, 5);
    if (waits[0].revents) {
      ssize_t count = recv(c->device, bytes, sizeof bytes, 0);
      if (count <= 0) return;
      send_all(c->server, bytes, static_cast<std::size_t>(count));
    }
    if (waits[1].revents) {
      ssize_t count = recv(c->server, bytes, sizeof bytes, 0);
      if (count <= 0) return;
      c->input.insert(c->input.end(), bytes, bytes + count);
      if (!forward_messages(c)) return;
    }
    if (!c->slow.empty() && std::chrono::steady_clock::now() > c->last + std::chrono::seconds(1)) {
      send_all(c->device, c->slow.data(), 1);
      c->slow.erase(c->slow.begin());
      c->last = std::chrono::steady_clock::now();
    }
  }
}

bool FaultyProxy::forward_messages(Connection* c) {
  for (;;) {
    if (c->input.size() < kHeaderBytes) return true;
    std::size_t length = kHeaderBytes + (c->input[1] | c->input[2] << 8 | c->input[3] << 16);
    if (c->input.size() < length) return true;
    auto end = c->input.begin() + static_cast<std::ptrdiff_t>(length);
    std::vector<std::uint8_t> message(c->input.begin(), end);
    c->input.erase(c->input.begin(), end);
    if (c->faulty && c->message_count++ >= plan.message && is_meant(message)) {
      c->faulty = false;
      struck = true;
      if (!strike(c, message)) return false;
      continue;
    }
    if (c->silent) continue;
    if (c->trickles) {
      c->slow.insert(c->slow.end(), message.begin(), message.end());
      continue;
    }
    send_all(c->device, message.data(), message.size());
    bool has_rows = message[0] == static_cast<std::uint8_t>(MessageType::row_chunk);
    if (c->held_for > 0 && has_rows && --c->held_for == 0) send_all(c->device, c->held.data(), c->held.size());
  }
}

// False: the connection must be closed.
bool FaultyProxy::strike(Connection* c, const std::vector<std::uint8_t>& message) {
  std::vector<std::uint8_t> bytes = message;
  std::size_t part = plan.middle ? message.size() / 2 : 0;
  switch (plan.fault) {
    case ProxyFault::flip:
      bytes[part] ^= 0x10;
      break;
    case ProxyFault::duplicate:
      bytes.insert(bytes.end(), message.begin(), message.end());
      break;
    case ProxyFault::replay:
      c->held = message, c->held_for = 2;
      break;
    case ProxyFault::replace:
      bytes = plan.bytes;
      break;
    case ProxyFault::swap:
      c->held = message, c->held_for = 1;
      return true;
    default:
      bytes.resize(part);
  }
  send_all(c->device, bytes.data(), bytes.size());
  if (plan.fault == ProxyFault::kill) ::kill(server->pid, SIGKILL);
  if (plan.fault == ProxyFault::stop) server->stop();
  c->silent = plan.fault == ProxyFault::silence || plan.fault == ProxyFault::stop || plan.fault == ProxyFault::kill;
  c->trickles = plan.fault == ProxyFault::trickle;
  if (c->trickles) c->slow.assign(message.begin() + static_cast<std::ptrdiff_t>(part), message.end());
  if (plan.fault == ProxyFault::reset) {
    linger now = {1, 0};
    setsockopt(c->device, SOL_SOCKET, SO_LINGER, &now, sizeof now);
  }
  return plan.fault != ProxyFault::reset && plan.fault != ProxyFault::truncate;
}

}  // namespace pocketray
