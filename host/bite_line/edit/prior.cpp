// SPDX-License-Identifier: MIT
#include "host/bite_line/edit/prior.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "host/bite_line/edit/splice.hpp"

namespace biteline::edit {
namespace {

using cloud::ClosedLine;
using cloud::LinePoint;

/// The place of a closed line that is nearest, on the chords beside its nearest point.
Vec3 nearest_place(const ClosedLine& line, std::size_t nearest, const Vec3& wanted) {
  const std::size_t count = line.points.size();
  Vec3 best = line.points[nearest].position;
  for (const std::size_t from : {(nearest + count - 1) % count, nearest}) {
    const Vec3& a = line.points[from].position;
    const Vec3 chord = line.points[(from + 1) % count].position - a;
    const double length2 = chord.squaredNorm();
    if (!(length2 > 0)) continue;
    const Vec3 place = a + std::clamp((wanted - a).dot(chord) / length2, 0.0, 1.0) * chord;
    if ((place - wanted).squaredNorm() < (best - wanted).squaredNorm()) best = place;
  }
  return best;
}

/// Mean over the columns, in mm of height.
double apart_mm(std::span<const double> row, std::span<const int> prior, double row_mm) {
  double sum = 0;
  for (std::size_t col = 0; col < row.size(); ++col) sum += std::abs(row[col] - prior[col]) * row_mm;
  return sum / static_cast<double>(row.size());
}

}  // namespace

bool is_mended(const ClosedLine& line) {
  return std::ranges::any_of(
      line.points, [](const LinePoint& point) { return point.source == cloud::PointSource::Mended; });
}

OffPrior off_prior(const ClosedLine& line, const ClosedLine& prior, double placed_sigma_mm) {
  constexpr double k_95 = 1.96;
  OffPrior off;
  const double spacing_mm = cloud::length_mm(prior) / static_cast<double>(prior.points.size());
  for (const LinePoint& wanted : prior.points) {
    const std::size_t nearest = nearest_index(line, wanted.position);
    const Vec3 place = nearest_place(line, nearest, wanted.position);
    const double apart = (place - wanted.position).norm();
    const double own_mm = line.points[nearest].u95_mm.value_or(0);
    const double u95_mm = std::sqrt(own_mm * own_mm + std::pow(wanted.u95_mm.value_or(0), 2) +
                                    std::pow(k_95 * placed_sigma_mm, 2));
    off.mean_mm += apart / static_cast<double>(prior.points.size());
    if (apart > u95_mm) off.beyond_mm += spacing_mm;
    if (apart <= off.most_mm) continue;
    off.most_mm = apart;
    off.most_at = place;
    off.u95_mm = u95_mm;
  }
  return off;
}

int nearest_candidate(const Surface& surface, const ClosedLine& prior) {
  const std::vector<int> wanted = surface.rows_of(prior);
  const std::vector<bite_line::JudgedPath>& paths = surface.decision().paths;
  int best = 1;
  double best_mm = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < paths.size(); ++k) {
    if (k > 0 && !paths[k].passes) continue;
    const double apart = apart_mm(paths[k].row, wanted, surface.grid().row_mm);
    if (!(apart < best_mm)) continue;
    best = static_cast<int>(k) + 1;
    best_mm = apart;
  }
  return best;
}

}  // namespace biteline::edit
