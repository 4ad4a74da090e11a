// SPDX-License-Identifier: MIT
#include "python/core/watch.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <list>
#include <thread>

namespace batten::python {

// The threads that nobody waits for any more.
class Workers {
 public:
  static Workers& All() {
    static auto* const all = new Workers;  // lives as long as they may
    return *all;
  }

  void Keep(std::thread thread, std::shared_ptr<Watch> watch) {
    const std::lock_guard lock(mutex_);
    Sweep();
    left_.emplace_back(std::move(thread), std::move(watch));
  }

  void Join() {
    const std::lock_guard lock(mutex_);
    for (auto& [thread, watch] : left_) thread.join();
    left_.clear();
  }

 private:
  void Sweep() {
    left_.remove_if([](auto& one) {
      const std::lock_guard lock(one.second->mutex_);
      if (!one.second->done_) return false;
      one.first.detach();  // it is about to return
      return true;
    });
  }

  std::mutex mutex_;
  std::list<std::pair<std::thread, std::shared_ptr<Watch>>> left_;
};

namespace {

// How often the waiting thread looks at signals and progress: below what a person notices.
constexpr std::chrono::milliseconds kLook{20};

}  // namespace

bool Watch::Go(const char* stage, double fraction) {
  if (stop_) return false;
  const std::lock_guard lock(mutex_);
  if (stage_ != stage) stage_ = stage;
  fraction_ = std::max(fraction_, fraction);
  news_ = true;
  return true;
}

Progress Watch::WholeFitProgress() {
  static constexpr const char* kNames[] = {
      "prepare", "order", "parameterize", "solve", "refine", "optimize", "measure"};
  return WholeFit([this](const FitProgress& at) {
    return Go(kNames[static_cast<int>(at.stage)], at.fraction);
  });
}

void Watch::KeepError(py::error_already_set&& error) {
  const std::lock_guard lock(mutex_);
  if (!raised_) raised_ = std::make_unique<py::error_already_set>(std::move(error));
  stop_ = true;
}

void Await(const std::shared_ptr<Watch>& watch,
           std::function<void()> work,
           const py::object& progress) {
  std::thread thread([watch, work = std::move(work)]() mutable {
    std::exception_ptr error;
    try {
      work();
    } catch (...) {
      error = std::current_exception();
    }
    work = nullptr;
    const std::lock_guard lock(watch->mutex_);
    watch->error_ = error;
    watch->done_ = true;
    watch->ended_.notify_all();
  });
  const auto leave = [&] {
    watch->stop_ = true;
    Workers::All().Keep(std::move(thread), watch);
  };
  const auto tell = [&](const std::string& stage, double fraction) {
    try {
      const py::object answer = progress(stage, fraction);
      if (answer.is(py::bool_(false))) watch->stop_ = true;
    } catch (...) {
      leave();
      throw;
    }
  };
  if (!progress.is_none()) tell("prepare", 0);
  bool done = false;
  while (!done) {
    bool news = false;
    std::string stage;
    double fraction = 0;
    {
      const py::gil_scoped_release released;
      std::unique_lock lock(watch->mutex_);
      done = watch->ended_.wait_for(lock, kLook, [&] { return watch->done_; });
      news = std::exchange(watch->news_, false);
      stage = watch->stage_;
      fraction = watch->fraction_;
    }
    if (PyErr_CheckSignals() != 0) {
      leave();
      throw py::error_already_set();
    }
    if (news && !done && !progress.is_none()) tell(stage, fraction);
  }
  {
    const py::gil_scoped_release released;
    thread.join();
  }
  if (watch->raised_) throw py::error_already_set(std::move(*watch->raised_));
  if (watch->error_) std::rethrow_exception(watch->error_);
  if (!progress.is_none()) {
    const py::object answer = progress(watch->stage_, 1.0);
  }
}

void AwaitAll() {
  PyOS_setsig(SIGINT, SIG_DFL);  // whoever can't wait ends the process
  const py::gil_scoped_release released;
  Workers::All().Join();
}

}  // namespace batten::python
