#include "engine/workers.h"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>

#include "base/check.h"
#include "base/limits.h"

namespace pocketray {

// POSIX threads: std::thread throws when the system has none left, and the library has no exceptions.
struct Worker {
  pthread_t thread;
  Workers* workers;
  std::uint32_t index;
};

struct Workers {
  Worker threads[kThreadCountMax];
  std::uint32_t count = 0;  // in addition to the caller's
  std::mutex mutex;
  std::condition_variable begin, end;
  void (*work)(void* context, std::uint32_t thread) = nullptr;
  void* context = nullptr;
  std::uint64_t generation = 0;
  std::uint32_t busy = 0;
  bool quit = false;
};

std::uint64_t clock_ns() {
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
}

namespace {

struct ItemQueue {
  std::uint32_t end;
  bool (*take)(void* context, std::uint32_t thread, std::uint32_t item);
  void* context;
  std::atomic<std::uint32_t> next;
};

void take_items(void* context, std::uint32_t thread) {
  ItemQueue* queue = static_cast<ItemQueue*>(context);
  for (std::uint32_t item; (item = queue->next++) < queue->end;)
    if (!queue->take(queue->context, thread, item)) return;
}

void run_worker(Workers* w, std::uint32_t thread) {
  std::uint64_t seen = 0;
  for (;;) {
    std::unique_lock<std::mutex> lock(w->mutex);
    w->begin.wait(lock, [&] { return w->quit || w->generation != seen; });
    if (w->quit) return;
    seen = w->generation;
    auto* work = w->work;
    void* context = w->context;
    lock.unlock();
    work(context, thread);
    lock.lock();
    CHECK_GT(w->busy, 0u);
    if (--w->busy == 0) w->end.notify_one();
  }
}

void* run_thread(void* context) {
  const Worker* worker = static_cast<Worker*>(context);
  run_worker(worker->workers, worker->index);
  return nullptr;
}

}  // namespace

Workers* start_workers(std::uint32_t thread_count) {
  CHECK_LE(thread_count, kThreadCountMax);
  if (thread_count <= 1) return nullptr;
  Workers* w = new (std::nothrow) Workers;
  if (!w) return nullptr;
  while (w->count + 1 < thread_count) {
    Worker* worker = &w->threads[w->count];
    worker->workers = w;
    worker->index = w->count + 1;
    if (pthread_create(&worker->thread, nullptr, run_thread, worker) != 0) break;
    ++w->count;
  }
  if (w->count > 0) return w;
  delete w;
  return nullptr;
}

void stop_workers(Workers* workers) {
  if (!workers) return;
  {
    std::lock_guard<std::mutex> lock(workers->mutex);
    workers->quit = true;
  }
  workers->begin.notify_all();
  for (std::uint32_t i = 0; i < workers->count; ++i) pthread_join(workers->threads[i].thread, nullptr);
  delete workers;
}

std::uint32_t worker_thread_count(const Workers* workers) { return workers ? workers->count + 1 : 1; }

void run_with(Workers* w, void (*work)(void* context, std::uint32_t thread), void* context) {
  CHECK(work != nullptr);
  if (!w) return work(context, 0);
  {
    std::lock_guard<std::mutex> lock(w->mutex);
    CHECK_EQ(w->busy, 0u);  // one job at a time
    w->work = work;
    w->context = context;
    w->busy = w->count;
    ++w->generation;
  }
  w->begin.notify_all();
  work(context, 0);
  std::unique_lock<std::mutex> lock(w->mutex);
  w->end.wait(lock, [&] { return w->busy == 0; });
}

std::uint32_t share_items(Workers* workers, std::uint32_t begin, std::uint32_t end,
                          bool (*take)(void* context, std::uint32_t thread, std::uint32_t item), void* context) {
  CHECK_LE(begin, end);
  CHECK_LE(end, ~0u - kThreadCountMax);
  ItemQueue queue{end, take, context, {begin}};
  run_with(workers, take_items, &queue);
  std::uint32_t next = queue.next;
  return next < end ? next : end;
}

ParallelLoop loop_over(Workers* workers) {
  if (!workers) return {};
  struct Loop {
    void (*take)(void* context, std::uint32_t item);
    void* context;
  };
  auto run = [](void* threads, std::uint32_t item_count, void (*take)(void* context, std::uint32_t item),
                void* context) {
    CHECK(take != nullptr);
    Loop loop = {take, context};
    auto take_item = [](void* of, std::uint32_t, std::uint32_t item) {
      const Loop* l = static_cast<Loop*>(of);
      l->take(l->context, item);
      return true;
    };
    share_items(static_cast<Workers*>(threads), 0, item_count, take_item, &loop);
  };
  return {run, workers};
}

}  // namespace pocketray
