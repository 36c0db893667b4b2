// SPDX-License-Identifier: MIT
#pragma once
/// \file What the surface shows at a place, to a curve that leads over it in a direction: the numbers of
/// which the data term is made.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/curve/raster.hpp"
#include "host/bite_line/pooled_vector.hpp"

namespace biteline::bite_line {

/// Each between -1 and 1.  The upper is to the left of the direction, the sole to its right.
enum class CreaseSign : std::uint8_t {
  Always,       ///< 1
  Turns,        ///< 1 where the surface turns inwards across the direction by more than its noise; else all
                ///< that follows is 0
  FineTurn,     ///< how much, over 1 mm to both sides
  WideTurn,     ///< over 2.25 mm
  Crest,        ///< against the most within 1.5 mm across
  TwoSurfaces,  ///< the surfaces 1.5 to 4 mm to both sides, as planes, turn against each other, concave, or
                ///< the right one stands out: what is sewn or cut into one surface leaves them as one
  FlankStep,    ///< how far the right one stands out where they meet
  FlanksSeen,   ///< 1 where both were
  Overhang,     ///< what is left stands out beyond what is right
  RimRight,     ///< the surface turns outwards close to the right
  WallLeft,     ///< share seen 2 to 8 mm to the left
  SoleRight,    ///< share seen 1.5 to 4.5 mm to the right
  EdgeAhead,    ///< the surface turns outwards along the direction
  LeftCrease,   ///< the most line-like place 2.5 to 25 mm to the left, 0 to 1 from odds of e^-4 to e^2
  RightCrease,  ///< the same to the right
  UnlikeTurn,   ///< how far FineTurn is from the usual one of this shoe's line, where that is known
  UnlikeStep    ///< the same of FlankStep, where both flanks were seen
};
inline constexpr std::size_t k_crease_signs = 17;
using CreaseSigns = std::array<float, k_crease_signs>;

/// Log odds of "the line passes here in this direction" against "surface", per sign.
using SignWeights = std::array<float, k_crease_signs>;
[[nodiscard]] float log_odds(const SignWeights& weights, const CreaseSigns& signs);

struct CurveWeights {
  SignWeights alone;    ///< by the surface itself
  SignWeights all;      ///< by what is beside it, too
  SignWeights usual{};  ///< and by what this shoe's line usually shows
};

/// Sign by sign; 0 of none.
[[nodiscard]] CreaseSigns medians_of(std::span<const CreaseSigns> all);

class CreaseLooks {
 public:
  /// `raster`: borrowed.
  explicit CreaseLooks(const Raster& raster);

  /// Whether anything turns there at all.
  [[nodiscard]] bool turns(std::size_t cell, std::size_t direction) const {
    const std::size_t axis = direction % k_axes;
    const float noise = noise_rad_[cell / static_cast<std::size_t>(raster_.rows)];
    return fine_rad_[axis][cell] > noise || wide_rad_[axis][cell] > noise;
  }
  /// All but the creases beside it.
  [[nodiscard]] CreaseSigns alone(int row, int col, std::size_t direction) const;
  /// Reads all places, and what is beside each: `weights.alone` say how line-like a place is by itself.
  void look_beside(const CurveWeights& weights);
  /// What this shoe's line usually shows; from now on places are compared with it.
  void compare_with(const CreaseSigns& usual) { usual_ = usual; }
  /// A place and direction where the surface is seen and turns.
  struct Turning {
    std::uint32_t cell, direction;
    /// Log odds by the weights, without what is beside it; by_usual: before anything is compared.
    float by_all, by_usual;
    float fine_turn;
    float step;         ///< FlankStep, or k_unknown
    float left, right;  ///< LeftCrease, RightCrease
  };
  /// After look_beside(): of so many columns from the `block` times that one on.
  static constexpr int k_block_cols = 16;
  [[nodiscard]] std::span<const Turning> turning(int block) const {
    return turning_[static_cast<std::size_t>(block)];
  }
  /// By `weights.all` of look_beside(), or `weights.usual` once places are compared.
  [[nodiscard]] float odds(const Turning& at) const;
  /// All; those beside it are 0 before look_beside().
  [[nodiscard]] CreaseSigns all(int row, int col, std::size_t direction) const;

 private:
  /// A place beside a cell: its cell, and how far it is from the middle of that.
  struct Beside {
    int cols, rows;
    float along_mm, up_mm;
    float away_mm;  ///< to the left
  };
  [[nodiscard]] static Beside left_of(std::size_t direction, double mm);
  void read_turns(std::size_t axis, double flank_mm, PooledVector<float>& mean_rad);
  void read_noise();
  [[nodiscard]] std::ptrdiff_t cell(int row, int col, const Beside& at) const;
  [[nodiscard]] float o_mm(std::ptrdiff_t cell, const Beside& at) const {
    const auto i = static_cast<std::size_t>(cell);
    return raster_.o_mm[i] + at.along_mm * raster_.along_ratio[i] + at.up_mm * raster_.up_ratio[i];
  }
  struct Flank {
    float at_mm{0}, slope{0};
    bool seen{false};
  };
  [[nodiscard]] Flank flank(int row, int col, const std::vector<Beside>& places) const;
  [[nodiscard]] float share_seen(int row, int col, const std::vector<Beside>& places) const;
  /// The most of a value at the places beside a cell.
  [[nodiscard]] float most_beside(const PooledVector<float>& values, std::size_t cell,
                                  const std::vector<Beside>& places) const;

  /// Places beside a direction, for each of its looks.
  struct Ways {
    std::vector<Beside> crest, upper, sole, rim, wall, foot, left, right;
  };
  [[nodiscard]] static Ways ways_of(std::size_t direction);

  const Raster& raster_;
  std::array<PooledVector<float>, k_axes> fine_rad_, wide_rad_;  ///< concave > 0, means along the axis
  std::optional<CreaseSigns> usual_;
  std::vector<float> noise_rad_;  ///< per column
  std::array<Ways, k_directions> ways_;
  CurveWeights weights_{};
  std::vector<std::vector<Turning>> turning_;  ///< by cell and direction, see turning()
};

}  // namespace biteline::bite_line
