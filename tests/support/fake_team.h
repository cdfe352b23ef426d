// A team in one program: ranks are threads, and messages are queued in order. For tests of what teams do.
#pragma once
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "session/team.h"

namespace pocketray {

class FakeTeam {
 public:
  explicit FakeTeam(std::uint32_t size) {
    for (std::uint32_t rank = 0; rank < size; ++rank) {
      seats_.push_back(std::make_unique<Seat>());
      seats_.back()->team = this, seats_.back()->rank = rank;
    }
  }

  Team of(std::uint32_t rank) {
    static const TeamBackend kBackend = {send, receive, abort};
    return {rank, static_cast<std::uint32_t>(seats_.size()), 1, &kBackend, seats_[rank].get()};
  }

  // Calls run(team) on a thread for each rank and returns their exit statuses.
  std::vector<int> run(const std::function<int(const Team&)>& run_rank) {
    std::vector<int> exits(seats_.size(), -1);
    std::vector<std::thread> threads;
    for (std::uint32_t rank = 0; rank < seats_.size(); ++rank)
      threads.emplace_back([&, rank] { exits[rank] = run_rank(of(rank)); });
    for (std::thread& thread : threads) thread.join();
    return exits;
  }

 private:
  struct Seat {
    FakeTeam* team = nullptr;
    std::uint32_t rank = 0;
    std::mutex mutex;
    std::condition_variable arrived;
    std::deque<TeamMessage> messages;
  };

  static void send(void* context, std::uint32_t to, const std::uint8_t* bytes, std::size_t byte_count) {
    const Seat* from = static_cast<Seat*>(context);
    Seat* seat = from->team->seats_[to].get();
    std::lock_guard<std::mutex> lock(seat->mutex);
    seat->messages.push_back({from->rank, {bytes, bytes + byte_count}});
    seat->arrived.notify_one();
  }
  static bool receive(void* context, double seconds, TeamMessage* message) {
    Seat* seat = static_cast<Seat*>(context);
    std::unique_lock<std::mutex> lock(seat->mutex);
    if (!seat->arrived.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return !seat->messages.empty(); }))
      return false;
    *message = std::move(seat->messages.front());
    seat->messages.pop_front();
    return true;
  }
  static void abort(void*, int) { std::abort(); }

  std::vector<std::unique_ptr<Seat>> seats_;
};

}  // namespace pocketray
