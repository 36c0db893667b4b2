// SPDX-License-Identifier: MIT
#pragma once
/// \file A path goes to the arm: what the gate is told, and the motion.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"
#include "host/apps/biteline-host/controller.hpp"
#include "host/apps/biteline-host/scan_pipeline.hpp"
#include "host/records/memory/memory.hpp"
#include "host/report/refusal.hpp"
#include "host/robot/link/gate/gate.hpp"
#include "host/robot/link/ur/clamp_watch.hpp"
#include "host/robot/link/ur/pendant_watch.hpp"
#include "host/robot/path/force_told.hpp"
#include "host/transfer/moved.hpp"

namespace biteline::service {

/// What the sensor saw when it looked again at a shoe that was scanned.
struct Looked {
  HostClock::time_point at;  ///< its end
  robot::Unmoved shows{};    ///< without its age
};

/// What a look has shown, without its age.
[[nodiscard]] robot::Unmoved shown_by(const transfer::Moved& moved);

/// A path that is to be sent, and what the service knows of its scan.
struct SendRequest {
  ControllerAddress controller;
  std::string serial;  ///< of the arm; empty: not told
  bool holds_arm{false};
  robot::ScanFacts scan;                  ///< without its age
  double confidence{0};                   ///< of the line
  std::optional<robot::Word> approved{};  ///< a person's, on this result
  std::optional<HostClock::time_point> scan_ended{};
  path::Mounted mounted{};  ///< as it is taught when the path is sent
  /// Hears which tool stands after a changer was asked; nothing: nobody knows.
  std::function<void(const std::optional<std::string>&)> tool_stands{};
  robot::StopMark mark{};                       ///< of the order that the scan came of
  robot::ur::ArmClaim* claim{nullptr};          ///< of the dead man; outlives the following
  robot::ur::PendantWatch* pendant{nullptr};    ///< rests meanwhile, and is told; outlives the following
  const robot::ur::ClampWatch* clamp{nullptr};  ///< of a cell that has one; outlives the following
  std::optional<Looked> looked{};               ///< nothing: nobody has asked for it
  std::filesystem::path looked_at{};            ///< the scan's folder: what is compared with `written`
  memory::Evidence written{};                   ///< what the path was planned of
  std::filesystem::path process_file{};         ///< where its process was read
};

/// Where the arm stands, checks its way to the path from there, asks the controller about itself, has a
/// changer bring the process's tool when all else holds, opens the gate (gate.json), sends the path, watches
/// the arm follow: followed.json, track.csv, and the track in path/tracking.html.  The arm is stopped when it
/// leaves the process's limits and when somebody says stop; a stop before the sending is the gate's no.
/// `meanwhile` runs beside the arm's motion, at the least priority; what fails in it is told.
/// `pressed` hears the force of a path that pressed and came to its end.
/// Pre: the plan has a path.
[[nodiscard]] Result<ExitStatus> follow_path(const std::filesystem::path& folder, const PlanStep& plan,
                                             const SendRequest& request,
                                             std::function<Result<void>()> meanwhile = {},
                                             const std::function<void(const path::ForceTold&)>& pressed = {});

/// What the gate would say no to although a person says yes, as far as it is known without the arm; nothing:
/// a yes goes to the gate.  Pre: the plan has a path.
[[nodiscard]] std::optional<report::ToldRefusal> why_not_sendable(const std::filesystem::path& folder,
                                                                  const PlanStep& plan,
                                                                  const SendRequest& request);
/// For how long the gate lets it through for its age, s; below 0: it does not any more.  Nothing: for as long
/// as somebody vouches for it, a person or a clamp that has not let go; or its age is not known.
/// Pre: the plan has a path.
[[nodiscard]] std::optional<double> fresh_s(const PlanStep& plan, const SendRequest& request);
/// The gate has let a path of this scan through, or its decision cannot be read.
[[nodiscard]] bool was_sent(const std::filesystem::path& folder);

/// A person must say a word before this may be sent.
[[nodiscard]] bool needs_a_person(const path::GateLimits& limits, double confidence);

}  // namespace biteline::service
