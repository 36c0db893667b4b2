// SPDX-License-Identifier: MIT
#include "host/transfer/carry/carried_line.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/core/contracts.hpp"
#include "common/core/fixed_text.hpp"
#include "host/geometry/bridge.hpp"
#include "host/geometry/closed_curve.hpp"
#include "host/geometry/robust.hpp"
#include "host/geometry/strays.hpp"

namespace biteline::transfer {
namespace {

constexpr double k_spike_window_mm = 6;  // a wall does not jump within so short a way
constexpr double k_spike_mm = 1.5;
constexpr double k_normal_window_mm = 1.5;  // along the line, to both sides: stitches are 3 mm apart
constexpr double k_min_patch_mm =
    0.6;  // hits of a patch scatter at least so much across its short side (4 mm high: 1.4)
constexpr int k_normal_heights = 10;  // 0.5 mm apart: a thread or a stitch is not stepped over
// How far a bridged place is off, per mm of its gap: along the sample's wall; on a straight way where that
// was not seen.
constexpr double k_bridge_sigma_per_mm = 0.005, k_straight_sigma_per_mm = 0.04;

constexpr double k_min_hit_ratio = 0.6;  // with less, what is bridged was not seen on the upper at all

/// One place of the line and what its ray met.
struct Cast {
  Vec3 origin, direction;
  std::optional<double> distance_mm;
  bool bridged{false};
  double placed_sigma_mm{0}, bridge_sigma_mm{0}, sample_u95_mm{0};
  double confidence{1};
  std::optional<double> wall_mm;

  [[nodiscard]] Vec3 position() const { return origin + *distance_mm * direction; }
};

std::vector<Cast> cast_all(const RaySurface& surface, const std::vector<PlacedPoint>& placed,
                           const CarryOptions& options) {
  std::vector<Cast> casts(placed.size());
  tbb::parallel_for(std::size_t{0}, placed.size(), [&](std::size_t i) {
    Cast& cast = casts[i];
    cast = {.origin = placed[i].position,
            .direction = ray_direction(placed[i], options),
            .distance_mm = std::nullopt,
            .placed_sigma_mm = placed[i].sigma_mm,
            .sample_u95_mm = placed[i].sample_u95_mm,
            .confidence = placed[i].confidence,
            .wall_mm = placed[i].wall_mm};
    const std::optional<Hit> hit =
        surface.cast({.origin = cast.origin, .direction = cast.direction, .reach_mm = options.reach_mm});
    if (hit) cast.distance_mm = hit->distance_mm;
  });
  return casts;
}

double spacing_mm(const std::vector<PlacedPoint>& placed) {
  const geometry::ArcLength along{placed.size(), [&](std::size_t i) { return placed[i].position; }};
  return along.total_mm() / static_cast<double>(placed.size());
}

std::vector<std::uint8_t> hits_of(const std::vector<Cast>& casts) {
  std::vector<std::uint8_t> hits;
  for (const Cast& cast : casts) hits.push_back(cast.distance_mm ? 1 : 0);
  return hits;
}

/// A hit far from the median of those beside it is on something else: a lace, a thumb.  It becomes a gap.
void drop_spikes(std::vector<Cast>& casts, double step_mm) {
  std::vector<double> distances_mm;
  for (const Cast& cast : casts) distances_mm.push_back(cast.distance_mm.value_or(0));
  const geometry::SpikeLimits limits{
      .beside = static_cast<std::size_t>(std::ceil(k_spike_window_mm / step_mm)), .most = k_spike_mm};
  for (const std::size_t i : geometry::spikes_of(distances_mm, hits_of(casts), limits))
    casts[i].distance_mm.reset();
}

std::vector<geometry::Gap> gaps_of(const std::vector<Cast>& casts) {
  return geometry::gaps_of(hits_of(casts));
}

/// Way from the last hit before it to the first behind it.
double way_mm(const std::vector<Cast>& casts, const geometry::Gap& gap) {
  double way_mm = 0;
  for (std::size_t i = gap.first; i < gap.first + gap.steps; ++i)
    way_mm += (casts[(i + 1) % casts.size()].origin - casts[i % casts.size()].origin).norm();
  return way_mm;
}

/// What is interpolated over a gap: the distance to the wall beyond that of the sample's own wall, which runs
/// beside it on both shoes, or the bare distance where the sample's wall was not seen either.
class Bridge {
 public:
  Bridge(const std::vector<Cast>& casts, const geometry::Gap& gap) : casts_{casts} {
    for (std::size_t j = 0; j <= gap.steps; ++j) guided_ = guided_ && at(gap.first + j).wall_mm.has_value();
    before_mm_ = end_mm(gap.first, casts.size() - 1);
    after_mm_ = end_mm(gap.first + gap.steps, 1);
  }

  [[nodiscard]] bool guided() const { return guided_; }
  [[nodiscard]] double distance_mm(const Cast& cast, double share) const {
    return (1 - share) * before_mm_ + share * after_mm_ + (guided_ ? *cast.wall_mm : 0);
  }

 private:
  [[nodiscard]] const Cast& at(std::size_t i) const { return casts_[i % casts_.size()]; }

  /// Mean of the hits next to the gap: a stitch or a speck at its edge is not carried across.
  [[nodiscard]] double end_mm(std::size_t from, std::size_t step) const {
    constexpr std::size_t k_hits = 6;
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < k_hits; ++k) {
      const Cast& cast = at(from + k * step);
      if (!cast.distance_mm || cast.bridged || (guided_ && !cast.wall_mm)) break;
      sum += *cast.distance_mm - (guided_ ? *cast.wall_mm : 0);
      count += 1;
    }
    return sum / count;  // the gap's own end is always among them
  }

  const std::vector<Cast>& casts_;
  bool guided_{true};
  double before_mm_{0}, after_mm_{0};
};

/// Fills gaps between two hits.  Returns the longest in mm.
double bridge_gaps(std::vector<Cast>& casts, const CarryOptions& options) {
  double longest_mm = 0;
  for (const geometry::Gap& gap : gaps_of(casts)) {
    const double gap_mm = way_mm(casts, gap);
    longest_mm = std::max(longest_mm, gap_mm);
    if (gap_mm > options.max_gap_mm) continue;
    const Bridge bridge{casts, gap};
    for (std::size_t j = 1; j < gap.steps; ++j) {
      Cast& cast = casts[(gap.first + j) % casts.size()];
      cast.distance_mm = bridge.distance_mm(cast, static_cast<double>(j) / static_cast<double>(gap.steps));
      cast.bridged = true;
      cast.bridge_sigma_mm = gap_mm * (bridge.guided() ? k_bridge_sigma_per_mm : k_straight_sigma_per_mm);
    }
  }
  return longest_mm;
}

bool clockwise(const std::vector<Vec3>& points, const Vec3& up) {
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    area += (points[i] - points[0]).cross(points[(i + 1) % points.size()] - points[0]);
  }
  return area.dot(up) < 0;
}

/// Hits on the wall above each point of the line, from which its normals come.
using Column = std::array<std::optional<Vec3>, k_normal_heights>;

std::vector<Column> cast_above(const RaySurface& surface, const std::vector<Vec3>& origins,
                               const std::vector<Vec3>& directions, const CarryOptions& options) {
  std::vector<Column> columns(origins.size());
  tbb::parallel_for(std::size_t{0}, origins.size(), [&](std::size_t i) {
    for (int k = 0; k < k_normal_heights; ++k) {
      // Half a step beyond both ends, so that each end lies between two.
      const double step_mm = (options.normal_high_mm - options.normal_low_mm) / (k_normal_heights - 2);
      const double height_mm = options.normal_low_mm + step_mm * (k - 0.5);
      const std::optional<Hit> hit = surface.cast({.origin = origins[i] + height_mm * options.up,
                                                   .direction = directions[i],
                                                   .reach_mm = options.reach_mm / 2});
      if (hit) columns[i][static_cast<std::size_t>(k)] = hit->position;
    }
  });
  return columns;
}

/// Least-squares plane of the hits above the neighbouring points; none where they are too few or on one line.
std::optional<Vec3> plane_normal(const std::vector<Column>& columns, std::size_t at, std::ptrdiff_t half,
                                 const Vec3& outward) {
  std::vector<Vec3> found;
  const auto size = static_cast<std::ptrdiff_t>(columns.size());
  for (std::ptrdiff_t k = -half; k <= half; ++k) {
    const auto i = static_cast<std::size_t>(((static_cast<std::ptrdiff_t>(at) + k) % size + size) % size);
    for (const std::optional<Vec3>& hit : columns[i]) {
      if (hit) found.push_back(*hit);
    }
  }
  constexpr std::size_t k_enough = 6;
  if (found.size() < k_enough) return std::nullopt;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : found) mean += p / static_cast<double>(found.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& p : found) covariance += (p - mean) * (p - mean).transpose();
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(covariance / static_cast<double>(found.size()));
  if (solver.eigenvalues()[1] < k_min_patch_mm * k_min_patch_mm) return std::nullopt;
  const Vec3 normal = solver.eigenvectors().col(0).normalized();
  if (std::abs(normal.dot(outward)) < k_min_facing_cosine) return std::nullopt;
  return normal.dot(outward) >= 0 ? normal : Vec3{-normal};
}

/// The mean of the surface's normals between the two heights, where its section and those beside it are seen.
/// Up the section slopes add up to the difference of the ends, so that a stitch counts with just what it
/// adds.  Along the line the difference (12, -3) / 12 steps undoes, to fourth order, its own blur and that of
/// a mesh whose profiles lie two steps of the line apart: of a stitch 0.5 mm wide the usual one loses a
/// third.  None where something is missing.
std::optional<Vec3> section_normal(const std::vector<Column>& columns, std::size_t at, const Vec3& outward) {
  const std::size_t n = columns.size();
  const auto beside = [&](std::size_t steps) -> const Column& { return columns[(at + n + steps) % n]; };
  const Column &here = columns[at], &before = beside(n - 1), &after = beside(1), &far_before = beside(n - 2),
               &far_after = beside(2);
  Vec3 along = Vec3::Zero();
  for (std::size_t k = 0; k < here.size(); ++k) {
    if (!far_before[k] || !before[k] || !here[k] || !after[k] || !far_after[k]) return std::nullopt;
    along += 12 * (*after[k] - *before[k]) - 3 * (*far_after[k] - *far_before[k]);
  }
  const Vec3 rise = *here[k_normal_heights - 1] + *here[k_normal_heights - 2] - *here[0] - *here[1];
  const Vec3 normal = along.cross(rise).normalized();
  if (std::abs(normal.dot(outward)) < k_min_facing_cosine) return std::nullopt;
  return normal.dot(outward) >= 0 ? normal : Vec3{-normal};
}

/// The ray's own directions: outward, along the line, upwards.
Mat3 ray_frame(const Vec3& outward, const Vec3& up) {
  Mat3 frame;
  frame.col(0) = outward;
  frame.col(1) = up.cross(outward).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

/// Where there is no normal, that of the nearest places before and behind, weighted by nearness and turned as
/// the rays turn; `outward` if none has.
std::vector<Vec3> filled(const std::vector<std::optional<Vec3>>& normals, const std::vector<Vec3>& outward,
                         const Vec3& up) {
  const std::size_t size = normals.size();
  std::vector<Vec3> out(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (normals[i]) {
      out[i] = *normals[i];
      continue;
    }
    std::size_t behind = 1, before = 1;
    while (behind < size && !normals[(i + size - behind) % size]) ++behind;
    while (before < size && !normals[(i + before) % size]) ++before;
    if (behind == size) {
      out[i] = outward[i];
      continue;
    }
    const auto in_rays = [&](std::size_t at) {
      return Vec3{ray_frame(outward[at], up).transpose() * *normals[at]};
    };
    const Vec3 blended = static_cast<double>(before) * in_rays((i + size - behind) % size) +
                         static_cast<double>(behind) * in_rays((i + before) % size);
    out[i] = (ray_frame(outward[i], up) * blended).normalized();
  }
  return out;
}

double chance_within(double distance_mm, double sigma_mm) {
  return std::erf(distance_mm / (std::sqrt(2.0) * sigma_mm));
}

/// How far a point is off, 19 times of 20, in standard deviations.
constexpr double k_u95_sigmas = 1.96;

/// Standard deviation of the hits about the wall that they lie on, from second differences: noise and weave.
double roughness_mm(const std::vector<Cast>& casts) {
  std::vector<double> bends_mm;
  const std::size_t size = casts.size();
  for (std::size_t i = 0; i < size; ++i) {
    const Cast &before = casts[(i + size - 1) % size], &here = casts[i], &after = casts[(i + 1) % size];
    if (before.bridged || here.bridged || after.bridged) continue;
    bends_mm.push_back(std::abs(*before.distance_mm - 2 * *here.distance_mm + *after.distance_mm));
  }
  if (bends_mm.empty()) return 0;
  return geometry::k_sigma_per_mad * geometry::median_of(std::span<double>{bends_mm}) / std::sqrt(6.0);
}

/// The hits as an evenly spaced closed line with normals and tangents.
void resample(const RaySurface& surface, const std::vector<Cast>& casts, double step_mm,
              const CarryOptions& options, CarriedLine& carried) {
  std::vector<Vec3> positions;
  for (const Cast& cast : casts) positions.push_back(cast.position());
  const geometry::ArcLength way{positions.size(), [&](std::size_t i) { return positions[i]; }};
  const double rough_mm = roughness_mm(casts);
  const auto count =
      std::max<std::size_t>(3, static_cast<std::size_t>(std::lround(way.total_mm() / step_mm)));
  const double even_mm = way.total_mm() / static_cast<double>(count);

  std::vector<Vec3> origins, directions;
  for (std::size_t i = 0; i < count; ++i) {
    const geometry::OnCurve place = way.even(i, count);
    const Cast &before = casts[place.before], &after = casts[place.after];
    const Cast& nearer = place.share < 0.5 ? before : after;
    const double sigma_mm = std::hypot(nearer.placed_sigma_mm, nearer.bridge_sigma_mm, rough_mm);
    origins.push_back(place.between(positions[place.before], positions[place.after]));
    directions.push_back(place.between(before.direction, after.direction).normalized());
    carried.line.points.push_back(
        {.position = origins.back(),
         .normal = directions.back(),
         .tangent = Vec3::Zero(),
         .confidence = nearer.confidence * chance_within(cloud::k_right_mm, sigma_mm),
         .u95_mm = std::hypot(k_u95_sigmas * sigma_mm, nearer.sample_u95_mm),
         .source = nearer.bridged ? cloud::PointSource::Bridged : cloud::PointSource::Carried});
    cloud::flag_unsure(carried.line.points.back());
    carried.bridged.push_back(nearer.bridged);
    if (nearer.bridged) carried.bridged_mm += even_mm;
  }
  const std::vector<Column> columns = cast_above(surface, origins, directions, options);
  const auto half = std::max<std::ptrdiff_t>(1, std::lround(k_normal_window_mm / even_mm));
  std::vector<std::optional<Vec3>> normals(count);
  for (std::size_t i = 0; i < count; ++i) {
    normals[i] = section_normal(columns, i, directions[i]);
    if (!normals[i]) normals[i] = plane_normal(columns, i, half, directions[i]);
  }
  const std::vector<Vec3> all_normals = filled(normals, directions, options.up);
  for (std::size_t i = 0; i < count; ++i) {
    cloud::LinePoint& point = carried.line.points[i];
    point.normal = all_normals[i];
    point.tangent = (origins[(i + 1) % count] - origins[(i + count - 1) % count]).normalized();
  }
}

}  // namespace

Vec3 ray_direction(const PlacedPoint& point, const CarryOptions& options) {
  if (options.direction == RayDirection::Normal) return point.normal;
  return (point.normal - point.normal.dot(options.up) * options.up).normalized();
}

bool all_met(const RaySurface& surface, const std::vector<PlacedPoint>& placed, const CarryOptions& options) {
  BITELINE_EXPECTS(placed.size() >= 3);
  std::vector<Cast> casts = cast_all(surface, placed, options);
  drop_spikes(casts, spacing_mm(placed));
  return std::all_of(casts.begin(), casts.end(),
                     [](const Cast& cast) { return cast.distance_mm.has_value(); });
}

CarriedLine carry_line(const RaySurface& surface, const std::vector<PlacedPoint>& placed,
                       const CarryOptions& options) {
  BITELINE_EXPECTS(placed.size() >= 3);
  const double step_mm = spacing_mm(placed);
  std::vector<Cast> casts = cast_all(surface, placed, options);
  drop_spikes(casts, step_mm);

  CarriedLine carried{.rays = casts.size()};
  double sum_mm = 0;
  for (const Cast& cast : casts) {
    if (!cast.distance_mm) continue;
    ++carried.hits;
    sum_mm += *cast.distance_mm;
  }
  if (carried.hits == 0) {
    carried.refusal =
        Refusal{.code = Refused::LineNotMet, .reason = "no ray from the sample's line meets the upper"};
    return carried;
  }
  const double hit_ratio = static_cast<double>(carried.hits) / static_cast<double>(carried.rays);
  if (hit_ratio < k_min_hit_ratio) {
    carried.refusal = Refusal{
        .code = Refused::LineHardlySeen,
        .reason = FixedText<200>::format("the upper's scan shows only %.0f %% of the line (at least %.0f %%)",
                                         100 * hit_ratio, 100 * k_min_hit_ratio)
                      .c_str()};
    return carried;
  }
  carried.mean_distance_mm = sum_mm / static_cast<double>(carried.hits);
  carried.longest_gap_mm = bridge_gaps(casts, options);
  if (carried.longest_gap_mm > options.max_gap_mm) {
    const auto gap = std::find_if(casts.begin(), casts.end(), [](const Cast& c) { return !c.distance_mm; });
    const Vec3 at = gap->origin;
    carried.refusal =
        Refusal{.code = Refused::ScanHasGap,
                .reason = FixedText<200>::format(
                              "the upper's scan has a gap of %.0f mm on the line, at x %.0f y %.0f z %.0f mm "
                              "(at most %.0f mm are bridged)",
                              carried.longest_gap_mm, at.x(), at.y(), at.z(), options.max_gap_mm)
                              .c_str()};
    return carried;
  }
  std::vector<Vec3> positions;
  for (const Cast& cast : casts) positions.push_back(cast.position());
  if (clockwise(positions, options.up)) std::reverse(casts.begin(), casts.end());
  resample(surface, casts, step_mm, options, carried);
  return carried;
}

}  // namespace biteline::transfer
