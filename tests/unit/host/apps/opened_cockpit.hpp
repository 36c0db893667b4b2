// SPDX-License-Identifier: MIT
#pragma once
/// \file The service's answers to a page, over a folder of results.

#include <memory>

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

}  // namespace biteline::test
