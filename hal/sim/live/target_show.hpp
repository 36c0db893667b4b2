// SPDX-License-Identifier: MIT
#pragma once
/// \file Ring targets or chessboards before a made head, as live pictures: what the head sees while it is
/// calibrated.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/image/grey_image.hpp"
#include "hal/sim/gvcamera/gv_camera.hpp"
#include "hal/sim/record/calibration_views.hpp"

namespace biteline::sim {

struct TargetShowSettings {
  std::uint64_t seed{1};
  int camera_places{12}, laser_places{7}, hand_eye_places{13};
  int chessboard_squares{0};  ///< as of CalibrationViews
  /// The lamp gives its white at this exposure.  So long, since the head's filter keeps most of it out.
  Nanoseconds lamp_exposure{20'000'000};
};

/// Places of the arm, one after the other: for the camera, for the laser, for the mounting.
/// Pictures are made when a place is first seen, which takes a second; then they are only scaled by the
/// exposure.  The noise of a place's pictures is always the same.  Thread: one owner of paint().
class TargetShow {
 public:
  struct Place {
    std::vector<PlacedGrid> sheets;
    LampLight lamp;
    SE3 T_base_flange{SE3::Identity()};
  };
  TargetShow(const MadeHead& head, const TargetShowSettings& settings);

  [[nodiscard]] std::size_t count() const { return places_.size(); }
  /// Pre: `index` < count().
  [[nodiscard]] const Place& place(std::size_t index) const { return places_[index]; }

  /// Fills the exposure's region, of the full sensor.
  void paint(std::size_t index, const GvExposure& exposure, bool lit, std::span<std::uint8_t> pixels);

 private:
  void prepare(std::size_t index);

  MadeHead head_;
  TargetShowSettings settings_;
  std::vector<Place> places_;
  std::size_t prepared_{~std::size_t{0}};
  image::GreyImage rings_, stripe_;  ///< of the place that was prepared, full sensor, nominal exposures
};

}  // namespace biteline::sim
