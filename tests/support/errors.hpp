// SPDX-License-Identifier: MIT
#pragma once
/// \file Asserts on failures: the code, and that the one line names the place.

#include <CppUTest/TestHarness.h>

#include "common/core/result.hpp"

#define FAILS_NAMING(expected_code, expected_text, result)                                \
  do {                                                                                    \
    const auto& result_ = (result);                                                       \
    CHECK_TEXT(!result_.has_value(), "expected a failure");                               \
    STRCMP_CONTAINS(expected_text, ::biteline::to_line(result_.error()).c_str());         \
    LONGS_EQUAL(static_cast<int>(expected_code), static_cast<int>(result_.error().code)); \
  } while (false)

#define SUCCEEDS(result)                                                                          \
  do {                                                                                            \
    const auto& result_ = (result);                                                               \
    CHECK_TEXT(result_.has_value(), result_ ? "" : ::biteline::to_line(result_.error()).c_str()); \
  } while (false)
