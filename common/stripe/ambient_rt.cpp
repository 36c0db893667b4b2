// SPDX-License-Identifier: MIT
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/stripe/ambient_rt.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first
#include <hwy/highway.h>

#include "common/stripe/peak_extractor.hpp"

HWY_BEFORE_NAMESPACE();
namespace biteline::stripe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::uint8_t difference(std::uint8_t lit, std::uint8_t dark) {
  if (lit == 255) return 255;
  const int value = lit - dark + k_ambient_pedestal;
  return static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
}

void subtract(const AmbientPair& pair, std::uint8_t* out) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t step = hn::Lanes(d);
  const auto width = static_cast<std::size_t>(pair.width_px);
  const auto pedestal = hn::Set(d, k_ambient_pedestal), full = hn::Set(d, std::uint8_t{255});
  for (std::size_t row = 0; row < static_cast<std::size_t>(pair.height_px); ++row) {
    const std::uint8_t* lit = pair.lit.pixels + row * pair.lit.stride_bytes;
    const std::uint8_t* dark = pair.dark.pixels + row * pair.dark.stride_bytes;
    std::uint8_t* to = out + row * width;
    std::size_t u = 0;
    for (; u + step <= width; u += step) {
      const auto a = hn::LoadU(d, lit + u), b = hn::LoadU(d, dark + u);
      // One of the two differences is zero.
      const auto value =
          hn::SaturatedAdd(hn::SaturatedSub(pedestal, hn::SaturatedSub(b, a)), hn::SaturatedSub(a, b));
      hn::StoreU(hn::IfThenElse(hn::Eq(a, full), full, value), d, to + u);
    }
    for (; u < width; ++u) to[u] = difference(lit[u], dark[u]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::stripe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::stripe {
namespace {
HWY_EXPORT(subtract);
}

void rt_subtract_ambient(const AmbientPair& pair, std::uint8_t* out) noexcept BITELINE_RT {
  HWY_DYNAMIC_DISPATCH(subtract)(pair, out);
}

}  // namespace biteline::stripe
#endif  // HWY_ONCE
