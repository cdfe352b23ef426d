// A render server in a process of its own, which can be killed and stopped, and a proxy before it, over real sockets,
// that lets one thing go wrong with a message on its way to the device. Needs POSIX.
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
  // `run` gets a descriptor to write the port to, as an int, and does not return.
  void start(const std::function<void(int)>& run);
  void kill();
  void stop();  // it does nothing any more, its sockets stay
};

enum class ProxyFault : std::uint8_t {
  none,
  kill,       // the server
  stop,       // the server
  truncate,   // both sides see the end
  reset,      // the device sees a reset
  flip,       // one bit of the message
  silence,    // nothing comes any more
  trickle,    // one byte a second
  duplicate,  // the message comes twice
  swap,       // it comes behind the next rows
  replay,     // it comes once more behind the next but one
  replace,    // by bytes
};
const char* proxy_fault_name(ProxyFault fault);

// What befalls the first connection; those that follow are well.
struct ProxyPlan {
  ProxyFault fault = ProxyFault::none;
  int message = 0;      // the how manieth to the device, from 0
  bool middle = false;  // half of it has gone before
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

// On this machine, with the port that was free; -1 where there is none.
int listen_locally(int* port);

}  // namespace pocketray
