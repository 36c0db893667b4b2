// SPDX-License-Identifier: MIT
#include "host/bite_line/scan_points.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <tbb/parallel_for.h>

#include "common/profile/profile.hpp"

namespace biteline::bite_line {

namespace {

/// Ends of pieces of a cloud that threads work on, each at a profile's end; of one without profiles anywhere.
std::vector<std::size_t> pieces_of(const cloud::PointCloud& cloud) {
  constexpr std::size_t k_piece = 16384;
  const bool organised = cloud.profile.size() == cloud.size();
  std::vector<std::size_t> ends{0};
  while (ends.back() < cloud.size()) {
    std::size_t end = std::min(cloud.size(), ends.back() + k_piece);
    while (organised && end < cloud.size() && cloud.profile[end] == cloud.profile[end - 1]) ++end;
    ends.push_back(end);
  }
  return ends;
}

}  // namespace

Run run_from(std::span<const Eigen::Vector3f> points, std::size_t first) {
  constexpr float k_run_mm = 0.25F;
  const Eigen::Vector3f& start = points[first];
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  std::size_t end = first + 1;
  for (; end < points.size() && (points[end] - start).squaredNorm() < k_run_mm * k_run_mm; ++end)
    sum += points[end] - start;
  return {.mean = start + sum / static_cast<float>(end - first), .end = end};
}

RunLook look_of(const cloud::StripeSpan& stripe) {
  const auto log_mean = [&](std::span<const float> values) {
    float sum = 0, count = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!(values[i] > 0)) continue;
      if (!stripe.flags.empty() && (stripe.flags[i] & profile::k_point_second_exposure) != 0) continue;
      sum += values[i];
      count += 1;
    }
    return count > 0 ? std::log(sum / count) : RunLook::k_unknown;
  };
  return {.log_amplitude = log_mean(stripe.amplitude), .log_width = log_mean(stripe.width_px)};
}

PointRuns runs_of(const cloud::PointCloud& cloud) {
  // Of scans, also of those with missing parts, below a fiftieth; with one stray of 100 points a
  // twenty-fifth.
  constexpr std::size_t k_most_alone_of = 40;
  const bool organised = cloud.profile.size() == cloud.size();
  const auto profile_end = [&](std::size_t first, std::size_t piece_end) {
    if (!organised) return piece_end;
    std::size_t end = first + 1;
    while (end < piece_end && cloud.profile[end] == cloud.profile[first]) ++end;
    return end;
  };
  const std::vector<std::size_t> ends = pieces_of(cloud);
  const std::size_t pieces = ends.size() - 1;
  std::vector<PointRuns> found(pieces);
  std::vector<std::size_t> alone(pieces, 0);
  tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t piece) {
    for (std::size_t first = ends[piece]; first < ends[piece + 1];) {
      const std::span profile{cloud.points.data(), profile_end(first, ends[piece + 1])};
      while (first < profile.size()) {
        const Run run = run_from(profile, first);
        found[piece].means.push_back(run.mean);
        found[piece].first_point.push_back(static_cast<std::uint32_t>(first));
        alone[piece] += run.end == first + 1 ? 1 : 0;
        first = run.end;
      }
    }
  });
  std::vector<std::size_t> before{0};
  for (const PointRuns& runs : found) before.push_back(before.back() + runs.means.size());
  PointRuns all;
  const std::size_t all_alone = std::accumulate(alone.begin(), alone.end(), std::size_t{0});
  const bool has_looks = cloud.amplitude.size() == cloud.size();
  if (!organised && all_alone * k_most_alone_of > before.back()) {
    if (has_looks) {
      all.looks.resize(cloud.size());
      for (std::size_t i = 0; i < cloud.size(); ++i) all.looks[i] = look_of(cloud.stripe(i, 1));
    }
    return all;
  }
  if (has_looks) all.looks.resize(before.back());
  all.means.resize(before.back());
  all.first_point.resize(before.back());
  tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t piece) {
    std::ranges::copy(found[piece].means, all.means.data() + before[piece]);
    std::ranges::copy(found[piece].first_point, all.first_point.data() + before[piece]);
    for (std::size_t i = 0; has_looks && i < found[piece].means.size(); ++i) {
      const std::size_t first = found[piece].first_point[i];
      const std::size_t end =
          i + 1 < found[piece].means.size() ? found[piece].first_point[i + 1] : ends[piece + 1];
      all.looks[before[piece] + i] = look_of(cloud.stripe(first, end - first));
    }
  });
  return all;
}

Large<Eigen::Vector3f> points_behind(const ScanPoints& scan, const Shoe& shoe,
                                     std::span<const std::uint32_t> of_shoe) {
  constexpr std::size_t k_piece = 4096;
  const std::size_t pieces = (of_shoe.size() + k_piece - 1) / k_piece;
  const auto for_runs = [&](std::size_t piece, auto&& use) {
    for (std::size_t i = piece * k_piece; i < std::min(of_shoe.size(), (piece + 1) * k_piece); ++i)
      use(scan.run(shoe.index[of_shoe[i]]));
  };
  std::vector<std::size_t> first(pieces + 1, 0);
  tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t piece) {
    for_runs(piece, [&](std::span<const Eigen::Vector3f> run) { first[piece + 1] += run.size(); });
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  Large<Eigen::Vector3f> points;
  points.resize(first.back());
  const Eigen::Isometry3f T_shoe_base = shoe.T_base_shoe.inverse().cast<float>();
  tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t piece) {
    Eigen::Vector3f* to = points.data() + first[piece];
    for_runs(piece, [&](std::span<const Eigen::Vector3f> run) {
      for (const Eigen::Vector3f& p : run) *to++ = T_shoe_base * p;
    });
  });
  return points;
}

}  // namespace biteline::bite_line
