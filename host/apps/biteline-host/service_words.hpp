// SPDX-License-Identifier: MIT
#pragma once
/// \file Small things that every part of the service says the same way.

#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"
#include "host/apps/biteline-host/catalogue.hpp"
#include "host/apps/biteline-host/controller.hpp"
#include "host/apps/biteline-host/options.hpp"
#include "host/apps/biteline-host/scan_pipeline.hpp"
#include "host/intake/child_process.hpp"

namespace biteline::service {

/// In the folder of the results: one service at a time holds it.
inline constexpr const char* k_results_lock = "biteline-host.lock";

/// The answer to a start matters: a stop has done its work or there was nothing to stop.
inline constexpr std::uint32_t k_start_id = 1;
inline constexpr std::uint32_t k_stop_id = 2;
/// Larger ones: settings and recordings, as OperatorControl counts them.
inline constexpr std::uint32_t k_last_own_id = 2;

/// One line on standard error; what goes wrong again and again is told less and less often (ToldOnce).
/// Thread: any.
void log_error(const Error& error);

/// Goes on while the machine is suspended, as the shoe grows older meanwhile: not to be compared with stamps
/// of a link.
[[nodiscard]] HostClock::time_point now();
[[nodiscard]] std::string utc_now();
[[nodiscard]] ControllerAddress controller_of(const RobotOptions& robot);
/// What the shoe stands on above the table; none: on the table.
[[nodiscard]] std::optional<path::Fixture> fixture_of(const RobotOptions& robot);
/// Shipped processes stand beside the program, as installed and as built.
[[nodiscard]] CatalogueFolders catalogue_folders(const Options& options);

/// A scan's own exceptions (memory, text that no JSON takes) are the scan's, not the service's.
template <class Work>
Result<ExitStatus> without_exceptions(Work&& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    return fail(Errc::ContractBroken, "%.200s", error.what());
  }
}

}  // namespace biteline::service
