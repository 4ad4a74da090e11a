// SPDX-License-Identifier: MIT
// What a progress bar tells: how far a stage is, how fast it goes, how long it takes from here.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace batten::internal {

// A stage at one moment.
struct ProgressFigures {
  std::string stage;
  double fraction = 0;         // 0 … 1; never less than before within a stage
  double seconds = 0;          // in this stage
  std::string rate;            // "412 MB/s", "1.2 M points/s", "8.5 rounds/s"; empty where unknown
  std::optional<double> left;  // seconds, from the pace so far
  bool at_most = false;        // the stage may well end before its last round: `left` is a bound
};

// Follows stages through the fractions that work reports. The clock is the caller's: seconds that
// never fall.
class ProgressMeter {
 public:
  // That all of a stage is so much of something: rates are told in that unit, which is "B" for
  // bytes or a word such as "points". None is known where `total` is not positive. The next note of
  // the stage begins it anew.
  void SetAmount(const std::string& stage, double total, const std::string& unit);

  // The fraction of a stage is done. Another name than the last begins another stage.
  void Note(const std::string& stage, double fraction, double now);

  ProgressFigures At(double now) const;

 private:
  struct Amount {
    double total;
    std::string unit;
  };
  std::map<std::string, Amount> amounts_;
  std::string stage_;
  double begin_ = 0, first_ = 0;     // when the stage began, and at which fraction
  double noted_ = 0, fraction_ = 0;  // when it was last heard of
  int rounds_ = 0;                   // notes since
};

// The figures as one line of fewer than `columns` characters: with a bar where there is room; rate,
// time and at last letters are left out where there is not.
std::string ProgressLine(const ProgressFigures& figures, int columns);

}  // namespace batten::internal
