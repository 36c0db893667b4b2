// SPDX-License-Identifier: MIT
#include "host/report/report.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "host/report/json_text.hpp"

namespace biteline::report {

namespace fs = std::filesystem;

Report::Report() : begin_{Clock::now()} {}

Report::StageTimer::~StageTimer() {
  report_.add_stage(stage_, std::chrono::duration<double>(Clock::now() - begin_).count());
}

void Report::add_stage(const std::string& stage, double seconds) {
  auto& entry = stages_[stage];
  entry = (entry.is_null() ? 0.0 : entry.get<double>()) + seconds;
}

void Report::refuse(ToldRefusal refusal) {
  refusal_ = std::move(refusal);
  for_review_ = false;
}

void Report::review(ToldRefusal why) {
  refusal_ = std::move(why);
  for_review_ = true;
}

ExitStatus Report::status() const {
  if (!refusal_) return ExitStatus::Done;
  return for_review_ ? ExitStatus::Review : ExitStatus::Refused;
}

void Report::refuse(const std::string& reason) {
  refuse(ToldRefusal{.reason_code = {}, .reason = reason, .next_step = {}});
}

void Report::stop_clock() {
  if (total_s_ < 0) total_s_ = std::chrono::duration<double>(Clock::now() - begin_ - aside_).count();
}

std::string Report::text() {
  stop_clock();
  nlohmann::ordered_json all;
  all["schema_version"] = k_schema_version;
  all["status"] = !refusal_ ? "ok" : for_review_ ? "review" : "refused";
  if (refusal_) {
    if (!refusal_->reason_code.empty()) all["reason_code"] = refusal_->reason_code;
    all["reason"] = refusal_->reason;
    if (!refusal_->next_step.empty()) all["next_step"] = refusal_->next_step;
  }
  if (!fields.is_null()) all.update(fields);
  all["stages"] = stages_.is_null() ? nlohmann::ordered_json::object() : stages_;
  all["total_s"] = total_s_;
  return to_text(all) + "\n";
}

Result<void> Report::write(const fs::path& folder) {
  return write_file_atomically(folder / "report.json", text());
}

Result<void> write_file_atomically(const fs::path& file, const std::string& text) {
  const fs::path beside = file.string() + ".part";
  std::FILE* out = std::fopen(beside.c_str(), "wb");
  if (out == nullptr) return fail_errno(Errc::WriteFailed, errno, "%s", beside.c_str());
  const bool written = std::fwrite(text.data(), 1, text.size(), out) == text.size() &&
                       std::fflush(out) == 0 && ::fsync(::fileno(out)) == 0;
  int write_errno = written ? 0 : errno;
  if (std::fclose(out) != 0 && written) write_errno = errno;
  if (write_errno != 0) {
    std::error_code ignored;
    fs::remove(beside, ignored);
    return fail_errno(write_errno == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, write_errno, "%s",
                      file.c_str());
  }
  if (std::rename(beside.c_str(), file.c_str()) != 0)
    return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  return {};
}

Result<void> prepare_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", folder.c_str());
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    return fail_errno(Errc::WriteFailed, errno, "%s", folder.c_str());
  return {};
}

}  // namespace biteline::report
