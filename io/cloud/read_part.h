// SPDX-License-Identifier: MIT
// One of several files that are a cloud. Not installed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "batten/io/cloud_options.h"
#include "batten/io/file_format.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// The formats of files that are all files of points. Throws UsageError for the first that is not.
std::vector<FileFormat> CloudFormats(const std::vector<std::string>& paths,
                                     const CloudReadOptions& options);

// What one file holds; it may hold no usable point. Throws as ReadCloud does.
FileCloud ReadPart(const std::string& path,
                   FileFormat format,
                   const CloudReadOptions& options,
                   std::function<void(double)> progress);

}  // namespace batten::internal
