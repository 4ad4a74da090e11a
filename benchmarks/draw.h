// SPDX-License-Identifier: MIT
// Random numbers of the clouds that nobody chose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

namespace batten::internal {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(0x9e3779b97f4a7c15u * (seed + 1)) {}
  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  int Whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  double Normal() { return std::normal_distribution<double>(0, 1)(engine_); }
  template <std::size_t N>
  double OneOf(const double (&values)[N]) {
    return values[std::uniform_int_distribution<std::size_t>(0, N - 1)(engine_)];
  }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace batten::internal
