// SPDX-License-Identifier: MIT
#include "tests/support/uncertain_scan.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "hal/sim/render/made_head.hpp"
#include "hal/sim/shoe/designed_shoe.hpp"
#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "host/bite_line/live_scan.hpp"
#include "tests/support/line_sweep.hpp"

namespace biteline::test {
namespace {

using uncertainty::Covariance;
using uncertainty::HeadUncertainty;
using uncertainty::k_parameters;
using uncertainty::Parameters;

// The stripe's middle on the shoe's wall: the picture shows 60 mm up and down from here.
constexpr double k_aim_z_mm = 50;
constexpr double k_repeat_mm = 0.014, k_repeat_rad = 3e-5;

Parameters gaussians(sim::Random& random) {
  Parameters x;
  for (double& value : x) value = random.gaussian();
  return x;
}

/// Standard deviations as calibrations of made heads state them.
Parameters usual_sigma() {
  Parameters sigma;
  sigma << 0.1, 0.1, 0.15, 0.15, 1e-4, 4e-4, 1e-5, 1e-5, 1e-6,  // px; coefficients
      2e-5, 2e-5, 0.006,                                        // rad, mm
      0.04, 0.04, 0.04, 5e-5, 5e-5, 5e-5,                       // mm, rad
      2e-4;                                                     // s
  return sigma;
}

/// One coordinate of the poses' error along the way, of unit variance.
class Wave {
 public:
  explicit Wave(sim::Random& random) {
    for (Part& part : parts_)
      part = {.per_mm = 2 * std::numbers::pi / random.uniform({50, 400}),
              .cosine = random.gaussian(),
              .sine = random.gaussian()};
  }
  [[nodiscard]] double at(double way_mm) const {
    double sum = 0;
    for (const Part& part : parts_)
      sum += part.cosine * std::cos(part.per_mm * way_mm) + part.sine * std::sin(part.per_mm * way_mm);
    return sum / std::sqrt(static_cast<double>(parts_.size()));
  }

 private:
  struct Part {
    double per_mm, cosine, sine;
  };
  std::array<Part, 6> parts_{};
};

/// The camera of a head that lights the outline's place: stripe upright, beam against the outline's normal.
SE3 T_shoe_cam(const sim::MadeHead& head, const sim::Outline::Place& place) {
  const Vec3 out{place.normal.x(), place.normal.y(), 0};
  Mat3 of_cam;
  of_cam.col(1) = head.model.laser_plane.normal_cam;
  of_cam.col(2) = (head.laser.beam_cam - head.laser.beam_cam.dot(of_cam.col(1)) * of_cam.col(1)).normalized();
  of_cam.col(0) = of_cam.col(1).cross(of_cam.col(2));
  Mat3 of_shoe;
  of_shoe.col(0) = Vec3::UnitZ();
  of_shoe.col(2) = -out;
  of_shoe.col(1) = of_shoe.col(2).cross(of_shoe.col(0));
  SE3 T = SE3::Identity();
  T.linear() = of_shoe * of_cam.transpose();
  // The beam meets the camera's axis on the wall.
  const Vec3 lit{0, 0, head.model.laser_plane.distance_mm / head.model.laser_plane.normal_cam.z()};
  T.translation() = Vec3{place.point.x(), place.point.y(), k_aim_z_mm} - T.linear() * lit;
  return T;
}

SE3 draw_place(sim::Random& random) {
  SE3 T = SE3::Identity();
  T.linear() = Eigen::AngleAxisd(random.uniform({-std::numbers::pi, std::numbers::pi}), Vec3::UnitZ())
                   .toRotationMatrix();
  T.translation() = Vec3{random.uniform({200, 600}), random.uniform({-300, 300}), random.uniform({20, 80})};
  return T;
}

}  // namespace

HeadUncertainty drawn_uncertainty(const geometry::SensorModel& head, double working_mm, sim::Random& random) {
  HeadUncertainty out;
  const Vec3& n = head.laser_plane.normal_cam;
  out.plane_axes.col(0) = n.unitOrthogonal();
  out.plane_axes.col(1) = n.cross(out.plane_axes.col(0));
  out.plane_middle_cam = {0, 0, working_mm};
  // Sigma times a correlation: a random half of each parameter is shared with the others.
  const double scale = random.uniform({0.7, 2.0});
  Covariance mixing = Covariance::Identity();
  for (int row = 0; row < k_parameters - 1; ++row) {
    for (int col = 0; col < k_parameters - 1; ++col) mixing(row, col) += 0.25 * random.gaussian();
    mixing.row(row).normalize();
  }
  const Covariance root = Parameters{scale * usual_sigma()}.asDiagonal() * mixing;
  out.covariance = root * root.transpose();
  out.pose_sigma_mm = random.uniform({0.01, 0.04});
  out.pose_sigma_rad = random.uniform({0.1, 0.5}) * 1e-4;
  return out;
}

Parameters drawn_error(const Covariance& covariance, sim::Random& random) {
  return covariance.llt().matrixL() * gaussians(random);
}

UncertainScan uncertain_scan(const UncertainScanSettings& settings) {
  // Shoes of two classes with one seed are scanned by two heads.
  const std::uint64_t head_seed = settings.seed * 16 + static_cast<std::uint64_t>(settings.shoe_class);
  sim::Random random{head_seed};
  sim::ShoeParameters drawn = sim::draw_shoe(settings.shoe_class, settings.seed);
  if (settings.toe_guard)
    drawn = sim::draw_designed_shoe({.shoe_class = settings.shoe_class, .toe_guard = true}, settings.seed);
  drawn.last_difference_mm = settings.last_difference_mm;
  drawn.last_seed = settings.again.value_or(0);
  const sim::MadeShoe shoe{std::move(drawn)};
  const sim::MadeHead head = sim::draw_head(head_seed);
  const SE3 T_base_shoe = draw_place(random);
  UncertainScan made;
  made.head.uncertainty = drawn_uncertainty(head.model, head.working_distance_mm, random);
  HeadUncertainty& stated = made.head.uncertainty;
  stated.covariance *= settings.errors * settings.errors;
  stated.pose_sigma_mm *= settings.errors;
  stated.pose_sigma_rad *= settings.errors;
  stated.arm_give_mm_per_m_s2 = 0;  // it is off as its poses' spread says
  const Parameters error = settings.errors > 0 ? drawn_error(stated.covariance, random) : Parameters::Zero();
  made.head.model = uncertainty::perturbed(head.model, stated, error);
  const double late_s = error[uncertainty::k_clock_at];
  const double noise_px = random.uniform({0.08, 0.25});

  sim::ScanSettings scan{.profile_step_mm = settings.profile_step_mm,
                         .noise_mm = 0,
                         .seed = settings.again.value_or(settings.seed)};
  const sim::ScannedCloud exact = sim::scan_quickly(shoe, scan, SE3::Identity());
  const int profiles = exact.profile.empty() ? 0 : static_cast<int>(exact.profile.back()) + 1;
  const double step_mm = shoe.perimeter_mm() / std::max(profiles, 1);
  const std::array<Wave, 6> waves{Wave{random}, Wave{random}, Wave{random},
                                  Wave{random}, Wave{random}, Wave{random}};
  const auto true_pose = [&](double way_mm) -> SE3 {
    return T_base_shoe * T_shoe_cam(head, shoe.outline().at(way_mm)) * head.model.T_flange_cam.inverse();
  };
  double missing_from_mm = random.uniform({0, shoe.perimeter_mm()});
  if (const std::optional<sim::Guard>& guard = shoe.parameters().sole.guard) {
    const double flank_mm = guard->where.s_mm + (random.chance(0.5) ? 1 : -1) * guard->where.half_length_mm;
    missing_from_mm = flank_mm - settings.missing_mm * random.uniform({0, 1});
  }
  const auto is_missing = [&](double way_mm) {
    const double on_mm = std::fmod(way_mm - missing_from_mm + shoe.perimeter_mm(), shoe.perimeter_mm());
    return on_mm < settings.missing_mm;
  };
  sim::Random anew{settings.again.value_or(0)};
  const std::array<Wave, 6> not_repeated{Wave{anew}, Wave{anew}, Wave{anew},
                                         Wave{anew}, Wave{anew}, Wave{anew}};
  if (settings.again) random = anew;
  std::size_t point = 0;
  for (int k = 0; k < profiles; ++k) {
    const double way_mm = k * step_mm;
    const SE3 T_shoe_camera = T_shoe_cam(head, shoe.outline().at(way_mm));
    // Told is where the arm is off, and by the clock where it was a little before or after.
    Twist off;
    for (int i = 0; i < 6; ++i) {
      const double sigma = i < 3 ? stated.pose_sigma_mm : stated.pose_sigma_rad;
      off[i] = sigma * std::sqrt(0.9) * waves[static_cast<std::size_t>(i)].at(way_mm) +
               sigma * std::sqrt(0.1) * random.gaussian();
      if (settings.again)
        off[i] += (i < 3 ? k_repeat_mm : k_repeat_rad) * not_repeated[static_cast<std::size_t>(i)].at(way_mm);
    }
    const SE3 told = true_pose(way_mm + late_s * settings.speed_mm_s) * geometry::exp_se3(off);
    made.poses.push_back({.T_base_flange = told, .time_s = way_mm / settings.speed_mm_s});
    const SE3 T_base_cam = told * made.head.model.T_flange_cam;
    const SE3 T_cam_shoe = T_shoe_camera.inverse();
    for (; point < exact.points.size() && static_cast<int>(exact.profile[point]) == k; ++point) {
      if (is_missing(way_mm)) continue;
      Vec2 pixel = head.model.camera.project(T_cam_shoe * exact.points[point].cast<double>());
      pixel.y() += noise_px * random.gaussian();
      const Vec3 seen = geometry::triangulate(made.head.model.camera, made.head.model.laser_plane, pixel);
      made.cloud.points.push_back((T_base_cam * seen).cast<float>());
      made.cloud.profile.push_back(static_cast<std::uint32_t>(k));
      made.cloud.column.push_back(exact.column[point]);
    }
  }
  for (const sim::TrueLinePoint& p : true_line_of(shoe))
    made.truth.points.push_back({.position = T_base_shoe * p.point_shoe,
                                 .normal = T_base_shoe.linear() * p.normal_shoe,
                                 .tangent = Vec3::Zero(),
                                 .confidence = 1});
  return made;
}

bite_line::Extraction line_of(const UncertainScan& scan, std::optional<bite_line::Workings>* workings) {
  bite_line::LiveScan live;
  const cloud::PointCloud& cloud = scan.cloud;
  std::size_t first = 0;
  for (std::size_t k = 0; k < scan.poses.size(); ++k) {
    std::size_t end = first;
    while (end < cloud.size() && cloud.profile[end] == k) ++end;
    live.add_profile(k, {cloud.points.data() + first, end - first}, scan.poses[k]);
    first = end;
  }
  return live.finish({.head = std::make_shared<const uncertainty::KnownHead>(scan.head)}, workings);
}

}  // namespace biteline::test
