// A render server in its own process, which can be killed and stopped, and a proxy in front of it, over real sockets,
// that damages one message on its way to the device. Needs POSIX.
#pragma once
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace pocketray {

struct ServerProcess {
  pid_t pid = -1;
  int port = 0;

  ServerProcess() = default;
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;
  // `run` receives a descriptor to write the port to, as an int, and does not return.
  void start(const std::function<void(int)>& run);
  void kill();
  void stop();  // it does nothing more, but its sockets stay open
};

enum class ProxyFault : std::uint8_t {
  none,
  kill,       // the server
  stop,       // the server
  truncate,   // both sides see the end
  reset,      // the device sees a reset
  flip,       // one bit of the message
  silence,    // nothing arrives any more
  trickle,    // one byte a second
  duplicate,  // the message arrives twice
  swap,       // it arrives after the next rows
  replay,     // it arrives again after the next but one
  replace,    // by bytes
};
const char* proxy_fault_name(ProxyFault fault);

// The fault of the first connection; later ones have none.
struct ProxyPlan {
  ProxyFault fault = ProxyFault::none;
  int message = 0;      // index among those to the device, from 0
  bool middle = false;  // half of it was sent before the fault
  std::vector<std::uint8_t> bytes;
};

struct FaultyProxy {
  int port = 0;
  std::atomic<bool> struck{false};

  FaultyProxy(const ProxyPlan& plan, ServerProcess* server);
  ~FaultyProxy();
  FaultyProxy(const FaultyProxy&) = delete;
  FaultyProxy& operator=(const FaultyProxy&) = delete;

 private:
  struct Connection;
  void run();
  void serve(Connection* connection);
  bool forward_messages(Connection* connection);
  bool is_meant(const std::vector<std::uint8_t>& message) const;
  bool strike(Connection* connection, const std::vector<std::uint8_t>& message);

  ProxyPlan plan;
  ServerProcess* server;
  int listener = -1;
  bool faulty = true;
  std::atomic<bool> quit{false};
  std::thread thread;
};

// On this machine, with the free port chosen; -1 on failure.
int listen_locally(int* port);

}  // namespace pocketray
