// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/table_touch.hpp"

#include <cmath>

#include "host/geometry/symmetric.hpp"
#include "host/robot/kinematics/student.hpp"

namespace biteline::kinematics {
namespace {

constexpr std::size_t k_least_table_touches = 3;

}  // namespace

Result<TableTouch> fit_table_touch(std::span<const Vec3> tips_base, const TableTouchLimits& limits) {
  if (tips_base.size() < k_least_table_touches) {
    return fail(Errc::Degenerate, "table touch: %zu places, at least %zu needed", tips_base.size(),
                k_least_table_touches);
  }
  const auto n = static_cast<double>(tips_base.size());
  Vec3 centre = Vec3::Zero();
  for (const Vec3& tip : tips_base) centre += tip / n;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vec3& tip : tips_base) {
    const Eigen::Vector2d off = (tip - centre).head<2>();
    spread += off * off.transpose() / n;
  }
  const double least_mm = std::sqrt(std::max(0.0, geometry::principal_axes(spread).values[0]));
  if (!(least_mm >= limits.least_spread_mm)) {
    return fail(
        Errc::Degenerate,
        "table touch: the places lie in a row or too close (spread %.0f mm, at least %.0f); touch the "
        "table's corners",
        least_mm, limits.least_spread_mm);
  }
  TableTouch out{.z_mm = centre.z(), .residual_mm = {}};
  double sum2 = 0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < tips_base.size(); ++i) {
    const double off_mm = tips_base[i].z() - out.z_mm;
    out.residual_mm.push_back(off_mm);
    sum2 += off_mm * off_mm;
    if (std::abs(off_mm) <= out.worst_mm) continue;
    out.worst_mm = std::abs(off_mm);
    worst = i;
  }
  out.u95_mm = student_95(static_cast<int>(tips_base.size()) - 1) * std::sqrt(sum2 / (n - 1) / n);
  if (!(out.worst_mm <= limits.max_residual_mm)) {
    return fail(
        Errc::CheckFailed,
        "table touch: touch %zu lies %.2f mm off the others' height (limit %.1f): level the table, or "
        "touch again",
        worst + 1, out.worst_mm, limits.max_residual_mm);
  }
  return out;
}

}  // namespace biteline::kinematics
