// SPDX-License-Identifier: MIT
// A file's bytes at once. Not installed.
#pragma once

#include <string>

namespace batten::internal {

// The bytes of a file, or of standard input when the path is "-". Throws ReadError when it does not
// exist, is a directory, can't be read, is empty, or is larger than 4 GiB.
std::string ReadWholeFile(const std::string& path);

}  // namespace batten::internal
