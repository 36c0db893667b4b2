// SPDX-License-Identifier: MIT
#include "tests/bench/line/curve_fit_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>

#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/curve_on_side.hpp"
#include "host/bite_line/curve/curve_posterior.hpp"

namespace biteline::bench {

namespace {

using bite_line::ClosedCurve;
using bite_line::CurveGround;
using bite_line::Raster;

/// What the known line itself costs: all that is farther from it costs the most.
double energy_along_truth(const Held& held, bite_line::CurveCosts costs,
                          const bite_line::CurveConfig& config) {
  constexpr double k_beside_mm = 3;
  for (int col = 0; col < costs.cols; ++col)
    for (int row = 0; row < costs.rows; ++row)
      if (least_off_mm(held.raster.place(row, col), held.truth, held.turn_mm) > k_beside_mm)
        for (std::size_t k = 0; k < bite_line::k_directions; ++k)
          costs.of(costs.at(row, col), k) = bite_line::k_most_cost_per_mm;
  const std::optional<ClosedCurve> curve = bite_line::CurveSearch{costs, config}.best();
  return curve ? curve->energy : 0;
}

std::vector<JudgedRival> judged_rivals(const Held& held, const bite_line::CurveAndRivals& found) {
  const ClosedCurve& curve = found.curve;
  std::vector<Vec2> own;
  for (const bite_line::CurveState& at : curve.states) own.push_back(held.raster.place(at.row, at.col));
  const auto right_share = [&](const std::vector<Vec2>& places) {
    double right = 0, known = 0;
    for (const Vec2& place : places) {
      if (!known_beside(held, place)) continue;
      known += 1;
      right += least_off_mm(place, held.truth, held.turn_mm) < 2.25 + held.truth_mm ? 1 : 0;
    }
    return known > 0 ? right / known : -1;
  };
  std::vector<JudgedRival> judged;
  for (const bite_line::CurveRival& rival : found.rivals) {
    std::vector<Vec2> stretch;
    for (std::size_t i = 0; i < rival.count; ++i) stretch.push_back(own[(rival.first + i) % own.size()]);
    judged.push_back({.rival = rival,
                      .more_per_mm = bite_line::more_per_mm(rival),
                      .right_share = held.right_by_eye() ? 1 : right_share(stretch),
                      .rival_right_share = held.right_by_eye() ? 0 : right_share(rival.places),
                      .all_round = bite_line::leads_all_round(rival, curve),
                      .log_odds = bite_line::log_odds_of(rival, curve, {})});
  }
  return judged;
}

std::vector<JudgedPlace> judged_places(const Held& held, const bite_line::CurveAndRivals& found) {
  constexpr std::size_t k_each = 4;
  constexpr double k_right_mm = 1, k_wrong_mm = 2;
  std::vector<JudgedPlace> judged;
  const auto signs = bite_line::place_signs(found.curve, found.rivals, found.look);
  for (std::size_t i = 0; i < signs.size(); i += k_each) {
    const bite_line::CurveState& at = found.curve.states[i];
    const Vec2 place = held.raster.place(at.row, at.col);
    if (!signs[i] || held.raster.seen[held.raster.at(at.row, held.raster.round_col(at.col))] == 0) continue;
    if (!held.right_by_eye() && !known_beside(held, place)) continue;
    const double off_mm =
        held.right_by_eye() ? 0 : least_off_mm(place, held.truth, held.turn_mm) - held.truth_mm;
    if (off_mm < k_right_mm || off_mm > k_wrong_mm)
      judged.push_back({.signs = *signs[i], .wrong = off_mm > k_wrong_mm});
  }
  return judged;
}

/// Three pictures of the unrolled side: lit from above and from the left; how cheap a curve is in its best
/// direction; and again the first, where the curve is red, its rivals are blue, the known line is green.
void draw(const Held& held, const CurveGround& ground, const bite_line::CurveAndRivals& found,
          const std::string& folder) {
  const Raster& raster = ground.raster;
  const bite_line::CurveCosts& costs = ground.costs;
  constexpr std::size_t k_lit = 0, k_cheap = 1, k_drawn = 2, k_pictures = 3;
  std::vector<std::array<std::uint8_t, 3>> pixels(k_pictures * raster.size());
  const auto pixel_of = [&](std::size_t picture, int row, int col) -> auto& {
    return pixels[(picture * static_cast<std::size_t>(raster.rows) +
                   static_cast<std::size_t>(raster.rows - 1 - row)) *
                      static_cast<std::size_t>(raster.cols) +
                  static_cast<std::size_t>(raster.round_col(col))];
  };
  const auto grey_of = [](float light) {
    const auto grey = static_cast<std::uint8_t>(255 * std::clamp(light, 0.05F, 1.0F));
    return std::array{grey, grey, grey};
  };
  for (int row = 0; row < raster.rows; ++row)
    for (int col = 0; col < raster.cols; ++col) {
      const std::size_t cell = raster.at(row, col);
      if (raster.seen[cell] == 0) continue;
      const auto lit = grey_of(0.6F - 0.35F * raster.up_ratio[cell] - 0.2F * raster.along_ratio[cell]);
      pixel_of(k_lit, row, col) = pixel_of(k_drawn, row, col) = lit;
      const float* const cost = &costs.per_mm[cell * bite_line::k_directions];
      pixel_of(k_cheap, row, col) =
          grey_of(std::exp(-*std::min_element(cost, cost + bite_line::k_directions)));
    }
  const auto pixel = [&](int row, int col) -> auto& {
    return pixel_of(k_drawn, row, col);
  };
  const auto put = [&](const Vec2& at, const std::array<std::uint8_t, 3>& colour) {
    const int row = static_cast<int>(std::lround(raster.row_of(at.y())));
    if (row >= 0 && row < raster.rows)
      pixel(row, static_cast<int>(std::lround(raster.col_of(at.x())))) = colour;
  };
  for (const Vec2& at : held.truth) put(at, {0, 200, 0});
  for (const bite_line::CurveRival& rival : found.rivals)
    for (const Vec2& at : rival.places) put(at, {60, 60, 255});
  for (const bite_line::CurveState& at : found.curve.states) put(raster.place(at.row, at.col), {255, 0, 0});
  std::string name = held.name;
  std::ranges::replace(name, '/', '_');
  std::ranges::replace(name, ' ', '_');
  if (std::FILE* file = std::fopen((folder + "/" + name + ".ppm").c_str(), "wb")) {
    std::fprintf(file, "P6 %d %d 255\n", raster.cols, static_cast<int>(k_pictures) * raster.rows);
    std::fwrite(pixels.data(), 3, pixels.size(), file);
    std::fclose(file);
  }
}

}  // namespace

SearchVerdict searched(const Held& held, const bite_line::CurveWeights& weights,
                       const bite_line::CurveConfig& config, bool scored, const std::string& pictures) {
  SearchVerdict verdict;
  CurveGround ground{held.raster, weights};
  const auto alike = [](auto, auto) { return 0.0; };
  const std::optional<bite_line::CurveAndRivals> found = bite_line::best_curve(ground, config, alike);
  const ClosedCurve* const curve = found ? &found->curve : nullptr;
  if (curve && scored) verdict.rivals = judged_rivals(held, *found);
  if (curve && scored && held.plain) verdict.places = judged_places(held, *found);
  if (curve && !pictures.empty()) draw(held, ground, *found, pictures);
  std::vector<Vec2> places;
  if (curve)
    for (const bite_line::CurveState& at : curve->states) places.push_back(held.raster.place(at.row, at.col));
  verdict.energy = curve ? curve->energy : 0;
  for (std::size_t i = 0; i < held.truth.size(); ++i) {
    const bool seen = passing_at(held, ground.looks, i).has_value();
    if (seen && least_off_mm(held.truth[i], places, held.turn_mm) > 2.0 + held.truth_mm)
      verdict.wrong_mm += Raster::k_cell_mm;
  }
  if (scored && verdict.wrong_mm > 5) verdict.known_energy = energy_along_truth(held, ground.costs, config);
  return verdict;
}

}  // namespace biteline::bench
