// SPDX-License-Identifier: MIT
#include "io/exchange/step_schema.h"

#include "batten/io/read_error.h"

namespace batten::internal {

const char* OcctSchema(const std::string& schema) {
  if (schema == "ap214") return "AP214IS";
  if (schema == "ap242") return "AP242DIS";
  throw UsageError("STEP schema \"" + schema + "\" is not one of ap214, ap242");
}

}  // namespace batten::internal
