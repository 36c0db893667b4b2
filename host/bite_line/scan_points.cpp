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

struct PieceRuns {
  PooledVector<Eigen::Vector3f> means;
  PooledVector<std::uint32_t> first_point;
  std::size_t alone{0};  ///< runs of one
};

/// Of the points from `first` to `end`; `profile_end(i)`: where that of the i-th point ends.
template <class ProfileEnd>
PieceRuns runs_between(std::span<const Eigen::Vector3f> points, std::size_t first, std::size_t end,
                       ProfileEnd&& profile_end) {
  // Room for runs of one: arrays that grow would cost more than the runs themselves.
  PooledVector<Eigen::Vector3f> means(end - first);
  PooledVector<std::uint32_t> first_point(end - first);
  std::size_t runs = 0, alone = 0;
  while (first < end) {
    const std::span profile = points.first(profile_end(first));
    for (; first < profile.size(); ++runs) {
      const Run run = run_from(profile, first);
      means[runs] = run.mean;
      first_point[runs] = static_cast<std::uint32_t>(first);
      alone += run.end == first + 1 ? 1 : 0;
      first = run.end;
    }
  }
  return {.means = {means.data(), means.data() + runs},
          .first_point = {first_point.data(), first_point.data() + runs},
          .alone = alone};
}

}  // namespace

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
  std::vector<PieceRuns> found(pieces);
  tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t piece) {
    found[piece] = runs_between(cloud.points, ends[piece], ends[piece + 1],
                                [&](std::size_t first) { return profile_end(first, ends[piece + 1]); });
  });
  std::vector<std::size_t> before{0};
  std::size_t all_alone = 0;
  for (const PieceRuns& runs : found) {
    before.push_back(before.back() + runs.means.size());
    all_alone += runs.alone;
  }
  PointRuns all;
  all.in_scan_order = organised;
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

PooledVector<Eigen::Vector3f> points_behind(const ScanPoints& scan, const Shoe& shoe,
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
  PooledVector<Eigen::Vector3f> points;
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
