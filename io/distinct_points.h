// SPDX-License-Identifier: MIT
// Points without their exact repetitions. Not installed.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace batten {

// The distinct ones of the points added, in the order in which they first appear. T is float or
// double; the two zeros are equal, and so are NaNs of the same bits. Takes 12 or 24 bytes a
// distinct point and about 8 more while it grows.
template <class T>
class DistinctPoints {
 public:
  using Point = std::array<T, 3>;

  // `expected`: how many distinct points are likely.
  explicit DistinctPoints(std::int64_t expected = 0)
      : slots_(std::bit_ceil(static_cast<std::size_t>(kSparse * expected) + kLeast)),
        recent_(kRecent, Point{std::numeric_limits<T>::signaling_NaN(), 0, 0}) {}

  std::int64_t size() const { return size_; }
  const Point& operator[](std::int64_t k) const {
    const auto at = static_cast<std::size_t>(k);
    return pieces_[at / kPiecePoints][at % kPiecePoints];
  }

  // How many points there can be; what comes beyond is not distinguished.
  static constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;

  void Add(Point point) {
    for (T& x : point) x += T{0};  // one of the two zeros; no NaN stays a signalling one
    const std::uint64_t hash = Hash(point);
    // Facets near each other share corners: most repetitions are recent, and stay in the cache.
    Point& recent = recent_[hash >> (64 - kRecentBits)];
    if (Same(recent, point)) return;
    recent = point;
    std::size_t slot = hash & (slots_.size() - 1);
    for (; slots_[slot] != 0; slot = (slot + 1) & (slots_.size() - 1)) {
      if (Same((*this)[slots_[slot] - 1], point)) return;
    }
    Append(point);
    slots_[slot] = static_cast<std::uint32_t>(size_);
    if (kSparse * static_cast<double>(size_) > static_cast<double>(slots_.size())) Grow();
  }

  // Forgets what tells repetitions; only reading is left.
  void Close() {
    slots_ = {};
    recent_ = {};
  }

  // Frees the piece of points 0 … k − 1 that ends at k, if one does.
  void FreeBefore(std::int64_t k) {
    const auto at = static_cast<std::size_t>(k);
    if (at > 0 && at % kPiecePoints == 0) pieces_[at / kPiecePoints - 1].reset();
  }

 private:
  static constexpr std::size_t kPiecePoints = std::size_t{1} << 15;
  static constexpr std::size_t kLeast = 1024;
  static constexpr int kRecentBits = 12;
  static constexpr std::size_t kRecent = std::size_t{1} << kRecentBits;
  static constexpr double kSparse = 1.5;  // slots a point, at least

  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

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

  void Append(const Point& point) {
    const auto at = static_cast<std::size_t>(size_) % kPiecePoints;
    if (at == 0) pieces_.push_back(std::make_unique_for_overwrite<Point[]>(kPiecePoints));
    pieces_.back()[at] = point;
    ++size_;
  }

  void Grow() {
    std::vector<std::uint32_t> larger(2 * slots_.size());
    slots_.swap(larger);
    larger = {};
    for (std::int64_t k = 0; k < size_; ++k) {
      std::size_t slot = Hash((*this)[k]) & (slots_.size() - 1);
      while (slots_[slot] != 0) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<std::uint32_t>(k + 1);
    }
  }

  std::int64_t size_ = 0;
  std::vector<std::unique_ptr<Point[]>> pieces_;
  std::vector<std::uint32_t> slots_;  // 1 + the index of a point; 0: free. A power of two
  std::vector<Point> recent_;
};

}  // namespace batten
