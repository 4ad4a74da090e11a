// SPDX-License-Identifier: MIT
// The one pool of threads that long work is given.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace batten {

// A fixed set of threads, made once and passed down. Work is cut into blocks whose bounds depend on
// the arguments only, never on timing, so that results kept per block are reproducible.
class ThreadPool {
 public:
  // `threads` ≤ 0 means all cores. One thread runs everything on the caller.
  explicit ThreadPool(int threads = 1);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;

  // Calls body(begin, end) for consecutive blocks of at most `block` indices that cover [0, count).
  // Returns when all are done; the first exception thrown by a block is thrown again here. While
  // the pool is at work, as for a call from inside a body, the caller does all blocks by itself.
  void For(std::ptrdiff_t count,
           std::ptrdiff_t block,
           const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace batten
