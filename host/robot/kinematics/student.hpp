// SPDX-License-Identifier: MIT
#pragma once
/// \file Student's t, for what a few touches know of their own spread.

namespace biteline::kinematics {

/// Half-width of the interval that holds 95 %, in standard deviations estimated with `freedom` degrees of
/// freedom.  Pre: at least 1.  Right to 0.5 %.
[[nodiscard]] double student_95(int freedom);

}  // namespace biteline::kinematics
