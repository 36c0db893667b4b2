// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/likeness.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/bite_line/layers/likeness.cpp"
#include <hwy/foreach_target.h>

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace biteline::bite_line {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Straight lines o = at + slope (z - z0), one for each lane.
template <class D>
struct Lines {
  hn::Vec<D> at_mm, slope;
  hn::Mask<D> known;
};

/// Through the rows `low` to `high` from each lane's own, which is z0; known with 60 % of them seen.
template <class D>
HWY_INLINE Lines<D> lines(D d, const ColumnLikeness::Table& table, std::ptrdiff_t row, double row_mm, int low,
                          int high) {
  const auto between = [&](const double* upto) {
    return hn::Sub(hn::LoadU(d, upto + row + high + 1), hn::LoadU(d, upto + row + low));
  };
  const auto n = between(table.n);
  const auto enough = hn::Ge(n, hn::Set(d, std::max(0.6 * (high - low + 1), 1.0)));
  const auto per_n = hn::Div(hn::Set(d, 1.0), hn::Max(n, hn::Set(d, 1.0)));
  const auto z = hn::Mul(between(table.z_mm), per_n);
  const auto o = hn::Mul(between(table.o_mm), per_n);
  const auto spread = hn::NegMulAdd(z, z, hn::Mul(between(table.zz), per_n));
  const auto least = hn::Set(d, 1e-6);
  const auto slope = hn::Div(hn::NegMulAdd(z, o, hn::Mul(between(table.zo), per_n)), hn::Max(spread, least));
  const auto z0 = hn::Mul(hn::Iota(d, static_cast<double>(row)), hn::Set(d, row_mm));
  return {hn::MulAdd(slope, hn::Sub(z0, z), o), slope, hn::And(enough, hn::Ge(spread, least))};
}

/// 1 / (1 + exp(-x)).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V logistic(D d, V x) {
  constexpr double k_certain = 30;  // beyond it the power of e leaves what a number holds
  const V limited = hn::Max(hn::Set(d, -k_certain), hn::Min(x, hn::Set(d, k_certain)));
  return hn::Div(hn::Set(d, 1.0), hn::Add(hn::Set(d, 1.0), hn::Exp(d, hn::Neg(limited))));
}

/// That what lies above does not stand out beyond what lies as far below: the lower edge of a piece laid on
/// the upper is a crease, too.
template <class D>
HWY_INLINE hn::Vec<D> not_overhung(D d, const LikenessConfig& config, const ColumnLikeness::Table& table,
                                   std::ptrdiff_t row) {
  constexpr double k_overhang_mm = 0.5;
  constexpr double k_soft_mm = 0.1;
  const auto above = lines(d, table, row, config.row_mm, config.near_from, config.near_to);
  const auto below = lines(d, table, row, config.row_mm, -config.near_to, -config.near_from);
  const auto out_mm = hn::Sub(above.at_mm, below.at_mm);
  const auto sure =
      logistic(d, hn::Mul(hn::Sub(hn::Set(d, k_overhang_mm), out_mm), hn::Set(d, 1 / k_soft_mm)));
  return hn::IfThenElse(hn::And(above.known, below.known), sure, hn::Set(d, 1.0));
}

/// That the surfaces above and below are two: they turn against each other or one stands out.
template <class D>
HWY_INLINE hn::Vec<D> two_surfaces(D d, const LikenessConfig& config, const ColumnLikeness::Table& table,
                                   std::ptrdiff_t row) {
  constexpr double k_unknown = 0.6;
  const auto above = lines(d, table, row, config.row_mm, config.flank_from, config.flank_to);
  const auto below = lines(d, table, row, config.row_mm, -config.flank_to, -config.flank_from);
  const auto step_mm = hn::Max(hn::Sub(below.at_mm, above.at_mm), hn::Zero(d));
  const auto turn = hn::Sub(hn::Atan(d, above.slope), hn::Atan(d, below.slope));
  const auto between = hn::MulAdd(hn::Set(d, config.rad_per_step_mm), step_mm, turn);
  const auto sure = logistic(d, hn::Mul(between, hn::Set(d, 1 / config.flank_soft_rad)));
  return hn::IfThenElse(hn::And(above.known, below.known), sure, hn::Set(d, k_unknown));
}

void likeness_lanes(const LikenessConfig& config, const ColumnLikeness::Table& table, std::size_t rows,
                    float* likeness) {
  const hn::CappedTag<double, ColumnLikeness::k_most_lanes> d;
  const hn::Rebind<float, decltype(d)> narrow;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t row = 0; row < static_cast<std::ptrdiff_t>(rows); row += lanes) {
    const auto turn = hn::LoadU(narrow, table.turn_rad + row);
    const auto rises = hn::Sub(hn::PromoteTo(d, turn), hn::Set(d, table.noise_rad));
    const auto shows = hn::Gt(rises, hn::Zero(d));
    if (hn::AllFalse(d, shows)) {
      hn::StoreU(hn::Zero(narrow), narrow, likeness + row);
      continue;
    }
    // A line is where the surface turns most, and not on the flank of that.
    auto most = turn;
    for (int j = -config.crest; j <= config.crest; ++j)
      most = hn::Max(most, hn::LoadU(narrow, table.turn_rad + row + j));
    const auto share =
        hn::Div(hn::PromoteTo(d, turn), hn::Max(hn::PromoteTo(d, most), hn::Set(d, table.noise_rad)));
    const auto plain =
        hn::Sub(hn::Set(d, 1.0),
                hn::Exp(d, hn::Neg(hn::Mul(hn::Max(rises, hn::Zero(d)), hn::Set(d, 1 / config.crease_rad)))));
    const auto between =
        hn::MulAdd(hn::Set(d, 1 - config.one_surface_ratio), two_surfaces(d, config, table, row),
                   hn::Set(d, config.one_surface_ratio));
    const auto all = hn::Mul(hn::Mul(hn::Mul(share, plain), between), not_overhung(d, config, table, row));
    hn::StoreU(hn::DemoteTo(narrow, hn::IfThenElseZero(shows, all)), narrow, likeness + row);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::bite_line
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::bite_line {

HWY_EXPORT(likeness_lanes);

ColumnLikeness::ColumnLikeness(const LikenessConfig& config, std::size_t rows)
    : config_{config},
      rows_{rows},
      margin_{static_cast<std::size_t>(std::max({config.crest, config.near_to, config.flank_to})) +
              k_most_lanes},
      turn_rad_(rows + 2 * margin_, 0.0F),
      likeness_(rows + k_most_lanes) {
  for (std::vector<double>* sums : {&n_, &z_mm_, &zz_, &o_mm_, &zo_})
    sums->resize(rows + 2 * margin_ + 1, 0.0);
}

std::span<const float> ColumnLikeness::of(const float* o_mm, const std::uint8_t* seen, double noise_rad) {
  double n = 0, z_sum = 0, zz = 0, o_sum = 0, zo = 0;
  for (std::size_t row = 0; row < rows_ + margin_; ++row) {
    if (row < rows_ && seen[row] != 0) {
      const double z = static_cast<double>(row) * config_.row_mm;
      const auto o = static_cast<double>(o_mm[row]);
      n += 1;
      z_sum += z;
      zz += z * z;
      o_sum += o;
      zo += z * o;
    }
    const std::size_t at = margin_ + row + 1;
    n_[at] = n;
    z_mm_[at] = z_sum;
    zz_[at] = zz;
    o_mm_[at] = o_sum;
    zo_[at] = zo;
  }
  const Table table{.turn_rad = turn_rad_.data() + margin_,
                    .n = n_.data() + margin_,
                    .z_mm = z_mm_.data() + margin_,
                    .zz = zz_.data() + margin_,
                    .o_mm = o_mm_.data() + margin_,
                    .zo = zo_.data() + margin_,
                    .noise_rad = noise_rad};
  HWY_DYNAMIC_DISPATCH(likeness_lanes)(config_, table, rows_, likeness_.data());
  if (config_.rim_to > 0) see_rims(o_mm, seen, noise_rad);
  return {likeness_.data(), rows_};
}

/// A sole's surface ends at its rim.  What lies below a thin one is no part of it.
void ColumnLikeness::see_rims(const float* o_mm, const std::uint8_t* seen, double noise_rad) {
  const int reach = config_.rim_from;
  const auto rows = static_cast<int>(rows_);
  const auto slope = [&](int low, int high) {
    return static_cast<double>(o_mm[high] - o_mm[low]) / ((high - low) * config_.row_mm);
  };
  const auto sees = [&](int low, int high) {
    return low >= 0 && high < rows && seen[low] != 0 && seen[high] != 0;
  };
  const auto out_rad = [&](int row) {
    if (!sees(row - reach, row + reach) || seen[row] == 0) return 0.0;
    return std::atan(slope(row - reach, row)) - std::atan(slope(row, row + reach));
  };
  const float* turn_rad = turn_rad_.data() + margin_;
  for (int row = 0; row < rows; ++row) {
    const double rises = static_cast<double>(turn_rad[row]) - noise_rad;
    if (!(rises > 0) || seen[row] == 0) continue;
    int rim = 0;
    double most = config_.rim_rad;
    for (int d = config_.rim_from; d <= config_.rim_to; ++d) {
      const double out = out_rad(row - d);
      if (rim > 0 && out < most) break;
      if (out > most) {
        most = out;
        rim = d;
      }
    }
    if (rim == 0 || !sees(row - rim, row + rim)) continue;
    float highest = turn_rad[row];
    for (int j = std::max(-config_.crest, -row); j <= config_.crest && row + j < rows; ++j)
      highest = std::max(highest, turn_rad[row + j]);
    const double turn = std::atan(slope(row, row + rim)) - std::atan(slope(row - rim, row));
    const double two = 1 / (1 + std::exp(-std::clamp(turn / config_.flank_soft_rad, -30.0, 30.0)));
    const double like = static_cast<double>(turn_rad[row]) / static_cast<double>(highest) *
                        (1 - std::exp(-rises / config_.crease_rad)) *
                        (config_.one_surface_ratio + (1 - config_.one_surface_ratio) * two);
    likeness_[static_cast<std::size_t>(row)] =
        std::max(likeness_[static_cast<std::size_t>(row)], static_cast<float>(like));
  }
}

}  // namespace biteline::bite_line
#endif  // HWY_ONCE
