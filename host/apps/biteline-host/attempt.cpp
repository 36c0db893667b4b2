// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/attempt.hpp"

#include <unistd.h>

#include "host/apps/biteline-host/steps.hpp"
#include "host/intake/refused.hpp"
#include "host/records/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_mark = "scan.attempt";

}  // namespace

Result<void> mark_attempt(const fs::path& folder) {
  return report::write_file_atomically(folder / k_mark, "process " + std::to_string(::getpid()) + "\n");
}

void clear_attempt(const fs::path& folder) {
  std::error_code ignored;  // a mark that stays costs this scan another try, and no other one
  fs::remove(folder / k_mark, ignored);
}

bool was_attempted(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / k_mark, error);
}

Result<void> set_aside(const fs::path& folder, const std::string& why) {
  report::Report report;
  report.refuse(intake::Refusal{.code = intake::Refused::ScanSetAside,
                                .reason = "the scan is set aside with its recording: " + why});
  BITELINE_TRY(report.write(folder));
  clear_attempt(folder);
  say_step("%s is set aside with its recording: %s", folder.filename().c_str(), why.c_str());
  return {};
}

}  // namespace biteline::service
