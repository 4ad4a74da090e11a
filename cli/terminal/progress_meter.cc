// SPDX-License-Identifier: MIT
#include "cli/terminal/progress_meter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace batten::internal {
namespace {

// Stages that go on until nothing improves. Every note is a round; where the number of rounds is
// limited the fraction is that of the limit.
struct OpenStage {
  std::string_view name;
  bool rounds;   // notes are rounds
  bool limited;  // the fraction says how many may follow at most
};
constexpr std::array kOpenStages{OpenStage{"optimize", true, true},
                                 OpenStage{"correct", true, true},
                                 OpenStage{"refine", true, false},
                                 OpenStage{"knots", false, false},
                                 OpenStage{"solve", false, false}};

const OpenStage* Open(const std::string& stage) {
  const auto* const found = std::find_if(
      kOpenStages.begin(), kOpenStages.end(), [&](const OpenStage& o) { return o.name == stage; });
  return found == kOpenStages.end() ? nullptr : found;
}

// A pace is told once so much of a stage has gone by.
constexpr double kLeastSeconds = 0.5, kLeastShare = 0.02;

// Three digits at most: 8.5, 12, 830 k, 1.2 M.
std::string Short(double number) {
  const char* suffix = "";
  for (const char* const next : {" k", " M", " G"}) {
    if (number < 1000) break;
    number /= 1000;
    suffix = next;
  }
  return fmt::format("{:.{}f}{}", number, number < 9.95 ? 1 : 0, suffix);
}

std::string Rate(double per_second, const std::string& unit) {
  if (unit == "B")
    return fmt::format("{:.{}f} MB/s", per_second / 1e6, per_second < 9.95e6 ? 1 : 0);
  return Short(per_second) + ' ' + unit + "/s";
}

// 0:07, 12:34, 3:00:00
std::string ClockTime(double seconds) {
  constexpr double kMost = 359999;  // 99:59:59
  const auto whole = static_cast<int>(std::min(std::ceil(seconds), kMost));
  const int hours = whole / 3600, minutes = whole / 60 % 60;
  return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60)
                   : fmt::format("{}:{:02}", minutes, whole % 60);
}

std::string Time(const ProgressFigures& figures) {
  if (!figures.left) return ClockTime(std::floor(figures.seconds));
  return (figures.at_most ? "at most " : "") + ClockTime(*figures.left) + " left";
}

}  // namespace

void ProgressMeter::SetAmount(const std::string& stage, double total, const std::string& unit) {
  if (stage == stage_) stage_.clear();
  if (total > 0) {
    amounts_[stage] = {total, unit};
  } else {
    amounts_.erase(stage);
  }
}

void ProgressMeter::Note(const std::string& stage, double fraction, double now) {
  fraction = std::clamp(fraction, 0.0, 1.0);
  if (stage != stage_) {
    stage_ = stage;
    begin_ = now;
    first_ = fraction_ = fraction;
    rounds_ = 0;
  } else {
    ++rounds_;
  }
  noted_ = now;
  fraction_ = std::max(fraction_, fraction);
}

ProgressFigures ProgressMeter::At(double now) const {
  ProgressFigures figures{stage_, fraction_, now - begin_, "", std::nullopt, false};
  const double heard = noted_ - begin_, gone = fraction_ - first_;
  if (heard < kLeastSeconds) return figures;
  const OpenStage* const open = Open(stage_);
  const auto amount = amounts_.find(stage_);
  if (amount != amounts_.end() && gone > 0) {
    figures.rate = Rate(gone * amount->second.total / heard, amount->second.unit);
  } else if (open && open->rounds && rounds_ > 0) {
    figures.rate = Rate(rounds_ / heard, "rounds");
  }
  if (gone >= kLeastShare && (!open || open->limited)) {
    // The time since it was heard of counts down; when it is up the pace was another.
    const double left = (1 - fraction_) * heard / gone - (now - noted_);
    if (left > 0) figures.left = left;
    figures.at_most = open != nullptr;
  }
  return figures;
}

std::string ProgressLine(const ProgressFigures& figures, int columns) {
  const auto room = static_cast<size_t>(std::max(columns - 1, 0));
  const std::string time = Time(figures);
  // Of a stage that says nothing of its extent there is only the time.
  if (!(figures.fraction > 0)) return (figures.stage + "  " + time).substr(0, room);
  constexpr size_t kStage = 12, kLeastBar = 8, kMostBar = 30, kFrame = 5;
  const std::string share = fmt::format("{:3.0f} %", std::floor(100 * figures.fraction));
  const std::string rate = figures.rate.empty() ? "" : "  " + figures.rate;
  const std::string tail = share + rate + "  " + time;
  const std::string stage = fmt::format("{:<{}}", figures.stage, kStage);
  if (stage.size() + kFrame + kLeastBar + tail.size() <= room) {
    const size_t width = std::min(kMostBar, room - stage.size() - kFrame - tail.size());
    const auto filled = static_cast<size_t>(figures.fraction * static_cast<double>(width));
    return stage + " [" + std::string(filled, '#') + std::string(width - filled, '.') + "] " + tail;
  }
  for (const std::string& rest : {tail, share + "  " + time, share}) {
    const std::string line = figures.stage + ' ' + rest;
    if (line.size() <= room) return line;
  }
  return share.substr(0, room);
}

}  // namespace batten::internal
