// SPDX-License-Identifier: MIT
#pragma once
/// \file The service's answers to a page, over a folder of results.

#include <memory>
#include <string>
#include <utility>

#include "host/apps/biteline-host/cockpit.hpp"
#include "tests/support/errors.hpp"

namespace biteline::test {

inline std::unique_ptr<service::Cockpit> opened_cockpit(const std::filesystem::path& results) {
  service::CockpitConfig config;
  config.results = results;
  auto opened = service::Cockpit::open(config);
  SUCCEEDS(opened);
  return std::move(*opened);
}

/// A scan that was worked out waits for a person.
inline void hold_worked(service::Cockpit& sut, const service::Cockpit::HeldShown& held) {
  sut.works(held.scan);
  sut.hold(held);
}

/// A scan that came in is worked out.
inline void work(service::Cockpit& sut, const std::string& scan) {
  sut.scan_begins(scan);
  sut.enter(service::CellEvent::ScanIsIn);
  sut.works(scan);
}

}  // namespace biteline::test
