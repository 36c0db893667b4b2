// SPDX-License-Identifier: MIT
#include "host/registration/alignment.hpp"

#include <tbb/parallel_invoke.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/contracts.hpp"
#include "common/core/fixed_text.hpp"
#include "host/registration/starts.hpp"
#include "host/registration/voxel_map.hpp"

namespace biteline::registration {
namespace {

constexpr float k_pitch_mm = 2;
constexpr float k_coarse_pitch_mm = 8;
// The groove and the sole's edge reach this far above the line; above it sample and upper are the same surface.
constexpr double k_groove_margin_mm = 5;
constexpr double k_fine_reach_mm = 5;
// Another model: the bound on the RMS difference of the common surface.
constexpr double k_max_shape_rms_mm = 0.2;
constexpr double k_max_graded_rms_mm = 0.3;  // sizes of one model differ besides by what grading describes
constexpr float k_patch_mm = 6;            // several stitches and threads: texture averages out, shape stays
constexpr std::size_t k_min_patch_surfels = 3;
constexpr double k_min_overlap_ratio = 0.6;
constexpr double k_hopeless_overlap_ratio = 0.4;    // so small a part fits in many places: nothing else can be said of it
constexpr double k_min_upper_overlap_ratio = 0.85;  // a partial scan of the right shoe lies wholly on the sample
constexpr double k_correlation_mm = 40;    // as in icp.cpp: lasts differ smoothly
constexpr double k_last_sigma_mm = 0.1;    // a last that seems to differ less from the next does so by chance
constexpr double k_rim_sigma_mm = 0.1;     // a collar's edge, as cut and scanned
constexpr double k_rim_pieces = 12;
constexpr double k_max_rim_mm = 0.25;      // rims that scatter more are not the same edge
constexpr double k_min_rim_overlap_ratio = 0.5;
constexpr double k_rim_reach_mm = 1.5;
constexpr double k_max_direction_sigma_mm = 0.5;  // beyond it the line misses its 0.35 mm at the 95th percentile
constexpr double k_max_size_change = 0.3;
constexpr std::size_t k_min_surfels = 300;  // 12 cm² at the fine pitch

double square(double value) { return value * value; }

/// The place of the closed line beside a point, seen from above.  Anticlockwise, so outward is to the right.
class LineBeside {
 public:
  explicit LineBeside(const std::vector<Vec3>& line) : line_{line} {}

  struct Place {
    double height_mm;
    Foot foot;
  };

  [[nodiscard]] Place at(const Vec3& point) const {
    std::size_t nearest = 0;
    double best = (line_.front() - point).head<2>().squaredNorm();
    for (std::size_t i = 1; i < line_.size(); ++i) {
      const double squared = (line_[i] - point).head<2>().squaredNorm();
      if (squared < best) {
        best = squared;
        nearest = i;
      }
    }
    const std::size_t before = nearest == 0 ? line_.size() - 1 : nearest - 1;
    const Vec3 on_before = on_segment(before, point), on_after = on_segment(nearest, point);
    const bool is_before = (on_before - point).head<2>().squaredNorm() < (on_after - point).head<2>().squaredNorm();
    const Vec3& place = is_before ? on_before : on_after;
    return {.height_mm = place.z(), .foot = {.place = place.head<2>().cast<float>(), .outward = outward_at(nearest)}};
  }

 private:
  [[nodiscard]] Eigen::Vector2f outward_at(std::size_t i) const {
    const Vec3 along = line_[(i + 1) % line_.size()] - line_[i == 0 ? line_.size() - 1 : i - 1];
    return Vec2{along.y(), -along.x()}.normalized().cast<float>();
  }

  [[nodiscard]] Vec3 on_segment(std::size_t i, const Vec3& point) const {
    const Vec3& a = line_[i];
    const Vec3 d = line_[(i + 1) % line_.size()] - a;
    const double squared = d.head<2>().squaredNorm();
    const double share = squared > 0 ? std::clamp((point - a).head<2>().dot(d.head<2>()) / squared, 0.0, 1.0) : 0;
    return a + share * d;
  }

  const std::vector<Vec3>& line_;
};

/// At most this many points stand for the line where only its height and course count: 3 mm apart on a shoe.
std::vector<Vec3> thinned(const std::vector<Vec3>& line) {
  constexpr std::size_t k_points = 250;
  const std::size_t step = std::max<std::size_t>(1, line.size() / k_points);
  std::vector<Vec3> thin;
  for (std::size_t i = 0; i < line.size(); i += step) thin.push_back(line[i]);
  return thin;
}

Rim moved(const Rim& rim, const SE3& T_to_from) {
  Rim out = rim;
  for (Eigen::Vector3f& p : out.positions) p = (T_to_from * p.cast<double>()).cast<float>();
  for (Eigen::Vector3f& v : out.across) v = (T_to_from.linear() * v.cast<double>()).cast<float>();
  return out;
}

Foot mirrored(const Foot& foot) {
  return {.place = {foot.place.x(), -foot.place.y()}, .outward = {foot.outward.x(), -foot.outward.y()}};
}

/// The sample as of the other foot.
Sample mirrored(const Sample& sample) {
  Sample other = sample;
  for (Surfels* surfels : {&other.common, &other.common_coarse}) {
    for (Eigen::Vector3f& p : surfels->positions) p.y() = -p.y();
    for (Eigen::Vector3f& n : surfels->normals) n.y() = -n.y();
    for (Foot& foot : surfels->feet) foot = mirrored(foot);
  }
  for (Eigen::Vector3f& p : other.rim.positions) p.y() = -p.y();
  for (Eigen::Vector3f& v : other.rim.across) v.y() = -v.y();
  for (Foot& foot : other.rim.feet) foot = mirrored(foot);
  for (Vec3& p : other.line_shoe) p.y() = -p.y();
  std::reverse(other.line_shoe.begin(), other.line_shoe.end());  // anticlockwise again
  return other;
}

IcpOptions fine_options(Freedom freedom) {
  return {.reach_mm = k_fine_reach_mm,
          .max_iterations = freedom == Freedom::Rigid ? 40 : 150,  // length, offset and section nearly stand for one another
          .freedom = freedom,
          .rim_reach_mm = k_rim_reach_mm};
}

struct Fit {
  IcpResult icp;
  bool rim_used{false};
};

/// Surface first; then with the rims, if those agree where the surface has put them.
Fit refine(const Sample& sample, const Upper& upper, const NearestTable& table, const Placement& start,
           const IcpOptions& options) {
  Surfaces surfaces{.source = sample.common, .target = upper.surfels, .target_table = table};
  Fit fit{.icp = run_icp(surfaces, start, options)};
  if (sample.rim.size() == 0 || upper.rim.size() == 0) return fit;
  surfaces.source_rim = &sample.rim;
  surfaces.target_rim = &upper.rim;
  const IcpResult with_rim = run_icp(surfaces, fit.icp.placement, options);
  if (with_rim.rim_overlap_ratio >= k_min_rim_overlap_ratio && with_rim.rim_mm <= k_max_rim_mm &&
      with_rim.overlap_ratio >= 0.98 * fit.icp.overlap_ratio) {
    fit = {.icp = with_rim, .rim_used = true};
  }
  return fit;
}

/// RMS of the patches' mean residuals: noise and texture average out in a patch, the difference of two shapes does not.
double shape_rms_mm(const Surfaces& surfaces, const std::vector<Pair>& pairs) {
  struct Patch {
    double sum{0};
    std::size_t count{0};
  };
  const VoxelGrid grid{k_patch_mm};
  VoxelMap voxels;
  std::vector<Patch> patches;
  for (const Pair& pair : pairs) {
    const std::uint32_t at = voxels.number(grid.key(surfaces.source.positions[pair.source]));
    if (at == patches.size()) patches.emplace_back();
    patches[at].sum += pair.residual_mm;
    patches[at].count += 1;
  }
  double sum = 0;
  std::size_t count = 0;
  for (const Patch& patch : patches) {
    if (patch.count < k_min_patch_surfels) continue;
    sum += square(patch.sum / static_cast<double>(patch.count)) * static_cast<double>(patch.count);
    count += patch.count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

/// Share of the upper's surfels, beside and above the line, that lie on the placed sample.
double upper_overlap_ratio(const Sample& sample, const Upper& upper, const Placement& placement) {
  Surfels graded = sample.common;
  for (std::size_t i = 0; i < graded.size(); ++i) {
    graded.positions[i] = placement.grade.apply(graded.positions[i].cast<double>(), graded.foot(i)).cast<float>();
  }
  const NearestTable table{graded, static_cast<float>(k_fine_reach_mm)};
  std::vector<Vec3> thin = thinned(sample.line_shoe);
  for (Vec3& p : thin) p = placement.grade.apply(p, Foot{.place = p.head<2>().cast<float>()});
  const LineBeside line{thin};
  const SE3 T_source_target = placement.T_target_source.inverse();
  std::size_t above = 0, paired = 0;
  for (const Eigen::Vector3f& position : upper.surfels_coarse.positions) {
    const Vec3 p = T_source_target * position.cast<double>();
    if (p.z() < line.at(p).height_mm + k_groove_margin_mm) continue;
    ++above;
    if (table.near(p.cast<float>()) != NearestTable::k_none) ++paired;
  }
  return above > 0 ? static_cast<double>(paired) / static_cast<double>(above) : 0;
}

const char* words_of(const Twist& direction, double arm_mm) {
  // The largest of six displacements at the shoe's end, each a thing that an operator can picture.
  static constexpr std::array<const char*, 6> k_words{"along the shoe",      "across the shoe",      "up and down",
                                                      "in roll (about its length)", "in pitch (heel against toe)",
                                                      "in yaw (about the vertical)"};
  Twist scaled = direction.cwiseAbs();
  scaled.tail<3>() *= arm_mm;
  Eigen::Index largest = 0;
  scaled.maxCoeff(&largest);
  return k_words[static_cast<std::size_t>(largest)];
}

/// From the information of independent pieces: covariance, the line's own uncertainty, the weakest direction.
void tell_uncertainty(const Sample& sample, const Fit& fit, Alignment& alignment) {
  const double piece_per_surfel = square(sample.common.pitch_mm / k_correlation_mm);
  const double sigma_mm = std::max(k_last_sigma_mm, alignment.shape_rms_mm);
  Information H = fit.icp.information * (piece_per_surfel / square(sigma_mm));
  if (fit.rim_used) {
    const double pairs = fit.icp.rim_overlap_ratio * static_cast<double>(sample.rim.size());
    H += fit.icp.rim_information * (k_rim_pieces / pairs / square(k_rim_sigma_mm));
  }
  alignment.information = H;

  // Rigid part only: what the line may move.  About the line's centre, where turning and shifting part.
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : sample.line_shoe) centre += p;
  centre /= static_cast<double>(sample.line_shoe.size());
  const Vec3 pivot = fit.icp.placement.grade.apply(centre, Foot{.place = centre.head<2>().cast<float>()});
  Eigen::Matrix<double, 6, 6> shift = Eigen::Matrix<double, 6, 6>::Identity();
  shift.topRightCorner<3, 3>() = geometry::hat(pivot);  // twist about the pivot -> twist about the frame's origin
  const Eigen::Matrix<double, 6, 6> about_pivot = shift.transpose() * H.topLeftCorner<6, 6>() * shift;

  double arm_squared = 0;
  for (const Vec3& p : sample.line_shoe) arm_squared += (p - centre).squaredNorm();
  const double arm_mm = std::sqrt(arm_squared / static_cast<double>(sample.line_shoe.size()));
  Eigen::Matrix<double, 6, 1> unit;
  unit << 1, 1, 1, 1 / arm_mm, 1 / arm_mm, 1 / arm_mm;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver{unit.asDiagonal() * about_pivot * unit.asDiagonal()};
  const Eigen::Matrix<double, 6, 1> variances = solver.eigenvalues().cwiseMax(1e-12).cwiseInverse();
  alignment.weakest = {.sigma_mm = std::sqrt(variances[0]),
                       .words = words_of(unit.asDiagonal() * solver.eigenvectors().col(0), arm_mm)};
  // Translation's share and half of each turning's (a point's arm is at right angles to two of three axes at most).
  const Eigen::Matrix<double, 6, 6> covariance =
      solver.eigenvectors() * variances.asDiagonal() * solver.eigenvectors().transpose();
  alignment.line_sigma_mm =
      std::sqrt(covariance.diagonal().head<3>().sum() + 2.0 / 3.0 * covariance.diagonal().tail<3>().sum());
}

Alignment describe(const Sample& sample, const Upper& upper, const NearestTable& table, const Fit& fit, Freedom freedom) {
  const IcpResult& icp = fit.icp;
  const Surfaces surfaces{.source = sample.common, .target = upper.surfels, .target_table = table};
  Alignment alignment{.placement = icp.placement,
                      .T_upper_sample = icp.placement.T_target_source * sample.T_base_shoe.inverse(),
                      .converged = icp.converged,
                      .iterations = icp.iterations,
                      .overlap_ratio = icp.overlap_ratio,
                      .residual_rms_mm = icp.rms_mm,
                      .rim_used = fit.rim_used,
                      .rim_mm = icp.rim_mm};
  const std::vector<Pair> pairs = find_pairs(surfaces, icp.placement, fine_options(freedom));
  alignment.shape_rms_mm = shape_rms_mm(surfaces, pairs);
  alignment.compared.reserve(pairs.size());
  for (const Pair& pair : pairs) {
    alignment.compared.push_back({.point = icp.placement.place(pair.point, pair.foot).cast<float>(),
                                  .difference_mm = static_cast<float>(pair.residual_mm)});
  }
  alignment.upper_overlap_ratio = upper_overlap_ratio(sample, upper, icp.placement);
  tell_uncertainty(sample, fit, alignment);
  return alignment;
}

/// Aligned, or what of the common surface itself forbids it; OtherModel stands for every difference of shape.
Verdict judge(const Alignment& alignment, Freedom freedom) {
  const double max_shape_rms_mm = freedom == Freedom::Rigid ? k_max_shape_rms_mm : k_max_graded_rms_mm;
  const bool upper_is_on_sample = alignment.upper_overlap_ratio >= k_min_upper_overlap_ratio;
  if (alignment.overlap_ratio < k_hopeless_overlap_ratio && upper_is_on_sample) return Verdict::TooLittleOverlap;
  if (alignment.shape_rms_mm >= max_shape_rms_mm || (alignment.overlap_ratio < k_min_overlap_ratio && !upper_is_on_sample)) {
    return Verdict::OtherModel;
  }
  if (alignment.weakest.sigma_mm > k_max_direction_sigma_mm) return Verdict::DirectionNotFixed;
  if (!alignment.converged) return Verdict::NotConverged;
  if (alignment.overlap_ratio < k_min_overlap_ratio) return Verdict::TooLittleOverlap;
  return Verdict::Aligned;
}

/// The best of the two best starts, refined.
Alignment best_alignment(const Sample& sample, const Upper& upper, const NearestTable& table, Freedom freedom) {
  constexpr std::size_t k_refined = 2;
  const std::vector<IcpResult> coarse = coarse_fits(sample, upper, freedom);
  std::vector<Fit> fits;
  for (std::size_t i = 0; i < std::min(k_refined, coarse.size()); ++i) {
    fits.push_back(refine(sample, upper, table, coarse[i].placement, fine_options(freedom)));
  }
  std::sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.icp.cost_mm2 < b.icp.cost_mm2; });
  Alignment alignment = describe(sample, upper, table, fits.front(), freedom);
  if (fits.size() > 1 && fits[1].icp.cost_mm2 > 0) {
    alignment.runner_up_ratio = fits[0].icp.cost_mm2 / fits[1].icp.cost_mm2;
  }
  alignment.verdict = judge(alignment, freedom);
  return alignment;
}

template <class... Arguments>
std::string sentence(const char* pattern, Arguments... arguments) {
  return FixedText<400>::format(pattern, arguments...).c_str();
}

/// Why the shapes differ: the other foot, another size, or another model.
void explain_difference(const Sample& sample, const Upper& upper, const NearestTable& table, Freedom freedom, Alignment& alignment) {
  const Alignment other_foot = best_alignment(mirrored(sample), upper, table, freedom);
  if (other_foot.accepted()) {
    alignment.verdict = Verdict::OtherFoot;
    alignment.reason = sentence(
        "the upper is of the other foot: mirrored, the sample fits to %.2f mm RMS, as it is only to %.2f mm",
        other_foot.shape_rms_mm, alignment.shape_rms_mm);
    return;
  }
  if (freedom == Freedom::Rigid) {
    const Alignment graded = best_alignment(sample, upper, table, Freedom::Graded);
    const Grade& grade = graded.placement.grade;
    if (graded.accepted() && grade.largest_change() < k_max_size_change) {
      alignment.verdict = Verdict::OtherSize;
      alignment.reason = sentence(
          "the upper is of another size: %.3f of the sample's length, %.3f of its width, %.3f of its height (grading is off)",
          grade.length, grade.width, grade.section);
      return;
    }
  }
  alignment.verdict = Verdict::OtherModel;
  alignment.reason = sentence(
      "the upper is another model: its surface differs from the sample's by %.2f mm RMS (at most %.2f mm) over %.0f %% of "
      "it, and neither mirroring nor another size explains it",
      alignment.shape_rms_mm, k_max_shape_rms_mm, 100 * alignment.overlap_ratio);
}

}  // namespace

Alignment::OnLine Alignment::placed(const OnLine& on_sample) const {
  const auto as_used = [&](const Vec3& v) { return mirrored ? Vec3{v.x(), -v.y(), v.z()} : v; };
  const Vec3 point = as_used(on_sample.point), normal = as_used(on_sample.normal);
  const Foot foot{.place = point.head<2>().cast<float>(), .outward = normal.head<2>().normalized().cast<float>()};
  return {.point = placement.place(point, foot), .normal = placement.place_normal(normal)};
}

Result<Sample> prepare_sample(const cloud::PointCloud& cloud, const line::ClosedLine& line) {
  BITELINE_EXPECTS(line.points.size() >= 3);
  const Surfels surfels = surfels_of(cloud.points, k_pitch_mm);
  if (surfels.size() < k_min_surfels) return fail(Errc::Refused, "the sample's cloud holds no surface of a shoe's size");
  Sample sample{.axes = shoe_axes(surfels)};
  sample.T_base_shoe = sample.axes.T_base_shoe;
  const SE3 T_shoe_base = sample.T_base_shoe.inverse();
  for (const line::LinePoint& p : line.points) sample.line_shoe.push_back(T_shoe_base * p.position);

  const std::vector<Vec3> thin = thinned(sample.line_shoe);
  const LineBeside line_beside{thin};
  sample.common.pitch_mm = surfels.pitch_mm;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Vec3 p = T_shoe_base * surfels.positions[i].cast<double>();
    const LineBeside::Place beside = line_beside.at(p);
    if (p.z() < beside.height_mm + k_groove_margin_mm) continue;
    sample.common.positions.push_back(p.cast<float>());
    sample.common.feet.push_back(beside.foot);
    sample.common.normals.push_back((T_shoe_base.linear() * surfels.normals[i].cast<double>()).cast<float>());
  }
  if (sample.common.size() < k_min_surfels) return fail(Errc::Refused, "next to nothing of the sample lies above its line");
  sample.common_coarse = coarsened(sample.common, k_coarse_pitch_mm);
  sample.rim = moved(rim_of(cloud.points, surfels), T_shoe_base);
  for (const Eigen::Vector3f& p : sample.rim.positions) {
    sample.rim.feet.push_back(line_beside.at(p.cast<double>()).foot);
  }
  return sample;
}

Result<Upper> prepare_upper(const cloud::PointCloud& cloud) {
  Upper upper{.surfels = surfels_of(cloud.points, k_pitch_mm)};
  if (upper.surfels.size() < k_min_surfels) return fail(Errc::Refused, "the upper's cloud holds no surface of a shoe's size");
  upper.axes = shoe_axes(upper.surfels);
  upper.surfels_coarse = coarsened(upper.surfels, k_coarse_pitch_mm);
  upper.rim = rim_of(cloud.points, upper.surfels);
  return upper;
}

Alignment align(const Sample& sample, const Upper& upper, const AlignOptions& options) {
  const NearestTable table{upper.surfels, static_cast<float>(k_fine_reach_mm)};
  const Freedom freedom = options.grade ? Freedom::Graded : Freedom::Rigid;
  const Sample used = options.mirror ? mirrored(sample) : sample;
  Alignment alignment = best_alignment(used, upper, table, freedom);
  alignment.mirrored = options.mirror;
  switch (alignment.verdict) {
    case Verdict::Aligned:
      break;
    case Verdict::TooLittleOverlap:
      alignment.reason = sentence("too little overlap: the upper's scan shows %.0f %% of the surface above the sample's line (at least %.0f %%)",
                                  100 * alignment.overlap_ratio, 100 * k_min_overlap_ratio);
      break;
    case Verdict::DirectionNotFixed:
      alignment.reason = sentence("the common surface does not fix the upper %s: it may be off by %.1f mm (at most %.1f mm)",
                                  alignment.weakest.words.c_str(), alignment.weakest.sigma_mm, k_max_direction_sigma_mm);
      break;
    case Verdict::NotConverged:
      alignment.reason = sentence("the alignment did not settle within %d steps", alignment.iterations);
      break;
    default:
      explain_difference(used, upper, table, freedom, alignment);
  }
  return alignment;
}

}  // namespace biteline::registration
