// SPDX-License-Identifier: MIT
// Included by a table program: the rules that BATTEN_WITHOUT names, with commas between, are
// switched off before main.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "fitting/core/rules.h"

namespace batten::internal {

inline const bool kRulesAreSwitchedOff = [] {
  const char* const without = std::getenv("BATTEN_WITHOUT");
  std::istringstream names(without == nullptr ? "" : without);
  for (std::string name; std::getline(names, name, ',');) {
    bool known = false;
    for (const NamedRule& rule : AllRules()) {
      if (rule.name != name) continue;
      SwitchOff(rule.rule);
      known = true;
    }
    if (!known) {
      std::fprintf(stderr, "BATTEN_WITHOUT: no rule is named %s\n", name.c_str());
      std::exit(2);
    }
  }
  return true;
}();

}  // namespace batten::internal
