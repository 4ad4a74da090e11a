// SPDX-License-Identifier: MIT
#include "batten/geometry/thread_pool.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace batten {

namespace {
constexpr int kMostThreads = 1024;  // the system's limit ends the process
}  // namespace

struct ThreadPool::State {
  std::mutex mutex;
  std::condition_variable wake, done;
  std::vector<std::thread> workers;
  const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>* body = nullptr;
  std::ptrdiff_t count = 0, block = 1, next = 0;
  int busy = 0;
  std::exception_ptr error;
  bool stop = false;

  // Takes blocks until none is left. Called with the lock held, returns with it held.
  void Drain(std::unique_lock<std::mutex>& lock) {
    ++busy;
    while (body != nullptr && next < count) {
      const std::ptrdiff_t begin = next, end = std::min(count, next + block);
      next = end;
      const auto* work = body;
      lock.unlock();
      std::exception_ptr thrown;
      try {
        (*work)(begin, end);
      } catch (const std::exception&) {
        thrown = std::current_exception();
      }
      lock.lock();
      if (thrown) {
        if (!error) error = thrown;
        next = count;
      }
    }
    if (--busy == 0) done.notify_all();
  }
};

ThreadPool::ThreadPool(int threads) : state_(std::make_unique<State>()) {
  if (threads <= 0) threads = std::max(1u, std::thread::hardware_concurrency());
  threads = std::min(threads, kMostThreads);
  for (int i = 1; i < threads; ++i) {
    state_->workers.emplace_back([state = state_.get()] {
      std::unique_lock lock(state->mutex);
      while (!state->stop) {
        state->Drain(lock);
        state->wake.wait(lock, [&] { return state->stop || state->next < state->count; });
      }
    });
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stop = true;
  }
  state_->wake.notify_all();
  for (std::thread& worker : state_->workers) worker.join();
}

int ThreadPool::threads() const { return static_cast<int>(state_->workers.size()) + 1; }

void ThreadPool::For(std::ptrdiff_t count,
                     std::ptrdiff_t block,
                     const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body) {
  block = std::max<std::ptrdiff_t>(1, block);
  const auto alone = [&] {
    for (std::ptrdiff_t i = 0; i < count; i += block) body(i, std::min(count, i + block));
  };
  if (state_->workers.empty() || count <= block) return alone();
  std::unique_lock lock(state_->mutex);
  if (state_->body != nullptr) {
    lock.unlock();
    return alone();
  }
  state_->body = &body;
  state_->count = count;
  state_->block = block;
  state_->next = 0;
  state_->wake.notify_all();
  state_->Drain(lock);
  state_->done.wait(lock, [&] { return state_->busy == 0; });
  state_->body = nullptr;
  state_->count = state_->next = 0;
  if (state_->error) std::rethrow_exception(std::exchange(state_->error, nullptr));
}

}  // namespace batten
