// SPDX-License-Identifier: MIT
#include "fitting/core/rules.h"

#include <gtest/gtest.h>

#include <set>

namespace batten::internal::rules_test {

TEST(RulesTest, AllActAndHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  std::set<Rule> rules;
  for (const NamedRule& one : AllRules()) {
    EXPECT_TRUE(Acts(one.rule)) << one.name;
    names.insert(one.name);
    rules.insert(one.rule);
  }
  EXPECT_EQ(names.size(), AllRules().size());
  EXPECT_EQ(rules.size(), AllRules().size());
}

}  // namespace batten::internal::rules_test
