// SPDX-License-Identifier: MIT
#include "hal/sim/motion/scan_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biteline::sim {

namespace {

/// The wall stands about this far inside the outline at the line.
constexpr double k_wall_mm = 2;

/// Frame with the given z and an x near `upwards`.
Mat3 frame_along(const Vec3& z, const Vec3& upwards) {
  Mat3 R;
  R.col(2) = z.normalized();
  R.col(1) = R.col(2).cross(upwards).normalized();
  R.col(0) = R.col(1).cross(R.col(2));
  return R;
}

/// From 1 at 0 and before to 0 at `over` and behind, smooth in speed and acceleration.
double fall(double way, double over) {
  const double u = std::clamp(way / over, 0.0, 1.0);
  return 1 - u * u * u * (10 + u * (6 * u - 15));
}

}  // namespace

ScanPath::ScanPath(const Outline& outline, const MadeHead& head, const ScanPathSettings& settings)
    : outline_(outline), settings_(settings) {
  SE3 T_cam_beam = SE3::Identity();
  T_cam_beam.linear() = frame_along(head.laser.beam_cam, Vec3::UnitX());
  T_cam_beam.translation() = Vec3(0, 0, head.working_distance_mm);
  T_beam_cam_ = T_cam_beam.inverse(Eigen::Isometry);
}

double ScanPath::length_mm() const {
  return outline_.perimeter_mm() + 2 * settings_.lead_mm + overlap_mm();
}
double ScanPath::overlap_mm() const {
  return std::max(0.0, settings_.check.length_mm - 2 * ramp_mm(settings_.speed_mm_s));
}
double ScanPath::duration_s() const {
  return length_mm() / settings_.speed_mm_s;
}

Vec2 ScanPath::outwards_at(double s_mm) const {
  if (settings_.turn_over_mm <= 0) return outline_.at(s_mm).normal;
  // Weights fall off as a cosine does: the turning speed and its change are then smooth, too.
  constexpr int k_side = 40;
  Vec2 sum = Vec2::Zero();
  for (int i = -k_side; i <= k_side; ++i) {
    const double part = static_cast<double>(i) / (k_side + 1);
    sum += (1 + std::cos(std::numbers::pi * part)) *
           outline_.at(s_mm + part * settings_.turn_over_mm / 2).normal;
  }
  return sum.normalized();
}

/// Yaw differs all along the lap, pitch most at its begin, roll at its end: no axis is the same throughout.
/// The head comes nearer behind the begin and draws back before the end: its speed along the beam tells the
/// clock.  All of it fades over half of the way round, so that no joint is hurried.
SE3 ScanPath::T_beam_checking_at(double way_mm) const {
  const CheckLap& check = settings_.check;
  SE3 T = SE3::Identity();
  if (check.length_mm <= 0) return T;
  const double after_mm = way_mm, before_mm = length_mm() - way_mm;
  const double long_mm = 0.45 * outline_.perimeter_mm(), short_mm = 0.25 * outline_.perimeter_mm();
  const double both = fall(after_mm, long_mm) - fall(before_mm, long_mm);
  const double begin = fall(after_mm, short_mm), end = fall(before_mm, short_mm);
  // Of the beam's frame: x up, y along the travel, z along the beam.  The table is near: nothing of the head
  // goes down.
  T.linear() = (Eigen::AngleAxisd(check.yaw_rad * both, Vec3::UnitX()) *
                Eigen::AngleAxisd(-check.pitch_rad * begin, Vec3::UnitY()) *
                Eigen::AngleAxisd(-check.roll_rad * end, Vec3::UnitZ()))
                   .toRotationMatrix();
  T.translation() = Vec3(check.height_mm * fall(after_mm, long_mm), 0, -check.away_mm * (begin + end));
  return T;
}

SE3 ScanPath::T_shoe_cam_at(double way_mm) const {
  const Outline::Place place = outline_.at(s_at_mm(way_mm));
  const Vec2 target = place.point - k_wall_mm * place.normal;
  const Vec2 outwards = outwards_at(s_at_mm(way_mm));
  const Vec3 inwards(-outwards.x(), -outwards.y(), 0);
  SE3 T_shoe_beam = SE3::Identity();
  // Image columns rise with height: the stripe stands upright on the wall.
  T_shoe_beam.linear() = frame_along(
      std::cos(settings_.pitch_rad) * inwards - std::sin(settings_.pitch_rad) * Vec3::UnitZ(), Vec3::UnitZ());
  T_shoe_beam.translation() = Vec3(target.x(), target.y(), settings_.target_z_mm);
  return T_shoe_beam * T_beam_checking_at(way_mm) * T_beam_cam_;
}

}  // namespace biteline::sim
