// SPDX-License-Identifier: MIT
#include "tests/support/line_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_set>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "tests/support/line_distance.hpp"

namespace biteline::test {

namespace {

template <class Enum>
Enum draw(sim::Random& random, std::size_t from, std::size_t end) {
  return static_cast<Enum>(random.integer(static_cast<int>(from), static_cast<int>(end) - 1));
}

/// Cells of 1 mm with points in them.
class Occupied {
 public:
  explicit Occupied(const cloud::PointCloud& cloud) {
    for (const Eigen::Vector3f& p : cloud.points) cells_.insert(cell(p.cast<double>(), 0, 0, 0));
  }
  /// In the point's cell or one beside it.
  [[nodiscard]] bool near(const Vec3& p) const {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (cells_.count(cell(p, x, y, z)) > 0) return true;
        }
      }
    }
    return false;
  }

 private:
  static std::uint64_t cell(const Vec3& p, int dx, int dy, int dz) {
    const auto at = [](double mm, int d) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(mm)) + d + (1 << 20));
    };
    return at(p.x(), dx) << 42U | at(p.y(), dy) << 21U | at(p.z(), dz);
  }
  std::unordered_set<std::uint64_t> cells_;
};

/// Turn between the surfaces 0.4 to 1.6 mm above and below the line, concave > 0.
double turn_deg(const sim::Section& section, double z_mm) {
  constexpr double k_near_mm = 0.4, k_far_mm = 1.6;
  const auto slope = [&](double from, double to) {
    return (section.offset_mm(z_mm + to) - section.offset_mm(z_mm + from)) / (to - from);
  };
  return (std::atan(slope(k_near_mm, k_far_mm)) - std::atan(slope(-k_far_mm, -k_near_mm))) * 180 /
         std::numbers::pi;
}

}  // namespace

std::vector<sim::TrueLinePoint> true_line_of(const sim::MadeShoe& shoe) {
  if (!shoe.parameters().sole.guard) return sim::true_line(shoe, 0.5);
  return sim::true_line(shoe, 0.1, {.running_mean_mm = 0.5});
}

SweepCell sweep_cell(std::uint64_t seed, std::uint64_t index) {
  sim::Random random{seed * 1'000'003 + index};
  SweepCell cell;
  cell.seed = seed * 100'000 + index + 1;
  const double kind = random.uniform({0, 1});
  if (kind < 0.75) {
    cell.shoe.shoe_class = draw<sim::ShoeClass>(random, sim::k_first_designed, sim::k_first_thing);
    cell.shoe.decoy = draw<sim::Decoy>(random, 0, sim::k_decoy_names.size());
    cell.shoe.materials = random.chance(0.5) ? sim::Materials::OneColour : sim::Materials::Contrast;
  } else if (kind < 0.85) {
    cell.shoe.shoe_class = draw<sim::ShoeClass>(random, 0, sim::k_plain_classes);
  } else {
    cell.shoe.shoe_class = draw<sim::ShoeClass>(random, sim::k_first_thing, sim::k_shoe_class_names.size());
  }
  // Paint is drawn apart: shapes and faults stay what they were before there was any.
  cell.shoe.painted = sim::Random{seed * 1'000'033 + index}.chance(0.3);
  if (random.chance(0.6)) cell.fault = draw<CloudFault>(random, 1, k_cloud_fault_names.size());
  return cell;
}

void add_truth(SweepScan& scan, const sim::MadeShoe& shoe, const Eigen::Affine3d& T_base_shoe) {
  const std::vector<sim::TrueLinePoint> line = true_line_of(shoe);
  if (line.empty()) return;

  const Occupied occupied{scan.cloud};
  std::size_t plain = 0;
  for (const sim::TrueLinePoint& point : line) {
    scan.truth.points.push_back({.position = T_base_shoe * point.point_shoe,
                                 .normal = T_base_shoe.linear() * point.normal_shoe,
                                 .tangent = Vec3::Zero(),
                                 .confidence = 1});
    constexpr double k_least_deg = 10, k_flank_mm = 1.0;
    const sim::Section section = shoe.section(point.s_mm);
    const double z_mm = point.point_shoe.z();
    const auto seen = [&](double above_mm) {
      return occupied.near(T_base_shoe * section.point(z_mm + above_mm));
    };
    plain += turn_deg(section, z_mm) >= k_least_deg && seen(-k_flank_mm) && seen(k_flank_mm) ? 1U : 0U;
  }
  scan.plain_to_see = static_cast<double>(plain) >= 0.9 * static_cast<double>(line.size());
}

SweepScan scan_of(const SweepCell& cell) {
  const bool designed = sim::is_designed(cell.shoe.shoe_class);
  sim::ShoeParameters drawn = designed ? sim::draw_designed_shoe(cell.shoe, cell.seed)
                                       : sim::draw_shoe(cell.shoe.shoe_class, cell.seed);
  drawn.groove.step_mm *= cell.crease_ratio;
  drawn.groove.depth_mm *= cell.crease_ratio;
  if (cell.seam) drawn.upper.parallel_seams.push_back(*cell.seam);
  const sim::MadeShoe shoe{drawn};
  sim::Random random{cell.seed * 77 + 5};
  SE3 T_base_shoe = SE3::Identity();
  T_base_shoe.linear() =
      Eigen::AngleAxisd(random.uniform({-std::numbers::pi, std::numbers::pi}), Vec3::UnitZ())
          .toRotationMatrix();
  T_base_shoe.translation() =
      Vec3{random.uniform({200, 600}), random.uniform({-300, 300}), random.uniform({20, 80})};

  SweepScan made;
  const sim::ScannedCloud scan =
      sim::scan_quickly(shoe, {.seed = cell.seed, .stripe = cell.stripe}, T_base_shoe);
  made.cloud.points = scan.points;
  made.cloud.profile = scan.profile;
  made.cloud.column = scan.column;
  made.cloud.amplitude = scan.amplitude;
  made.cloud.width_px = scan.width_px;
  const std::vector<sim::TrueLinePoint> line = true_line_of(shoe);
  std::vector<Vec3> where;
  for (const sim::TrueLinePoint& point : line) where.push_back(T_base_shoe * point.point_shoe);
  if (where.empty()) {
    for (double s_mm = 0; s_mm < shoe.perimeter_mm(); s_mm += 1)
      where.push_back(T_base_shoe * shoe.section(s_mm).point(shoe.section(s_mm).bottom_z_mm()));
  }
  const Eigen::Affine3d moved = spoil(made.cloud, cell.fault, cell.seed, where);
  add_truth(made, shoe, moved * Eigen::Affine3d{T_base_shoe});
  return made;
}

SweepVerdict judge(const SweepScan& scan, const bite_line::Extraction& found) {
  constexpr double k_flagged = 0.5, k_flagged_u95_mm = 1.0, k_off_mm = 1.0, k_wrong_mm = 5.0;
  SweepVerdict verdict;
  const bool none = scan.truth.points.empty();
  if (!found.found) {
    verdict.judged = none ? Judged::Right : Judged::Refused;
    return verdict;
  }
  if (none) {
    verdict.judged = Judged::Wrong;
    verdict.wrong_mm = found.length_mm;
    return verdict;
  }
  const auto count = static_cast<double>(found.line.points.size());
  const double step_mm = cloud::length_mm(found.line) / count;
  double held = 0;
  for (const cloud::LinePoint& p : found.line.points) {
    if (!(p.confidence >= k_flagged) || p.u95_mm.value_or(0) > k_flagged_u95_mm) {
      verdict.flagged_share += 1 / count;
      continue;
    }
    const double off_mm = distance_mm(p.position, scan.truth);
    held += 1;
    verdict.mean_mm += off_mm;
    verdict.max_mm = std::max(verdict.max_mm, off_mm);
    if (off_mm > k_off_mm) verdict.wrong_mm += step_mm;
  }
  verdict.mean_mm /= std::max(held, 1.0);
  if (verdict.wrong_mm > k_wrong_mm) verdict.judged = Judged::Wrong;
  return verdict;
}

double upper_bound_95(int count, int of) {
  if (of <= 0 || count >= of) return 1;
  // P(at most `count` of `of`) falls with p: bisect for 5 %.
  const auto at_most = [&](double p) {
    double sum = 0;
    for (int k = 0; k <= count; ++k) {
      const double log_share = std::lgamma(of + 1.0) - std::lgamma(k + 1.0) - std::lgamma(of - k + 1.0) +
                               k * std::log(p) + (of - k) * std::log1p(-p);
      constexpr double k_nothing = -700;  // below it exp() underflows
      if (log_share > k_nothing) sum += std::exp(log_share);
    }
    return sum;
  };
  double low = static_cast<double>(count) / of, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (middle > 0 && middle < 1 && at_most(middle) < 0.05 ? high : low) = middle;
  }
  return high;
}

}  // namespace biteline::test
