// SPDX-License-Identifier: MIT
// Numbers as text that JSON can carry. Not installed.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

namespace batten::internal {

// [RFC 4648, §4], padded.
void AppendBase64(std::string& text, std::string_view bytes);

// {"f32": "…"}, {"u32": "…"} and {"u8": "…"}: base64 of little-endian numbers, column by column.
// What lies beyond the largest float becomes that; NaN stays.
void AppendFloats(std::string& json, const Eigen::Ref<const Eigen::MatrixXd>& numbers);
void AppendIndices(std::string& json, const Eigen::Ref<const Eigen::MatrixXi>& numbers);
void AppendFlags(std::string& json, const Eigen::Array<bool, Eigen::Dynamic, 1>& flags);

}  // namespace batten::internal
