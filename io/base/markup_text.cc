// SPDX-License-Identifier: MIT
#include "io/base/markup_text.h"

#include <fmt/format.h>

namespace batten::internal {

std::string InMarkup(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string AsReference(std::string_view path) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  std::string reference;
  for (const char c : path) {
    if (kPlain.find(c) != std::string_view::npos) {
      reference += c;
    } else {
      reference += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return reference;
}

}  // namespace batten::internal
