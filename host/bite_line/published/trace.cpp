// SPDX-License-Identifier: MIT
#include "host/bite_line/published/trace.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/fixed_text.hpp"

namespace biteline::published {

namespace {

using bite_line::Refused;

/// Weighted scatter of points in the plane, and what PCA makes of it.
struct Spread {
  Vec2 direction{Vec2::UnitX()};  ///< main axis, towards +column
  double main_ratio{1.0};         ///< larger eigenvalue over the sum
};

Spread spread_of(const std::vector<Vec2>& points, const std::vector<double>& weights) {
  Vec2 mean = Vec2::Zero();
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    mean += weights[i] * points[i];
    total += weights[i];
  }
  mean /= std::max(total, 1e-12);
  double xx = 1e-9;
  double yy = 1e-9;
  double xy = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 d = points[i] - mean;
    xx += weights[i] * d.x() * d.x();
    yy += weights[i] * d.y() * d.y();
    xy += weights[i] * d.x() * d.y();
  }
  const double half = 0.5 * (xx - yy);
  const double root = std::hypot(half, xy);
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  Spread spread;
  spread.direction = {std::cos(angle), std::sin(angle)};
  if (spread.direction.x() < 0) spread.direction = -spread.direction;
  spread.main_ratio = (0.5 * (xx + yy) + root) / (xx + yy);
  return spread;
}

class Tracer {
 public:
  Tracer(const Unrolled& picture, const TraceConfig& config)
      : picture_{picture}, config_{config}, used_(picture.value.size(), 0) {}

  std::vector<Segment> run() {
    std::vector<Segment> segments;
    for (int col = 0; col < picture_.cols; ++col) {
      for (int row = 0; row < picture_.rows; ++row) {
        if (!free_feature(row, col)) continue;
        Segment seed{Vec2{static_cast<double>(col), static_cast<double>(row)}};
        // A fork hands its far end on as the next seed, until a segment ends for want of pixels.
        while (!seed.empty()) {
          Segment segment = std::move(seed);
          seed = grow(segment);
          segments.push_back(std::move(segment));
        }
      }
    }
    return segments;
  }

 private:
  [[nodiscard]] bool free_feature(int row, int col) const {
    if (row < 0 || row >= picture_.rows || col < 0 || col >= picture_.cols) return false;
    const std::size_t pixel = picture_.at(row, col);
    return used_[pixel] == 0 && picture_.value[pixel] < -config_.strong_per_mm;
  }

  /// The groove is several pixels thick: those beside an appended one are used up with it.
  void use(const Vec2& point) {
    const int col = static_cast<int>(point.x());
    const int row = static_cast<int>(point.y());
    for (int r = std::max(0, row - 2); r <= std::min(picture_.rows - 1, row + 2); ++r)
      used_[picture_.at(r, col)] = 1;
  }

  /// Grows to the right; returns the seed of the next segment when it ended at a fork.
  Segment grow(Segment& segment) {
    for (const Vec2& point : segment) use(point);
    for (;;) {
      const std::size_t last = std::min(segment.size(), static_cast<std::size_t>(config_.last_points));
      const std::vector<Vec2> tail(segment.end() - static_cast<std::ptrdiff_t>(last), segment.end());
      const Vec2 ahead =
          last < 3 ? Vec2{1.0, 0.0} : spread_of(tail, std::vector<double>(last, 1.0)).direction;
      std::vector<Vec2> points;
      std::vector<double> weights;
      look_ahead(segment.back(), ahead, points, weights);
      if (points.empty()) return {};
      const Spread spread = spread_of(points, weights);
      if (points.size() >= 4 && spread.main_ratio < config_.fork_ratio) {
        std::sort(points.begin(), points.end(),
                  [&](const Vec2& a, const Vec2& b) { return a.dot(ahead) < b.dot(ahead); });
        return {points.back()};
      }
      const auto nearest = std::min_element(points.begin(), points.end(), [&](const Vec2& a, const Vec2& b) {
        return (a - segment.back()).squaredNorm() < (b - segment.back()).squaredNorm();
      });
      segment.push_back(*nearest);
      use(segment.back());
    }
  }

  void look_ahead(const Vec2& from, const Vec2& ahead, std::vector<Vec2>& points,
                  std::vector<double>& weights) const {
    const double length = config_.rectangle_px;
    const double half_width = config_.rectangle_px / 6.0;
    const Vec2 aside{-ahead.y(), ahead.x()};
    const int reach = static_cast<int>(std::ceil(length));
    for (int col = static_cast<int>(from.x()) + 1; col <= static_cast<int>(from.x()) + reach; ++col) {
      for (int row = static_cast<int>(from.y()) - reach; row <= static_cast<int>(from.y()) + reach; ++row) {
        if (!free_feature(row, col)) continue;
        const Vec2 point{static_cast<double>(col), static_cast<double>(row)};
        const Vec2 d = point - from;
        if (d.dot(ahead) <= 0 || d.dot(ahead) > length || std::abs(d.dot(aside)) > half_width) continue;
        points.push_back(point);
        weights.push_back(static_cast<double>(-picture_.value[picture_.at(row, col)]));
      }
    }
  }

  const Unrolled& picture_;
  const TraceConfig& config_;
  std::vector<std::uint8_t> used_;
};

Vec2 direction_at(const Segment& segment, bool front) {
  const std::size_t count = std::min<std::size_t>(segment.size(), 12);
  const Segment part = front ? Segment(segment.begin(), segment.begin() + static_cast<std::ptrdiff_t>(count))
                             : Segment(segment.end() - static_cast<std::ptrdiff_t>(count), segment.end());
  return spread_of(part, std::vector<double>(count, 1.0)).direction;
}

}  // namespace

std::vector<Segment> trace_segments(const Unrolled& picture, const TraceConfig& config) {
  std::vector<Segment> segments = Tracer{picture, config}.run();
  std::erase_if(segments,
                [&](const Segment& s) { return s.back().x() - s.front().x() + 1 < config.shortest_px; });
  std::sort(segments.begin(), segments.end(),
            [](const Segment& a, const Segment& b) { return a.front().x() < b.front().x(); });
  return segments;
}

TracedLine join_segments(const Unrolled& picture, const std::vector<Segment>& segments,
                         const TraceConfig& config) {
  TracedLine line;
  line.path_row.assign(static_cast<std::size_t>(picture.cols), -1.0F);
  if (segments.empty()) {
    line.refusal = bite_line::Refusal{Refused::NoCrease, "no crease: no concave line was traced"};
    return line;
  }
  // Longest chain, left to right: the traced length up to and with each segment.
  std::vector<double> length(segments.size());
  std::vector<std::ptrdiff_t> before(segments.size(), -1);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const double own = segments[i].back().x() - segments[i].front().x() + 1;
    length[i] = own;
    for (std::size_t j = 0; j < i; ++j) {
      const Vec2 gap = segments[i].front() - segments[j].back();
      if (gap.x() <= 0 || gap.x() > config.longest_gap_px || std::abs(gap.y()) > 3 + 0.5 * gap.x()) continue;
      if (direction_at(segments[j], false).dot(direction_at(segments[i], true)) < config.join_cosine)
        continue;
      if (length[j] + own <= length[i]) continue;
      length[i] = length[j] + own;
      before[i] = static_cast<std::ptrdiff_t>(j);
    }
  }
  std::vector<Vec2> points;
  auto k = std::max_element(length.begin(), length.end()) - length.begin();
  line.covered_ratio = length[static_cast<std::size_t>(k)] / picture.cols;
  for (; k >= 0; k = before[static_cast<std::size_t>(k)]) {
    const Segment& segment = segments[static_cast<std::size_t>(k)];
    points.insert(points.begin(), segment.begin(), segment.end());
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2& a = points[i];
    const Vec2& b = points[std::min(i + 1, points.size() - 1)];
    for (int col = static_cast<int>(a.x()); col <= static_cast<int>(b.x()); ++col) {
      const double share = b.x() > a.x() ? (col - a.x()) / (b.x() - a.x()) : 0.0;
      line.path_row[static_cast<std::size_t>(col)] = static_cast<float>(a.y() + share * (b.y() - a.y()));
    }
  }
  const double span = points.back().x() - points.front().x() + 1;
  line.closure_mm = std::abs(points.back().y() - points.front().y()) * picture.row_mm;
  if (span < config.whole_ratio * picture.cols) {
    line.refusal = bite_line::Refusal{
        Refused::NoCreaseAllRound,
        FixedText<160>::format(
            "no crease all the way round: the longest traced line runs from %.0f to %.0f of %.0f mm",
            points.front().x() * picture.col_mm, points.back().x() * picture.col_mm,
            picture.cols * picture.col_mm)
            .c_str()};
  } else if (line.closure_mm > config.closure_mm) {
    line.refusal = bite_line::Refusal{
        Refused::DoesNotClose,
        FixedText<160>::format("the traced line does not close: its ends lie %.1f mm apart in height",
                               line.closure_mm)
            .c_str()};
  } else {
    // The ends meet across the seam.
    for (int col = 0; col < static_cast<int>(points.front().x()); ++col)
      line.path_row[static_cast<std::size_t>(col)] = static_cast<float>(points.front().y());
    for (int col = static_cast<int>(points.back().x()); col < picture.cols; ++col)
      line.path_row[static_cast<std::size_t>(col)] = static_cast<float>(points.back().y());
  }
  return line;
}

}  // namespace biteline::published
