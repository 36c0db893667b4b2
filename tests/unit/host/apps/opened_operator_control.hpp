// SPDX-License-Identifier: MIT
#pragma once
/// \file The service's answers to a page, over a folder of results.

#include <memory>
#include <string>
#include <utility>

#include "host/apps/biteline-host/operator_control.hpp"
#include "tests/support/errors.hpp"

namespace biteline::test {

inline std::unique_ptr<service::OperatorControl> opened_operator_control(
    const std::filesystem::path& results) {
  service::OperatorControlConfig config;
  config.results = results;
  auto opened = service::OperatorControl::open(config);
  SUCCEEDS(opened);
  return std::move(*opened);
}

/// A scan that was worked out waits for a person.
inline void hold_worked(service::OperatorControl& sut, const service::OperatorControl::HeldShown& held) {
  sut.works(held.scan);
  sut.hold(held);
}

/// A scan that came in is worked out.
inline void work(service::OperatorControl& sut, const std::string& scan) {
  sut.scan_begins(scan);
  sut.enter(service::CellEvent::ScanIsIn);
  sut.works(scan);
}

}  // namespace biteline::test
