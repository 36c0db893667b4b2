// SPDX-License-Identifier: MIT
#include "host/groove/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/groove/lanes.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace biteline::groove {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void AddScaled(std::span<float> to, const float* from, float scale) {
  const hn::ScalableTag<float> d;
  const auto factor = hn::Set(d, scale);
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= to.size(); i += lanes)
    hn::StoreU(hn::MulAdd(factor, hn::LoadU(d, from + i), hn::LoadU(d, to.data() + i)), d, to.data() + i);
  for (; i < to.size(); ++i) to[i] += scale * from[i];
}

/// Rows `r` to `r + lanes` at once.
template <class D>
HWY_INLINE void step_rows(D d, const ColumnStep& column, std::size_t r, float* total, std::int8_t* step) {
  const auto reach = static_cast<std::ptrdiff_t>(column.penalty.size() / 2);
  const float* before = column.before + r;
  auto best = hn::Add(hn::LoadU(d, before - reach), hn::Set(d, column.penalty[0]));
  auto from = hn::Set(d, static_cast<float>(-reach));
  for (std::ptrdiff_t k = 1 - reach; k <= reach; ++k) {
    const auto candidate =
        hn::Add(hn::LoadU(d, before + k), hn::Set(d, column.penalty[static_cast<std::size_t>(k + reach)]));
    from = hn::IfThenElse(hn::Lt(candidate, best), hn::Set(d, static_cast<float>(k)), from);
    best = hn::Min(candidate, best);
  }
  hn::StoreU(hn::Min(hn::Set(d, column.most), hn::Add(best, hn::LoadU(d, column.own + r))), d, total + r);
  const hn::Rebind<std::int32_t, D> whole;
  const hn::Rebind<std::int8_t, D> narrow;
  hn::StoreU(hn::DemoteTo(narrow, hn::ConvertTo(whole, from)), narrow, step + r);
}

void StepColumn(const ColumnStep& column, std::span<float> total, std::int8_t* step) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> one;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t r = 0;
  for (; r + lanes <= total.size(); r += lanes) step_rows(d, column, r, total.data(), step);
  for (; r < total.size(); ++r) step_rows(one, column, r, total.data(), step);
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::groove
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::groove {

HWY_EXPORT(AddScaled);
HWY_EXPORT(StepColumn);

void add_scaled(std::span<float> to, const float* from, float scale) {
  HWY_DYNAMIC_DISPATCH(AddScaled)(to, from, scale);
}
void step_column(const ColumnStep& column, std::span<float> total, std::int8_t* step) {
  HWY_DYNAMIC_DISPATCH(StepColumn)(column, total, step);
}

}  // namespace biteline::groove
#endif  // HWY_ONCE
