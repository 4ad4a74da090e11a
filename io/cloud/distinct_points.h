// SPDX-License-Identifier: MIT
// Points without their exact repetitions. Not installed.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

namespace batten::internal {

// The distinct ones of the points added, in the order in which they first appear. T is float or
// double; the two zeros are equal, and so are NaNs of the same bits. Takes 12 or 24 bytes a
// distinct point and up to 12 more until it is closed.
template <class T>
class DistinctPoints {
 public:
  using Point = std::array<T, 3>;

  // `expected`: how many distinct points are likely.
  explicit DistinctPoints(std::int64_t expected = 0)
      : slots_(SlotsFor(expected)),
        recent_(kRecent, Point{std::numeric_limits<T>::signaling_NaN(), 0, 0}) {}

  void Add(Point point) {
    for (T& x : point) x += T{0};  // one of the two zeros; no NaN stays a signalling one
    const std::uint64_t hash = Hash(point);
    // Facets near each other share corners: most repetitions are recent, and stay in the cache.
    Point& recent = recent_[hash >> (64 - kRecentBits)];
    if (Same(recent, point)) return;
    recent = point;
    waiting_[waiting_count_] = {point, hash};
    if (++waiting_count_ == kWaiting) TakeWaiting();
  }

  // Ends adding: takes what is waiting and frees what tells repetitions.
  void Close() {
    TakeWaiting();
    slots_ = {};
    recent_ = {};
  }

  // Of those taken; after Close() of all.
  std::int64_t size() const { return size_; }
  const Point& operator[](std::int64_t k) const {
    const auto at = static_cast<std::size_t>(k);
    return pieces_[at / kPiecePoints][at % kPiecePoints];
  }

  // How many points there can be at most.
  static constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max() - (1 << 20);

  // Frees the piece of points 0 … k − 1 that ends at k, if one does.
  void FreeBefore(std::int64_t k) {
    const auto at = static_cast<std::size_t>(k);
    if (at > 0 && at % kPiecePoints == 0) pieces_[at / kPiecePoints - 1].reset();
  }

 private:
  static constexpr std::size_t kPiecePoints = std::size_t{1} << 15;
  static constexpr int kRecentBits = 13;
  static constexpr std::size_t kRecent = std::size_t{1} << kRecentBits;
  static constexpr std::size_t kWaiting = 256;

  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

  struct Candidate {
    Point point;
    std::uint64_t hash;
  };

  // A power of two, at least 1.5 times the points.
  static std::size_t SlotsFor(std::int64_t points) {
    return std::bit_ceil(static_cast<std::size_t>(points + points / 2) + 4 * kWaiting);
  }

  static bool Same(const Point& a, const Point& b) {
    return std::bit_cast<std::array<Bits, 3>>(a) == std::bit_cast<std::array<Bits, 3>>(b);
  }

  static std::uint64_t Hash(const Point& point) {
    std::uint64_t hash = 0;
    for (const T x : point) {
      hash = (hash ^ std::bit_cast<Bits>(x)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    return hash;
  }

  // Slots and points are anywhere in memory: they are fetched for many candidates at once.
  void TakeWaiting() {
    if (SlotsFor(size_ + static_cast<std::int64_t>(kWaiting)) > slots_.size()) Grow();
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t k = 0; k < waiting_count_; ++k) {
      __builtin_prefetch(&slots_[waiting_[k].hash & mask]);
    }
    for (std::size_t k = 0; k < waiting_count_; ++k) {
      const std::uint32_t found = slots_[waiting_[k].hash & mask];
      if (found != 0) __builtin_prefetch(&(*this)[found - 1]);
    }
    for (std::size_t k = 0; k < waiting_count_; ++k) Take(waiting_[k]);
    waiting_count_ = 0;
  }

  void Take(const Candidate& candidate) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = candidate.hash & mask;
    for (; slots_[slot] != 0; slot = (slot + 1) & mask) {
      if (Same((*this)[slots_[slot] - 1], candidate.point)) return;
    }
    const auto at = static_cast<std::size_t>(size_) % kPiecePoints;
    if (at == 0) pieces_.push_back(std::make_unique_for_overwrite<Point[]>(kPiecePoints));
    pieces_.back()[at] = candidate.point;
    slots_[slot] = static_cast<std::uint32_t>(++size_);
  }

  void Grow() {
    const std::size_t count = 2 * slots_.size();
    slots_ = {};
    slots_.resize(count);
    for (std::int64_t k = 0; k < size_; ++k) {
      std::size_t slot = Hash((*this)[k]) & (count - 1);
      while (slots_[slot] != 0) slot = (slot + 1) & (count - 1);
      slots_[slot] = static_cast<std::uint32_t>(k + 1);
    }
  }

  std::int64_t size_ = 0;
  std::vector<std::unique_ptr<Point[]>> pieces_;
  std::vector<std::uint32_t> slots_;  // 1 + the index of a point; 0: free
  std::vector<Point> recent_;         // by hash, the last one added
  std::array<Candidate, kWaiting> waiting_;
  std::size_t waiting_count_ = 0;
};

}  // namespace batten::internal
