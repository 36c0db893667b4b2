// SPDX-License-Identifier: MIT
#include "firmware/record/keep_request.hpp"

#include <chrono>
#include <system_error>
#include <utility>

#include "firmware/record/wanted.hpp"
#include "firmware/runtime/thread_table.hpp"

namespace biteline::record {
namespace {

namespace fs = std::filesystem;

Result<std::string> keep_the_last(const fs::path& series, const std::string& fault) {
  BITELINE_ASSIGN(const fs::path kept, keep_last(series));
  return kept.string() + (fault.empty() ? "" : "; not whole: " + fault);
}

Result<std::string> keep_the_next(const fs::path& series) {
  std::error_code unknown;
  const fs::space_info room = fs::space(series.has_parent_path() ? series.parent_path() : ".", unknown);
  // A wish that no recording can fulfil is refused now and not when the scan is over.
  if (!unknown && room.available == 0)
    return fail(Errc::DiskFull, "%s: the disk is full; make room first", series.c_str());
  BITELINE_TRY(keep_next(series));
  return "the scan that ends next, as " + series.string();
}

}  // namespace

Result<void> KeepRequest::begin(KeepWhich which, const LastScan& last) {
  if (!policy_.series) {
    return fail(Errc::NotSupported,
                "this sensor records nothing; start it with --record NAME --record-asked");
  }
  if (!policy_.asked) {
    return fail(Errc::NotSupported,
                "%s: scans are recorded under their own names and none waits; start the sensor with "
                "--record-asked",
                policy_.series->c_str());
  }
  if (under_way_.valid()) return fail(Errc::WrongState, "the request before is still under way");
  if (which == KeepWhich::Last && last.being_written)
    return fail(Errc::WrongState, "the last scan is still being written; ask again");
  under_way_ = std::async(std::launch::async, [which, policy = policy_, last]() -> Result<std::string> {
    BITELINE_TRY(runtime::enter_thread(runtime::threads::k_record, policy.realtime));
    if (which == KeepWhich::Last) return keep_the_last(*policy.series, last.fault);
    return keep_the_next(*policy.series);
  });
  return {};
}

std::optional<Result<std::string>> KeepRequest::take() {
  if (!under_way_.valid() || under_way_.wait_for(std::chrono::seconds{0}) != std::future_status::ready)
    return std::nullopt;
  return under_way_.get();
}

}  // namespace biteline::record
