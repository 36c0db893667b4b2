// SPDX-License-Identifier: MIT
#include "host/cloud/curvature/batch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cloud/curvature/quadrics.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "host/cloud/curvature/quadric-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace biteline::curvature {
namespace HWY_NAMESPACE {

void fit_level_sets_lanes(Batch& batch, float offset) {
  for (std::size_t lane = 0; lane < Batch::k_lanes; lane += hn::Lanes(D())) {
    Sums sums = sums_of(level_rows(batch, lane, offset));
    store_curvature(solve_least_squares(sums), batch, lane);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::curvature
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::curvature {

HWY_EXPORT(fit_level_sets_lanes);

void fit_level_sets(Batch& batch, float offset) {
  HWY_DYNAMIC_DISPATCH(fit_level_sets_lanes)(batch, offset);
}

}  // namespace biteline::curvature
#endif  // HWY_ONCE
