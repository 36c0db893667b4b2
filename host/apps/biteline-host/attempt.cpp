// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/attempt.hpp"

#include <unistd.h>

#include "common/core/text.hpp"
#include "common/system/file.hpp"
#include "host/apps/biteline-host/scan_pipeline.hpp"
#include "host/intake/refused.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_mark = "scan.attempt";
constexpr const char* k_stopped = "scan.stopped";

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

Result<void> mark_stopped(const fs::path& folder, const std::string& who) {
  return report::write_file_atomically(folder / k_stopped, who + "\n");
}

std::string stopped_by(const fs::path& folder) {
  const Result<std::string> text = read_regular_file(folder / k_stopped, 200);
  std::error_code error;
  if (!text) return fs::exists(folder / k_stopped, error) ? "somebody" : "";
  return clean_text(text->substr(0, text->find('\n')), 100);
}

Error stopped_on_its_way(const std::string& who) {
  return fail(Errc::WrongState, "%.100s stopped it", who.c_str()).value();
}

Result<void> set_aside(const fs::path& folder, const std::string& why) {
  report::Report report;
  report.refuse(intake::Refusal{.code = intake::Refused::ScanSetAside,
                                .reason = "the scan is set aside with its recording: " + why});
  BITELINE_TRY(report.write(folder));
  clear_attempt(folder);
  log_step("%s is set aside with its recording: %s", folder.filename().c_str(), why.c_str());
  return {};
}

}  // namespace biteline::service
