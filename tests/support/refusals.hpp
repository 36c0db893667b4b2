// SPDX-License-Identifier: MIT
#pragma once
/// \file What every table of refusals must keep to.

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "host/report/refusal.hpp"

namespace biteline::test {

/// One row for each code from 0 to `last`, in order; names in snake_case and each only once; a next step.
template <class Code>
void check_refusal_table(Code last) {
  const auto table = refusal_table(last);
  LONGS_EQUAL(static_cast<int>(last) + 1, table.size());
  std::set<std::string_view> names;
  int index = 0;
  for (const report::RefusalRow<Code>& row : table) {
    LONGS_EQUAL(index++, static_cast<int>(row.code));
    const std::string_view name{row.name};
    CHECK_TEXT(std::ranges::all_of(name, [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; }),
               row.name);
    CHECK_TEXT(name.size() > 3, row.name);
    CHECK_TEXT(names.insert(name).second, row.name);
    CHECK_TEXT(std::string_view{row.next_step}.size() > 8, row.name);
  }
}

}  // namespace biteline::test
