// SPDX-License-Identifier: MIT
// Long work from Python: without the interpreter's lock, with progress, and ended by Ctrl-C.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "batten/fitting/fit_progress.h"

namespace batten::python {

namespace py = pybind11;

// What a thread that works and the one that waits for it share.
class Watch {
 public:
  // For the worker: notes where the work is; whether to go on.
  bool Go(const char* stage, double fraction);

  // Progress for options of a fit.
  Progress WholeFitProgress();

  // For the worker: keeps an exception of Python's that its code raised, and asks to stop. Needs
  // the interpreter's lock.
  void KeepError(py::error_already_set&& error);

  bool stopped() const { return stop_.load(); }

 private:
  friend void Await(const std::shared_ptr<Watch>& watch,
                    std::function<void()> work,
                    const py::object& progress);
  friend class Workers;

  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false, news_ = false;
  std::string stage_ = "prepare";
  double fraction_ = 0;
  std::exception_ptr error_;
  std::unique_ptr<py::error_already_set> raised_;
  std::atomic<bool> stop_{false};
};

// Runs `work` on a thread of its own while the calling one, which must hold the interpreter's lock
// and gives it up, waits for signals and calls progress(stage, fraction) up to fifty times a
// second, a last time with 1. A signal handler or a callback that raises leaves at once: the work
// is asked to stop and is left to itself, so all that `work` touches must be its own. A callback
// that returns False asks to stop and waits for what there is. Throws what the work throws.
void Await(const std::shared_ptr<Watch>& watch,
           std::function<void()> work,
           const py::object& progress);

// Waits for work that was left to itself: before the interpreter ends.
void AwaitAll();

// f(watch) so run; what it returns, which must be no Python object.
template <typename Function>
auto Watched(Function f, const py::object& progress = py::none()) {
  using Result = std::invoke_result_t<Function, Watch&>;
  const auto watch = std::make_shared<Watch>();
  const auto result = std::make_shared<std::optional<Result>>();
  Await(
      watch, [watch, result, f = std::move(f)]() mutable { *result = f(*watch); }, progress);
  return std::move(**result);
}

}  // namespace batten::python
