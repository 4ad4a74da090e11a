// SPDX-License-Identifier: MIT
// The library's exceptions as those of the package.
#pragma once

#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace batten::python {

// Why points can't be fitted: becomes batten.FitRefused.
class Refused : public std::runtime_error {
 public:
  Refused(const std::string& reason, std::string remedy)
      : std::runtime_error(reason), remedy_(std::move(remedy)) {}

  const std::string& remedy() const { return remedy_; }  // a keyword and its value, or empty

 private:
  std::string remedy_;
};

void BindErrors();

// A message of the library without the name of the function or struct in front.
std::string Reason(const std::string& message);

}  // namespace batten::python
