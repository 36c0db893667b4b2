// SPDX-License-Identifier: MIT
#pragma once
/// \file Tests that take too long for every run: ./run test --all alone has them.
#include <CppUTest/TestHarness.h>

/// After TEST_GROUP(group): what stands in TEST(<group>Long, ...) has its setup and helpers, and is run apart
/// (biteline_add_test ... LONG).
#define LONG_GROUP(group) TEST_GROUP_BASE(group##Long, TEST_GROUP_CppUTestGroup##group)
