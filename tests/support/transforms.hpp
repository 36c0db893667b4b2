// SPDX-License-Identifier: MIT
#pragma once
/// \file Asserts on rigid motions that report the two errors and not sixteen numbers.

#include <CppUTest/TestHarness.h>

#include "common/geometry/se3.hpp"

#define TRANSFORMS_EQUAL(expected, actual, tol_mm, tol_rad)                                            \
  do {                                                                                                 \
    const ::biteline::SE3 difference_ = ::biteline::SE3(expected).inverse() * ::biteline::SE3(actual); \
    DOUBLES_EQUAL(0.0, difference_.translation().norm(), tol_mm);                                      \
    DOUBLES_EQUAL(0.0, ::biteline::geometry::log_so3(difference_.linear()).norm(), tol_rad);           \
  } while (false)
