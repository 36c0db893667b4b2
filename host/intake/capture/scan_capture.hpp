// SPDX-License-Identifier: MIT
#pragma once
/// \file A live scan of the unit's own camera and robot into a session folder.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/session/recording_facts.hpp"
#include "common/wire/messages.hpp"
#include "host/calibration/consistency/picture_check.hpp"
#include "host/calibration/head/verdict.hpp"
#include "host/intake/cloud_builder.hpp"
#include "host/intake/refused.hpp"

namespace biteline::capture {

struct ScanOrder {
  std::filesystem::path board, sensor;
  std::filesystem::path settings{};  ///< empty: none
  std::filesystem::path session;     ///< made by the sensor program; nothing of that name may exist
  std::string rt{"required"};
  int pictures_every{1};  ///< 0: none
};

/// Of the profiles that came so far.
struct ScanCount {
  std::uint64_t profiles{0};
  std::uint64_t without_stripe{0};
  std::uint64_t not_usable{0};  ///< without a pose that fits
  std::uint64_t points{0};
  std::uint64_t saturated{0};
};

struct TakenScan {
  ScanCount count;
  intake::IngestCounts seen;
  wire::EndOfScan end;
  session::RecordingFacts facts;
  consistency::PictureCheck pictures{};
};

/// Some ten times a second while the scan is on; false ends it.
using OnTurn = std::function<bool(const ScanCount&)>;

/// Starts the sensor program, asks for a scan and stays until its end: the robot's, `on_turn`'s, or a
/// device's that failed (TakenScan::end tells).  All is on the disk then.
///
/// Errc::WrongState: there is something of the session's name.  Errc::PeerRefused: the scan did not begin,
/// and why; no folder is left.
[[nodiscard]] Result<TakenScan> capture_scan(const ScanOrder& order, const OnTurn& on_turn);

/// What of the scan itself keeps a shoe from being seen, if anything does.
[[nodiscard]] std::optional<intake::Refusal> cause_of(const TakenScan& scan);

/// What the recording is worth: good when a replay gives the same bits and nearly every profile counts; bad
/// when the pictures contradict the calibration.
[[nodiscard]] calibration::Verdict judge_scan(const TakenScan& scan);

}  // namespace biteline::capture
