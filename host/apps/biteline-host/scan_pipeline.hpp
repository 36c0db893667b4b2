// SPDX-License-Identifier: MIT
#pragma once
/// \file What is done with a scan, step by step.  Each step writes its own result and tells it in one line on
/// stdout.

#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/apps/biteline-host/late_work.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/intake/live_line.hpp"
#include "host/intake/scan_intake.hpp"
#include "host/robot/path/plan.hpp"
#include "host/robot/path/process.hpp"
#include "host/transfer/transfer.hpp"

namespace biteline::service {

/// One line on stdout, at once; from any thread.
[[gnu::format(printf, 1, 2)]] void log_step(const char* pattern, ...);
/// The same of what a maintainer looks for: the journal has it as a warning.
[[gnu::format(printf, 1, 2)]] void warn_step(const char* pattern, ...);

struct LineStep {
  ExitStatus status{ExitStatus::Refused};
  double confidence{0};
  std::optional<cloud::ClosedLine> line;  ///< when one was found, or is for review (`status`)
  std::optional<uncertainty::ArmMotion> arm{};
  LatePages pages{};             ///< before anybody else changes report.json
  bool pictures_vouched{false};  ///< as the head was calibrated: see consistency::vouched_by()
  bool too_little_seen{false};   ///< the scan itself is why: no model could be told in it either
};

/// What a scan's U95 takes from elsewhere, where it is told.
struct KnownBefore {
  std::optional<uncertainty::HeadUncertainty> head{};
  std::optional<uncertainty::ArmGive> arm{};
};

/// cloud.ply, line.csv, report.json; stages/ and index.html with the pages.  A scan that did not come to its
/// own end is refused: the cloud is kept. `line` has had every profile of the scan.  `release`, here and
/// below: SHA-256 of the one that the scan is worked with, for report.json; empty: none.
[[nodiscard]] Result<LineStep> find_line(const std::filesystem::path& folder, const intake::ScanOutcome& scan,
                                         intake::LiveLine& line, const KnownBefore& known,
                                         const std::string& release);

/// The line stands in the folder, but nobody knows whose it is: the report refuses it, and line.csv goes.
[[nodiscard]] Result<void> refuse_unknown(const std::filesystem::path& folder, const std::string& words,
                                          const std::string& release);

/// A sample, read and ready.
struct Carrier {
  std::string name;
  transfer::ReadySample sample;
  transfer::TransferOptions options;
  bool or_leave{false};  ///< where it is refused, what stands in the folder stays
};

/// The same of an upper without a sole: its line is the sample's, carried over.
[[nodiscard]] Result<LineStep> carry_line(const std::filesystem::path& folder, const Carrier& carrier,
                                          const intake::ScanOutcome& scan, const KnownBefore& known,
                                          const std::string& release);

struct PlanStepRequest {
  kinematics::ArmModel arm;
  path::Process process;
  double table_z_mm{0};
  std::optional<path::Fixture> fixture{};  ///< what the shoe stands on above the table
  path::Mounted mounted{};                 ///< as it was taught; its table's height goes before `table_z_mm`
  std::optional<kinematics::Joints> near_rad{};  ///< where the arm was after the scan, where somebody knows
};

struct PlanStep {
  ExitStatus status{ExitStatus::Refused};
  path::PlanRequest request;
  path::PlanOutcome outcome;  ///< with a path when every check passed
};

/// path.csv, path.script, report.json.  The arm that scanned is the arm that follows: its base is the cloud's
/// frame.
[[nodiscard]] Result<PlanStep> plan_path(const std::filesystem::path& folder, const PlanStepRequest& request,
                                         const intake::ScanOutcome& scan, const cloud::ClosedLine& line);

/// The same of a scan that was planned before, with another line.
[[nodiscard]] Result<PlanStep> plan_again(const std::filesystem::path& folder, path::PlanRequest request,
                                          cloud::ClosedLine line);

}  // namespace biteline::service
