// SPDX-License-Identifier: MIT
#include "python/core/errors.h"

#include <algorithm>
#include <cctype>

#include "batten/fitting/progress.h"
#include "batten/io/read_error.h"

namespace batten::python {
namespace {

namespace py = pybind11;

// Raises the exception of that name in batten._errors.
template <typename... Arguments>
void Raise(const char* name, const Arguments&... arguments) {
  const py::object type = py::module_::import("batten._errors").attr(name);
  PyErr_SetObject(type.ptr(), type(arguments...).ptr());
}

void Translate(std::exception_ptr error) {
  try {
    std::rethrow_exception(error);
  } catch (const Refused& refusal) {
    Raise("FitRefused", refusal.what(), refusal.remedy());
  } catch (const ReadError& reading) {
    Raise("ReadError", reading.what());
  } catch (const WriteError& writing) {
    Raise("WriteError", writing.what());
  } catch (const Cancelled&) {
    Raise("Cancelled", "progress asked to stop before there was any result");
  } catch (const UsageError& usage) {
    PyErr_SetString(PyExc_ValueError, usage.what());
  } catch (const std::invalid_argument& argument) {
    PyErr_SetString(PyExc_ValueError, Reason(argument.what()).c_str());
  }
}

}  // namespace

std::string Reason(const std::string& message) {
  const size_t colon = message.find(": ");
  if (colon == std::string::npos || colon == 0 || !std::isupper(message[0])) return message;
  const bool named = std::all_of(message.begin(),
                                 message.begin() + static_cast<std::ptrdiff_t>(colon),
                                 [](unsigned char c) { return std::isalnum(c) || c == ':'; });
  return named ? message.substr(colon + 2) : message;
}

void BindErrors() { py::register_exception_translator(Translate); }

}  // namespace batten::python
