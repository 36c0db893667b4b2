// SPDX-License-Identifier: MIT
#pragma once
/// \file Did a scan's pictures come as the head was calibrated?  An answer of this scan alone: nothing is
/// learnt before.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "host/calibration/consistency/agreement.hpp"
#include "host/calibration/consistency/picture_moves.hpp"
#include "host/calibration/consistency/refused.hpp"

namespace biteline::consistency {

/// What is known of head and arm from elsewhere.
struct KnownBefore {
  std::optional<uncertainty::HeadUncertainty> head{};
  std::optional<uncertainty::ArmGive> arm{};
};

struct PictureCheck {
  enum class Status : std::uint8_t {
    Agree,       ///< what was seen from two directions agrees, and moved pictures would not
    Contradict,  ///< no rigid world looks so
    NotSeen,     ///< this scan cannot tell
  };
  Status status{Status::NotSeen};
  Agreement as_told{};
  std::size_t table_profiles{0};  ///< that show one level table all round
  std::string words{};            ///< one sentence for a person
};
[[nodiscard]] std::string_view to_string(PictureCheck::Status status);

/// Places seen from two directions must agree (agreement.hpp).  Where there are none: pictures that with
/// their mirroring, turn or scale taken back show many such places, and all of them agree, did not come as
/// they should; nor did such that show a level table all the way round only then.
///
/// Cost: some tens of milliseconds of the calling thread's arena, three times as much where the scan shows no
/// place from two directions.
[[nodiscard]] PictureCheck check_pictures(const drift::ScanView& scan, const geometry::SensorModel& head,
                                          const KnownBefore& known);

/// Of pictures that contradict themselves: their line is none.
[[nodiscard]] std::optional<Refusal> refusal_of(const PictureCheck& check);

/// Who says that the pictures came as the head was calibrated.  With neither a moved picture gives a sure,
/// wrong line.
enum class VouchedBy : std::uint8_t {
  Places,       ///< what was seen from two directions
  CameraState,  ///< the camera told it, and it was compared with the calibration
  Nobody,
};
[[nodiscard]] VouchedBy vouched_by(const PictureCheck& check, bool camera_state_compared);
[[nodiscard]] std::string_view to_string(VouchedBy by);

/// `picture_check` of report.json.
[[nodiscard]] nlohmann::ordered_json as_json(const PictureCheck& check, bool camera_state_compared);

}  // namespace biteline::consistency
