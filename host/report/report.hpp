// SPDX-License-Identifier: MIT
#pragma once
/// \file report.json: what a command found, how good it is, and how long each stage took.

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/report/refusal.hpp"

namespace biteline::report {

/// `schema_version` of every report.json.  Goes up when a key is renamed or removed, or changes its meaning
/// or unit; a new key leaves it.
inline constexpr int k_schema_version = 1;

/// Created when the input is opened; written last.  Not thread-safe.
///
///     Report report;
///     auto cloud = report.timed("read", [&] { return cloud::read_cloud(file); });
///     report.fields["points"] = cloud->size();
///     report.write(folder);
class Report {
 public:
  Report();

  /// Runs `work` and adds its wall time to the stage; a stage may be timed several times.
  template <class Work>
  auto timed(const std::string& stage, Work&& work) {
    const StageTimer timer{*this, stage};
    return work();
  }

  /// A stage that was timed elsewhere: work that ran beside this thread's.
  void add_stage(const std::string& stage, double seconds);

  /// As timed(), but left out of total_s: the pictures in stages/.
  template <class Work>
  auto timed_aside(const std::string& stage, Work&& work) {
    const StageTimer timer{*this, stage};
    const auto begin = Clock::now();
    struct Aside {
      Report& report;
      Clock::time_point begin;
      ~Aside() { report.aside_ += Clock::now() - begin; }
    } aside{*this, begin};
    return work();
  }

  /// The input is readable and gives no trustworthy answer.
  void refuse(ToldRefusal refusal);
  /// As a module's own refusal, with the words of its table.
  template <class Code>
  void refuse(const Refusal<Code>& refusal) {
    refuse(told(refusal));
  }
  /// A reason that has no code yet.
  void refuse(const std::string& reason);
  [[nodiscard]] bool refused() const { return status() == ExitStatus::Refused; }
  /// There is a result, and a person must settle it before anything is done with it; `why` says what.
  void review(ToldRefusal why);
  template <class Code>
  void review(const Refusal<Code>& why) {
    review(told(why));
  }
  /// Done, Review or Refused: `status` says ok, review or refused.
  [[nodiscard]] ExitStatus status() const;

  /// Stops total_s; call when the last result is written.  write() calls it otherwise.
  void stop_clock();

  /// The text of report.json, for --json too; stops the clock.
  [[nodiscard]] std::string text();
  /// Writes `folder`/report.json (beside and renamed).
  [[nodiscard]] Result<void> write(const std::filesystem::path& folder);

  /// Everything beyond schema_version, status, the refusal, stages and total_s.
  nlohmann::ordered_json fields;

 private:
  using Clock = std::chrono::steady_clock;
  class StageTimer {
   public:
    StageTimer(Report& report, std::string stage) : report_{report}, stage_{std::move(stage)} {}
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;
    ~StageTimer();

   private:
    Report& report_;
    std::string stage_;
    Clock::time_point begin_{Clock::now()};
  };

  Clock::time_point begin_;
  Clock::duration aside_{0};
  double total_s_{-1};
  nlohmann::ordered_json stages_;
  std::optional<ToldRefusal> refusal_;
  bool for_review_{false};  ///< with it
};

/// Writes `text` to a file beside and renames it: a reader sees the old file or the new one, never half of
/// one.
[[nodiscard]] Result<void> write_file_atomically(const std::filesystem::path& file, const std::string& text);

/// Creates the folder and proves that it can be written to.
[[nodiscard]] Result<void> prepare_folder(const std::filesystem::path& folder);

}  // namespace biteline::report
