// SPDX-License-Identifier: MIT
#include "io/base/base64.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace batten::internal {
namespace {

constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

// Bytes of 32-bit words in little-endian order, encoded block by block.
class WordText {
 public:
  explicit WordText(std::string& text) : text_(text) { bytes_.reserve(kBlock); }
  ~WordText() { AppendBase64(text_, bytes_); }
  WordText(const WordText&) = delete;
  WordText& operator=(const WordText&) = delete;

  void Add(std::uint32_t word) {
    if constexpr (std::endian::native == std::endian::big) {
      word = word << 24 | (word << 8 & 0xff0000u) | (word >> 8 & 0xff00u) | word >> 24;
    }
    char bytes[sizeof word];
    std::memcpy(bytes, &word, sizeof word);
    bytes_.append(bytes, sizeof word);
    if (bytes_.size() < kBlock) return;
    AppendBase64(text_, bytes_);
    bytes_.clear();
  }

 private:
  static constexpr std::size_t kBlock = 12288;  // a multiple of 3, so that blocks need no padding
  std::string& text_;
  std::string bytes_;
};

}  // namespace

void AppendBase64(std::string& text, std::string_view bytes) {
  std::size_t k = 0;
  for (; k + 3 <= bytes.size(); k += 3) {
    const std::uint32_t three = std::uint32_t(static_cast<unsigned char>(bytes[k])) << 16 |
                                std::uint32_t(static_cast<unsigned char>(bytes[k + 1])) << 8 |
                                static_cast<unsigned char>(bytes[k + 2]);
    const char four[] = {kDigits[three >> 18],
                         kDigits[three >> 12 & 63],
                         kDigits[three >> 6 & 63],
                         kDigits[three & 63]};
    text.append(four, sizeof four);
  }
  const std::size_t rest = bytes.size() - k;
  if (rest == 0) return;
  std::uint32_t three = std::uint32_t(static_cast<unsigned char>(bytes[k])) << 16;
  if (rest == 2) three |= std::uint32_t(static_cast<unsigned char>(bytes[k + 1])) << 8;
  const char four[] = {kDigits[three >> 18],
                       kDigits[three >> 12 & 63],
                       rest == 2 ? kDigits[three >> 6 & 63] : '=',
                       '='};
  text.append(four, sizeof four);
}

void AppendFloats(std::string& json, const Eigen::Ref<const Eigen::MatrixXd>& numbers) {
  json += "{\"f32\":\"";
  {
    constexpr double kLargest = std::numeric_limits<float>::max();
    WordText words(json);
    for (const auto column : numbers.colwise()) {
      for (const double number : column) {
        const double held = std::isnan(number) ? number : std::clamp(number, -kLargest, kLargest);
        words.Add(std::bit_cast<std::uint32_t>(static_cast<float>(held)));
      }
    }
  }
  json += "\"}";
}

void AppendIndices(std::string& json, const Eigen::Ref<const Eigen::MatrixXi>& numbers) {
  json += "{\"u32\":\"";
  {
    WordText words(json);
    for (const auto column : numbers.colwise()) {
      for (const int number : column) words.Add(static_cast<std::uint32_t>(number));
    }
  }
  json += "\"}";
}

void AppendFlags(std::string& json, const Eigen::Array<bool, Eigen::Dynamic, 1>& flags) {
  std::string bytes;
  bytes.reserve(static_cast<std::size_t>(flags.size()));
  for (const bool flag : flags) bytes.push_back(flag ? '\1' : '\0');
  json += "{\"u8\":\"";
  AppendBase64(json, bytes);
  json += "\"}";
}

}  // namespace batten::internal
