// SPDX-License-Identifier: MIT
#include "host/calibration/head/verdict.hpp"

#include <algorithm>
#include <cstdio>
#include <numbers>

#include "common/core/plain_number.hpp"

namespace biteline::calibration {
namespace {

constexpr double k_degrees_per_rad = 180 / std::numbers::pi;
/// A picture this much worse than all together is worth another one.
constexpr double k_worse_ratio = 2.5;

/// From where on a figure is fair, and from where on bad.
struct Bounds {
  double fair, bad;
};
// Rings: the centre of a ring of 80 px is good to 0.02 px; 0.1 px is 0.02 mm at the working distance.
constexpr Bounds k_rings_px{0.1, 0.2};
// 0.05 % of 200 mm is 0.1 mm, the accuracy of a line.
constexpr Bounds k_focal_sigma_ratio{5e-4, 2e-3};
constexpr Bounds k_stripe_mm{0.05, 0.1};
constexpr Bounds k_left_out_mm{0.1, 0.3};
// Less than these leaves lens and place undetermined, however small the residuals are.
constexpr double k_coverage_ratio = 0.5, k_tilt_deg = 25, k_axes_spread_deg = 20, k_turn_deg = 30;
constexpr std::size_t k_camera_views = 8, k_laser_views = 5, k_hand_eye_views = 8;

// A head hangs before the flange.  The one of the drawings sits 293 mm from it; 400 mm is more than an arm
// with 5 kg carries a head at.  Behind the flange there is the wrist: only a tool's tip has the camera behind
// it.
constexpr double k_far_head_mm = 400, k_behind_flange_mm = -60;

class Judge {
 public:
  void figure(double value, Bounds bounds, const char* words) {
    if (value <= bounds.fair) return;
    note(value <= bounds.bad ? Grade::Fair : Grade::Bad, words, value, bounds.fair);
  }
  void at_least(double value, double least, const char* words) {
    if (!(value >= least)) note(Grade::Fair, words, value, least);
  }
  void retake(const std::string& name, const std::string& reason) {
    verdict_.retake.push_back(name + ": " + reason);
  }
  [[nodiscard]] Verdict take() { return std::move(verdict_); }

 private:
  void note(Grade grade, const char* words, double value, double bound) {
    char text[200];
    std::snprintf(text, sizeof text, "%s: %s, good is %s", words, plain_number(value).c_str(),
                  plain_number(bound).c_str());
    verdict_.reasons.emplace_back(text);
    verdict_.grade = std::max(verdict_.grade, grade);
  }
  Verdict verdict_;
};

std::string off_by(double value, const char* unit) {
  char text[60];
  std::snprintf(text, sizeof text, "off by %.3f %s", value, unit);
  return text;
}

}  // namespace

const char* name_of(Grade grade) {
  return grade == Grade::Good ? "good" : grade == Grade::Fair ? "fair" : "bad";
}

Verdict judge(const CameraCalibration& camera) {
  Judge judge;
  const bool corners = !camera.views.empty() && camera.views.front().view.target.chessboard();
  judge.figure(camera.rms_px, k_rings_px, corners ? "corners off by [px]" : "rings off by [px]");
  judge.figure(camera.sigma()[0] / camera.camera.fu_px, k_focal_sigma_ratio, "focal length known to [ratio]");
  judge.at_least(camera.coverage_ratio, k_coverage_ratio,
                 corners ? "share of the picture that held corners" : "share of the picture that held rings");
  judge.at_least(camera.largest_tilt_rad * k_degrees_per_rad, k_tilt_deg, "largest tilt [degrees]");
  judge.at_least(static_cast<double>(camera.views.size()), static_cast<double>(k_camera_views),
                 "camera pictures");
  for (const CameraView& view : camera.views) {
    if (view.rms_px > std::max(k_rings_px.fair, k_worse_ratio * camera.rms_px))
      judge.retake(view.view.name, off_by(view.rms_px, "px"));
  }
  return judge.take();
}

Verdict judge(const LaserCalibration& laser) {
  Judge judge;
  judge.figure(laser.rms_mm, k_stripe_mm, "stripe off its plane by [mm]");
  judge.at_least(static_cast<double>(laser.views.size()), static_cast<double>(k_laser_views), "laser places");
  for (const LaserView& view : laser.views) {
    if (view.rms_mm > std::max(k_stripe_mm.fair, k_worse_ratio * laser.rms_mm))
      judge.retake(view.pictures.name, off_by(view.rms_mm, "mm"));
  }
  return judge.take();
}

Verdict judge(const HandEyeCalibration& hand_eye) {
  Judge judge;
  judge.figure(hand_eye.left_out_rms_mm, k_left_out_mm, "target's place foretold to [mm]");
  judge.at_least(hand_eye.axes_spread_rad * k_degrees_per_rad, k_axes_spread_deg,
                 "angle between the turns' axes [degrees]");
  judge.at_least(hand_eye.largest_turn_rad * k_degrees_per_rad, k_turn_deg, "largest turn [degrees]");
  judge.at_least(static_cast<double>(hand_eye.stops.size()), static_cast<double>(k_hand_eye_views),
                 "hand-eye pictures");
  return judge.take();
}

Verdict judge(const HeadCalibration& head) {
  Verdict all;
  const auto add = [&](const Verdict& part) {
    all.grade = std::max(all.grade, part.grade);
    all.reasons.insert(all.reasons.end(), part.reasons.begin(), part.reasons.end());
    all.retake.insert(all.retake.end(), part.retake.begin(), part.retake.end());
  };
  if (head.camera) add(judge(*head.camera));
  if (head.laser) add(judge(*head.laser));
  if (head.hand_eye) add(judge(*head.hand_eye));
  if (head.hand_eye && head.fit.converged) {
    const Vec3 at = head.fit.state.T_flange_cam.translation();
    if (at.norm() > k_far_head_mm || at.z() < k_behind_flange_mm) {
      all.grade = std::max(all.grade, Grade::Fair);
      all.reasons.push_back(mounting_words(head.fit.state.T_flange_cam) +
                            ": are these poses of the flange, or of the tool's tip?");
    }
  }
  for (const SetAside& one : head.set_aside) all.retake.push_back(one.name + ": " + one.reason);
  if (head.refused) {
    all.grade = Grade::Bad;
    all.reasons.emplace_back(head.refused->where.view());
  }
  return all;
}

std::string mounting_words(const SE3& T_flange_cam) {
  const Vec3& at = T_flange_cam.translation();
  char text[120];
  std::snprintf(text, sizeof text, "the camera sits %.0f mm from the flange, at x %.0f, y %.0f, z %.0f",
                at.norm(), at.x(), at.y(), at.z());
  return text;
}

Refusal refusal_of(const Verdict& verdict) {
  BITELINE_EXPECTS(verdict.grade == Grade::Bad);
  Refusal refusal{.code = Refused::GradeBad, .reason = "the calibration is bad"};
  for (std::size_t i = 0; i < verdict.reasons.size(); ++i)
    refusal.reason += (i == 0 ? ": " : "; ") + verdict.reasons[i];
  return refusal;
}

}  // namespace biteline::calibration
