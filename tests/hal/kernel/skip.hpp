// SPDX-License-Identifier: MIT
#pragma once
/// \file A test that needs a device of the kernel's.

#include <filesystem>

#include "tests/support/shared_data.hpp"

/// Leaves the test as skipped when `path` is not there.  Where tests/vm made the devices
/// ($BITELINE_DEVICES=all), a missing one is a failure and not a skip.
#define BITELINE_DEVICE_OR_SKIP(path)                                                        \
  do {                                                                                       \
    if (!std::filesystem::exists(path)) {                                                    \
      const char* const devices_ = std::getenv("BITELINE_DEVICES");                          \
      if (devices_ != nullptr) FAIL((std::string{"missing: "} + std::string{path}).c_str()); \
      ::biteline::test::note_skipped(std::string{"no "} + std::string{path});                \
      return;                                                                                \
    }                                                                                        \
    ::biteline::test::note_ran();                                                            \
  } while (false)
