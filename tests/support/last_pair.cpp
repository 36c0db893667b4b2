// SPDX-License-Identifier: MIT
#include "tests/support/last_pair.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "hal/sim/shoe/random.hpp"

namespace biteline::test {
namespace {

constexpr double k_two_pi = 2 * std::numbers::pi;
// Thinned: surfels are 2 mm apart, and a pair is made in a tenth of a second.
constexpr double k_profile_step_mm = 1.6, k_column_step_mm = 0.15;
constexpr double k_noise_mm = 0.015;

/// A place on the wall: s along the outline, and in space.
struct Place {
  double s_mm;
  Vec3 point;
};

/// Sum of sines 100 to 250 mm long.
class Difference {
 public:
  Difference(const LastPairSettings& settings, double perimeter_mm, sim::Random random) {
    constexpr int k_waves = 5;
    for (int i = 0; i < k_waves; ++i) {
      const auto per_mm = [&] { return k_two_pi / random.uniform({100, 250}); };
      const double any_rad = random.uniform({0, k_two_pi});
      Wave wave{.amplitude = random.uniform({0.3, 1}), .phase_rad = random.uniform({0, k_two_pi})};
      if (settings.waves == Waves::AnyWay) {
        const double k = per_mm();
        wave.along = k * std::cos(any_rad);
        wave.in_space.z() = k * std::sin(any_rad);
      } else if (settings.waves == Waves::Space) {
        const Vec3 way{random.gaussian(), random.gaussian(), random.gaussian()};
        wave.in_space = per_mm() * way.normalized();
      } else {
        wave.along = per_mm();
        if (settings.waves == Waves::Beside) wave.in_space.z() = (any_rad < 3 ? 1 : -1) * per_mm();
      }
      // A whole number of waves meets itself round the shoe.
      wave.along = std::round(wave.along * perimeter_mm / k_two_pi) * k_two_pi / perimeter_mm;
      waves_.push_back(wave);
    }
    double power = 0;
    for (const Wave& wave : waves_) power += wave.amplitude * wave.amplitude / 2;
    for (Wave& wave : waves_) wave.amplitude *= settings.difference_rms_mm / std::sqrt(power);
  }

  [[nodiscard]] double at(const Place& place) const {
    double sum_mm = 0;
    for (const Wave& wave : waves_) {
      sum_mm += wave.amplitude *
                std::sin(wave.along * place.s_mm + wave.in_space.dot(place.point) + wave.phase_rad);
    }
    return sum_mm;
  }

 private:
  struct Wave {
    double amplitude{0}, along{0}, phase_rad{0};
    Vec3 in_space{Vec3::Zero()};
  };
  std::vector<Wave> waves_;
};

/// By how much an edge is cut lower than the other one's.
class Cut {
 public:
  Cut(Collar collar, double perimeter_mm, double length_mm, sim::Random random)
      : per_mm_{k_two_pi / perimeter_mm}, length_mm_{length_mm} {
    if (collar == Collar::Elsewhere || collar == Collar::Parallel) even_mm_ = random.uniform({0.5, 6});
    if (collar == Collar::Elsewhere) aslant_mm_ = random.uniform({-1.5, 1.5});
    const double wavy_mm = collar == Collar::Elsewhere ? random.uniform({0.1, 0.5})
                           : collar == Collar::Trimmed ? random.uniform({0.03, 0.15})
                                                       : 0;
    for (int count = 1; count <= k_counts; ++count) {
      waves_.push_back(
          {wavy_mm * std::sqrt(2.0 / k_counts) * random.gaussian(), random.uniform({0, k_two_pi})});
    }
  }
  [[nodiscard]] double at(const Place& place) const {
    double sum_mm = even_mm_ + aslant_mm_ * place.point.x() / length_mm_;
    for (std::size_t i = 0; i < waves_.size(); ++i) {
      sum_mm += waves_[i].amplitude_mm *
                std::sin(static_cast<double>(i + 1) * per_mm_ * place.s_mm + waves_[i].phase_rad);
    }
    return sum_mm;
  }

 private:
  static constexpr int k_counts = 8;
  struct Wave {
    double amplitude_mm, phase_rad;
  };
  double per_mm_, length_mm_;
  double even_mm_{0}, aslant_mm_{0};
  std::vector<Wave> waves_;
};

struct View {
  double low_z_mm, high_z_mm;
};

double lowest_top_mm(const sim::MadeShoe& shoe) {
  double lowest_mm = 1e9;
  for (double s_mm = 0; s_mm < shoe.perimeter_mm(); s_mm += 5)
    lowest_mm = std::min(lowest_mm, shoe.section(s_mm).top_z_mm());
  return lowest_mm;
}

double lowest_line_mm(const std::vector<sim::TrueLinePoint>& line) {
  return std::min_element(line.begin(), line.end(),
                          [](const auto& a, const auto& b) { return a.point_shoe.z() < b.point_shoe.z(); })
      ->point_shoe.z();
}

/// Moves each point outward by `bulge_mm` and leaves out what lies above the section's top less `lower_mm`.
cloud::PointCloud scanned_and_cut(const sim::MadeShoe& shoe, const View& view, std::uint64_t seed,
                                  const SE3& T_base_shoe, const std::function<double(const Place&)>& bulge_mm,
                                  const std::function<double(const Place&)>& lower_mm) {
  const sim::ScanSettings settings{.profile_step_mm = k_profile_step_mm,
                                   .column_step_mm = k_column_step_mm,
                                   .noise_mm = k_noise_mm,
                                   .field_low_z_mm = view.low_z_mm,
                                   .field_high_z_mm = view.high_z_mm,
                                   .seed = seed};
  const sim::ScannedCloud scan = sim::scan_quickly(shoe, settings, SE3::Identity());
  const double profiles = std::max(3.0, std::round(shoe.perimeter_mm() / k_profile_step_mm));
  cloud::PointCloud cloud;
  for (std::size_t first = 0; first < scan.points.size();) {
    const double s_mm = shoe.perimeter_mm() * scan.profile[first] / profiles;
    const sim::Section section = shoe.section(s_mm);
    const Vec2 outward = section.place().normal;
    const Vec3 top{section.place().point.x(), section.place().point.y(), section.top_z_mm()};
    const double cut_z_mm = section.top_z_mm() - lower_mm({.s_mm = s_mm, .point = top});
    std::size_t i = first;
    for (; i < scan.points.size() && scan.profile[i] == scan.profile[first]; ++i) {
      Vec3 point = scan.points[i].cast<double>();
      if (point.z() > cut_z_mm) continue;
      point.head<2>() += bulge_mm({.s_mm = s_mm, .point = point}) * outward;
      cloud.points.push_back((T_base_shoe * point).cast<float>());
      cloud.profile.push_back(scan.profile[i]);
      cloud.column.push_back(scan.column[i]);
    }
    first = i;
  }
  return cloud;
}

}  // namespace

MadePair last_pair(const LastPairSettings& settings) {
  const sim::Random source{settings.seed * 64 + static_cast<std::uint64_t>(settings.collar)};
  sim::Random random = source.fork(1);
  sim::ShoeParameters parameters = sim::draw_shoe(settings.shoe_class, settings.seed);
  const sim::MadeShoe sample{parameters};
  parameters.bare = true;
  const sim::MadeShoe upper{parameters};
  const std::vector<sim::TrueLinePoint> truth = sim::true_line(sample, 2.0);

  const Difference difference{settings, sample.perimeter_mm(), source.fork(2)};
  const Cut cut{settings.collar, sample.perimeter_mm(), sample.outline().length_mm(), source.fork(3)};
  const bool upper_is_lower = random.chance(0.5);
  const auto none = [](const Place&) { return 0.0; };
  const auto lower = [&](const Place& place) { return cut.at(place); };

  constexpr double k_all_mm = 150;
  View sample_view{.low_z_mm = -5, .high_z_mm = k_all_mm}, upper_view = sample_view;
  if (settings.collar == Collar::BothCut)
    sample_view.high_z_mm = lowest_top_mm(sample) - random.uniform({1, 12});
  if (settings.collar == Collar::BothCut || settings.collar == Collar::UpperCut)
    upper_view.high_z_mm = lowest_top_mm(sample) - random.uniform({1, 12});
  if (!settings.feather_seen) upper_view.low_z_mm = lowest_line_mm(truth) - random.uniform({3, 8});

  const auto any_pose = [&] {
    const double yaw_rad = random.uniform({0, k_two_pi});
    const Vec3 place_mm{random.uniform({300, 500}), random.uniform({-150, 150}), random.uniform({20, 80})};
    return geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{yaw_rad, Vec3::UnitZ()}}, place_mm);
  };
  MadePair pair{.T_base_sample = any_pose(), .T_base_upper = any_pose()};
  pair.sample_cloud = scanned_and_cut(sample, sample_view, 2 * settings.seed, pair.T_base_sample, none,
                                      upper_is_lower ? std::function<double(const Place&)>{none} : lower);
  pair.upper_cloud = scanned_and_cut(
      upper, upper_view, 2 * settings.seed + 1, pair.T_base_upper,
      [&](const Place& place) { return difference.at(place); },
      upper_is_lower ? std::function<double(const Place&)>{lower} : none);

  pair.sample_line = as_line(truth, pair.T_base_sample);
  std::vector<sim::TrueLinePoint> on_upper = sim::carried_line(truth, upper);
  for (sim::TrueLinePoint& p : on_upper) {
    const Vec2 outward = upper.outline().at(p.s_mm).normal;
    p.point_shoe.head<2>() += difference.at({.s_mm = p.s_mm, .point = p.point_shoe}) * outward;
  }
  pair.upper_line = as_line(on_upper, pair.T_base_upper);
  return pair;
}

}  // namespace biteline::test
