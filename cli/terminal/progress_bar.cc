// SPDX-License-Identifier: MIT
#include "cli/terminal/progress_bar.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>

#include "cli/terminal/interrupt.h"
#include "cli/terminal/progress_meter.h"
#include "cli/terminal/streams.h"

namespace batten::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kQuietTime = std::chrono::seconds(1);
constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr auto kTold = std::chrono::seconds(10);
constexpr int kNoRoomForABar = 36;  // columns
constexpr auto kPatience = std::chrono::milliseconds(100);

int Columns() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* const said = std::getenv("COLUMNS");
  const int columns = said != nullptr ? std::atoi(said) : 0;
  constexpr int kUsual = 80;
  return columns > 0 ? columns : kUsual;
}

bool InForeground() {
  const pid_t front = ::tcgetpgrp(STDERR_FILENO);
  return front < 0 || front == ::getpgrp();
}

class Bar {
 public:
  // Lives until the process ends: its thread does too.
  static Bar& The() {
    static Bar& bar = *new Bar;
    return bar;
  }

  void Note(const char* stage, double fraction) {
    {
      const std::lock_guard lock(mutex_);
      if (!started_) std::thread([this] { BarPossible() ? Draw() : Tell(); }).detach();
      started_ = true;
      meter_.Note(stage, fraction, Now());
      if (shown_) return;
      shown_ = true;
    }
    changed_.notify_one();
  }

  void SetAmount(const std::string& stage, double total, const std::string& unit) {
    const std::lock_guard lock(mutex_);
    meter_.SetAmount(stage, total, unit);
  }

  void Hide() {
    std::unique_lock lock(mutex_, kPatience);
    if (!lock.owns_lock()) return;
    shown_ = false;
    Wipe();
  }

 private:
  double Now() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  void Draw() {
    std::this_thread::sleep_for(kQuietTime);
    for (;; std::this_thread::sleep_for(kRedraw)) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return shown_; });
      if (Interrupted() || !InForeground()) continue;
      const std::string line = ProgressLine(meter_.At(Now()), Columns());
      // What is longer of the line before is overwritten.
      std::string text = '\r' + line;
      if (drawn_ > line.size()) text += std::string(drawn_ - line.size(), ' ') + '\r' + line;
      WriteToErrors(text);
      drawn_ = line.size();
    }
  }

  // A line now and then, where none can be taken back.
  void Tell() {
    for (;;) {
      std::this_thread::sleep_for(kTold);
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return shown_; });
      if (Interrupted()) continue;
      WriteToErrors("batten: " + ProgressLine(meter_.At(Now()), kNoRoomForABar) + ", " +
                    std::to_string(static_cast<int>(Now())) + " s so far\n");
    }
  }

  void Wipe() {
    if (drawn_ == 0) return;
    const auto room = static_cast<size_t>(Columns() - 1);  // it may be narrower by now
    WriteToErrors('\r' + std::string(std::min(drawn_, room), ' ') + '\r');
    drawn_ = 0;
  }

  std::timed_mutex mutex_;
  std::condition_variable_any changed_;
  const Clock::time_point begin_ = Clock::now();
  ProgressMeter meter_;
  bool started_ = false, shown_ = false;
  size_t drawn_ = 0;  // characters of the line that stands there
};

}  // namespace

bool BarPossible() {
  const char* const terminal = std::getenv("TERM");
  const bool dumb = terminal != nullptr && std::strcmp(terminal, "dumb") == 0;
  return !dumb && ::isatty(STDERR_FILENO) != 0;
}

void NoteProgress(const char* stage, double fraction) { Bar::The().Note(stage, fraction); }

void SetProgressAmount(const std::string& stage, double total, const std::string& unit) {
  Bar::The().SetAmount(stage, total, unit);
}

void HideBar() { Bar::The().Hide(); }

}  // namespace batten::internal
