// SPDX-License-Identifier: MIT
// Fits the curve's data term (host/bite_line/curve/fitted_weights.cpp) to made shoes and to shapes of public
// origin: a logistic regression of "a bite line passes here in this direction" against "surface".
//
// Made shoes and shapes count half each, and so do places of the line and of surface.  Then the curve is
// sought with it: it is right with at most 5 mm of the line farther than 2 mm, and the truth's own error,
// from it. At the end each class of made shoes, and each shape, is left out in turn (--leave-out). Tried:
// what a wrong curve takes as further surface, and a new fit.  It found fewer shapes, of six.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/curve_on_side.hpp"
#include "host/bite_line/curve/curve_posterior.hpp"
#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/geometry/logistic.hpp"
#include "tests/bench/line/curve_cases.hpp"
#include "tests/bench/line/sweep_options.hpp"

namespace biteline::bench {
namespace {

using bite_line::ClosedCurve;
using bite_line::CreaseLooks;
using bite_line::CreaseSigns;
using bite_line::CurveGround;
using bite_line::CurveWeights;
using bite_line::k_crease_signs;
using bite_line::Large;
using bite_line::Raster;
using bite_line::SignWeights;

struct Held {
  std::string kind, group, name;
  Raster raster;
  std::vector<Vec2> truth;  ///< s, z
  double truth_mm{0};
  double turn_mm{0};

  /// Without labels, yet on its picture (--pictures) the curve is the line: look again when that changes.
  [[nodiscard]] bool right_by_eye() const {
    constexpr std::array k_right = {"s01_airjordan1_scan", "s06_nike_pegasus36",
                                    "s15_mit_sneaker",     "s24_khronos_shoe_with_part_labels",
                                    "s41_low_basketball",  "s43_running"};
    return std::ranges::find(k_right, name) != k_right.end();
  }
  [[nodiscard]] bool made() const { return kind != "shape"; }
};

struct Sample {
  CreaseSigns signs;
  bool line;
  double weight;
  std::size_t held;
};

double off_mm(const Vec2& a, const Vec2& b, double turn_mm) {
  const double s = a.x() - b.x();
  return std::hypot(s - turn_mm * std::round(s / turn_mm), a.y() - b.y());
}

double least_off_mm(const Vec2& place, const std::vector<Vec2>& line, double turn_mm) {
  double least = 1e9;
  for (const Vec2& at : line) least = std::min(least, off_mm(place, at, turn_mm));
  return least;
}

std::size_t direction_of(const Vec2& along) {
  const auto off = [&](std::size_t k) {
    const bite_line::CellStep step = bite_line::k_cell_steps[k];
    return -(along.x() * step.cols + along.y() * step.rows) / step.length();
  };
  std::size_t best = 0;
  for (std::size_t k = 1; k < bite_line::k_directions; ++k)
    if (off(k) < off(best)) best = k;
  return best;
}

/// A place and direction of a curve over the raster.
struct Passing {
  int row, col;
  std::size_t direction;
};

/// The truth's `i`-th place; its own error lets it lie where the surface turns most beside it.
std::optional<Passing> passing_at(const Held& held, const CreaseLooks& looks, std::size_t i) {
  constexpr std::size_t k_about = 3;
  if (i < k_about || i + k_about >= held.truth.size()) return std::nullopt;
  const Vec2 along = held.truth[i + k_about] - held.truth[i - k_about];
  if (along.norm() > 4 * k_about * Raster::k_cell_mm) return std::nullopt;
  const std::size_t k = direction_of(along);
  const Vec2 left = Vec2{-along.y(), along.x()}.normalized();
  const int reach = held.made() ? 1 : 2;
  std::optional<Passing> best;
  float most = -1;
  for (int d = -reach; d <= reach; ++d) {
    const Vec2 at = held.truth[i] + d * Raster::k_cell_mm * left;
    const int row = static_cast<int>(std::lround(held.raster.row_of(at.y())));
    const int col = held.raster.round_col(static_cast<int>(std::lround(held.raster.col_of(at.x()))));
    if (row < 0 || row >= held.raster.rows || held.raster.seen[held.raster.at(row, col)] == 0) continue;
    const float turn = looks.alone(row, col, k)[static_cast<std::size_t>(bite_line::CreaseSign::FineTurn)];
    if (turn <= most) continue;
    most = turn;
    best = Passing{row, col, k};
  }
  return best;
}

/// Places of surface: any, and once they can be told, as many that look like a crease, which count as much.
/// Plain surface is easy to tell from the line; which of several creases it is, is the question.
std::vector<Sample> samples_of(const Held& held, std::size_t number, const CreaseLooks& looks,
                               const std::optional<SignWeights>& alone) {
  constexpr int k_any = 6000, k_tries = 60000;
  constexpr double k_like_crease = 0.3;
  std::vector<Sample> samples, any, creases;
  for (std::size_t i = 0; i < held.truth.size(); i += 2) {
    if (const std::optional<Passing> at = passing_at(held, looks, i))
      samples.push_back({looks.all(at->row, at->col, at->direction), true, 1, number});
  }
  const auto lines = static_cast<double>(samples.size());
  std::mt19937 random{static_cast<std::uint32_t>(number + 1)};
  for (int tries = 0; tries < (alone ? k_tries : k_any); ++tries) {
    const int row = std::uniform_int_distribution<int>{0, held.raster.rows - 1}(random);
    const int col = std::uniform_int_distribution<int>{0, held.raster.cols - 1}(random);
    const auto k = std::uniform_int_distribution<std::size_t>{0, bite_line::k_directions - 1}(random);
    const std::size_t cell = held.raster.at(row, col);
    if (held.raster.seen[cell] == 0 || (tries >= k_any && !looks.turns(cell, k))) continue;
    if (tries >= k_any && geometry::logistic(static_cast<double>(
                              bite_line::log_odds(*alone, looks.alone(row, col, k)))) < k_like_crease)
      continue;
    if (least_off_mm(held.raster.place(row, col), held.truth, held.turn_mm) < 2.5 + held.truth_mm) continue;
    (tries < k_any ? any : creases).push_back({looks.all(row, col, k), false, 0, number});
  }
  const double share = creases.empty() ? 1 : 0.5;
  for (std::vector<Sample>* of : {&any, &creases}) {
    for (Sample& sample : *of) {
      sample.weight = share * lines / static_cast<double>(of->size());
      samples.push_back(sample);
    }
  }
  return samples;
}

/// Of a logistic regression.
struct Row {
  Eigen::VectorXd signs;
  bool yes;
  double weight;
};

/// Newton's method with a ridge.
Eigen::VectorXd logistic_fit(const std::vector<Row>& rows, Eigen::Index n, double ridge) {
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < 50; ++round) {
    Eigen::VectorXd gradient = -ridge * w;
    Eigen::MatrixXd hessian = ridge * Eigen::MatrixXd::Identity(n, n);
    for (const Row& row : rows) {
      const double p = geometry::logistic(w.dot(row.signs));
      gradient += row.weight * ((row.yes ? 1.0 : 0.0) - p) * row.signs;
      hessian += row.weight * p * (1 - p) * row.signs * row.signs.transpose();
    }
    const Eigen::VectorXd step = hessian.ldlt().solve(gradient);
    w += step * std::min(1.0, 2.0 / std::max(step.cwiseAbs().maxCoeff(), 1e-9));
    if (step.cwiseAbs().maxCoeff() < 1e-5) break;
  }
  return w;
}

/// The last `unused` signs stay 0.
SignWeights fitted(const std::vector<Sample>& samples, const std::vector<Held>& held, std::size_t unused,
                   const std::string& left_out) {
  constexpr double k_ridge = 1e-3;
  const auto n = static_cast<Eigen::Index>(k_crease_signs - unused);
  std::map<bool, double> total;
  for (const Sample& sample : samples)
    if (held[sample.held].group != left_out) total[held[sample.held].made()] += sample.weight;
  std::vector<Row> rows;
  for (const Sample& sample : samples) {
    const Held& of = held[sample.held];
    if (of.group == left_out) continue;
    rows.push_back({.signs = Eigen::Map<const Eigen::Matrix<float, static_cast<int>(k_crease_signs), 1>>(
                                 sample.signs.data())
                                 .head(n)
                                 .cast<double>(),
                    .yes = sample.line,
                    .weight = sample.weight / total[of.made()]});
  }
  const Eigen::VectorXd w = logistic_fit(rows, n, k_ridge);
  SignWeights weights{};
  for (Eigen::Index i = 0; i < n; ++i) weights[static_cast<std::size_t>(i)] = static_cast<float>(w[i]);
  return weights;
}

bool known_beside(const Held& held, const Vec2& place) {
  constexpr double k_beside_mm = 3;
  return std::ranges::any_of(held.truth, [&](const Vec2& at) {
    return off_mm({place.x(), at.y()}, at, held.turn_mm) < k_beside_mm;
  });
}

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

/// A rival, and how much of both ways is on the known line, where that is known.
struct JudgedRival {
  bite_line::CurveRival rival;
  double more_per_mm, right_share, rival_right_share;
  bool all_round;
  double log_odds;
};

struct SearchVerdict {
  double wrong_mm{0};
  double energy{0};
  double known_energy{0};  ///< of the cheapest curve along the known line, where another one was found
  std::vector<JudgedRival> rivals{};
};

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

SearchVerdict searched(const Held& held, const CurveWeights& weights, const bite_line::CurveConfig& config,
                       bool scored = false, const std::string& pictures = {}) {
  SearchVerdict verdict;
  CurveGround ground{held.raster, weights};
  const auto alike = [](auto, auto) { return 0.0; };
  const std::optional<bite_line::CurveAndRivals> found = bite_line::best_curve(ground, config, alike);
  const ClosedCurve* const curve = found ? &found->curve : nullptr;
  if (curve && scored) verdict.rivals = judged_rivals(held, *found);
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

void print_weights(const char* name, const SignWeights& weights) {
  std::printf("      .%s = {", name);
  for (std::size_t i = 0; i < k_crease_signs; ++i)
    std::printf("%s%.3fF", i == 0 ? "" : ", ", static_cast<double>(weights[i]));
  std::printf("}\n");
}

void print_fit(const char* name, const std::vector<Row>& rows, double ridge) {
  if (rows.empty()) return;
  const Eigen::VectorXd w = logistic_fit(rows, rows.front().signs.size(), ridge);
  double log_likelihood = 0;
  for (const Row& row : rows)
    log_likelihood += std::log(geometry::logistic((row.yes ? 1 : -1) * w.dot(row.signs)));
  std::printf("      %s{", name);
  for (Eigen::Index i = 0; i < w.size(); ++i) std::printf("%s%.2f", i == 0 ? "" : ", ", w[i]);
  std::printf("};  // %zu rows, %td of them wrong, log-likelihood %.1f\n", rows.size(),
              std::ranges::count_if(rows, &Row::yes), log_likelihood);
}

class CurveFit {
 public:
  CurveFit(CaseOptions cases, bite_line::CurveConfig config, double odds, std::string pictures)
      : config_{config}, odds_{odds}, pictures_{std::move(pictures)} {
    for_cases(cases, [&](CurveCase&& of) {
      const std::optional<bite_line::Side> side = side_of(of.scan.cloud);
      if (!side) return;
      const bite_line::SideGrid& grid = side->field.grid;
      Held held{.kind = of.kind,
                .group = of.group,
                .name = of.name,
                .raster = Raster::of({side->field.places.data(), side->field.places.size()},
                                     side->outline.length_mm(), grid.z_low_mm, grid.rows * grid.row_mm,
                                     side->field.points_per_mm2),
                .truth = truth_on_side(*side, of),
                .truth_mm = of.truth_mm,
                .turn_mm = side->outline.length_mm()};
      if (!held.truth.empty() || held.right_by_eye()) held_.push_back(std::move(held));
    });
  }

  void run() {
    weights_.alone = fitted(samples({}), held_, 4, "");
    samples_ = samples(weights_.alone);
    weights_.all = fitted(samples_, held_, 2, "");
    weights_.usual = fitted(samples_, held_, 0, "");
    print_weights("alone", weights_.alone);
    print_weights("all", weights_.all);
    print_weights("usual", weights_.usual);
    tell("fitted", search_all(weights_));
  }

  /// As they are in the product, on these cases.
  void check() { tell("checked", search_all(bite_line::fitted_weights())); }

  /// PosteriorConfig, anew: from rivals of which one way is the line and the other is not.
  void fit_rivals() const {
    const std::vector<SearchVerdict> verdicts = search_all(bite_line::fitted_weights());
    tell("checked", verdicts);
    std::vector<Row> round, part;
    const auto row = [](const auto& signs, bool yes) {
      return Row{
          .signs = Eigen::Map<const Eigen::VectorXd>(signs.data(), static_cast<Eigen::Index>(signs.size())),
          .yes = yes,
          .weight = 1};
    };
    for (const SearchVerdict& verdict : verdicts) {
      for (const JudgedRival& judged : verdict.rivals) {
        constexpr double k_most = 0.6, k_shortest_mm = 15;
        const bool wrong = judged.right_share<1 - k_most, right = judged.right_share> k_most;
        if (!judged.rival.seen || wrong == right || judged.right_share < 0) continue;
        const bool other_right = judged.rival_right_share > k_most;
        if (judged.all_round && other_right == wrong)
          round.push_back(row(bite_line::round_signs(judged.rival), wrong));
        // Where neither is the line the stretch is to be doubted, too.
        if (!judged.all_round && judged.rival.length_mm >= k_shortest_mm)
          part.push_back(row(bite_line::part_signs(judged.rival), wrong));
      }
    }
    print_fit("round", round, 0.05);
    print_fit("part", part, 0.1);
  }

  void leave_out() {
    std::map<std::string, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < held_.size(); ++i) groups[held_[i].group].push_back(i);
    for (const auto& [group, members] : groups) {
      CurveWeights without = weights_;
      without.all = fitted(samples_, held_, 0, group);
      std::vector<SearchVerdict> verdicts(members.size());
      tbb::parallel_for(std::size_t{0}, members.size(),
                        [&](std::size_t i) { verdicts[i] = searched(held_[members[i]], without, config_); });
      int right = 0;
      double wrong_mm = 0;
      for (const SearchVerdict& verdict : verdicts) {
        right += verdict.wrong_mm <= 5 ? 1 : 0;
        wrong_mm += verdict.wrong_mm;
      }
      std::printf("left out %-34s right %d of %zu, wrong %.0f mm\n", group.c_str(), right, members.size(),
                  wrong_mm);
    }
  }

 private:
  [[nodiscard]] std::vector<Sample> samples(const std::optional<SignWeights>& alone) const {
    std::vector<std::vector<Sample>> each(held_.size());
    tbb::parallel_for(std::size_t{0}, held_.size(), [&](std::size_t i) {
      CreaseLooks looks{held_[i].raster};
      if (alone) looks.look_beside({.alone = *alone, .all = {}});
      std::vector<CreaseSigns> line;
      for (std::size_t k = 0; k < held_[i].truth.size(); ++k)
        if (const std::optional<Passing> at = passing_at(held_[i], looks, k)) {
          const CreaseSigns signs = looks.alone(at->row, at->col, at->direction);
          if (signs[static_cast<std::size_t>(bite_line::CreaseSign::FlanksSeen)] != 0) line.push_back(signs);
        }
      looks.compare_with(bite_line::medians_of(line));
      each[i] = samples_of(held_[i], i, looks, alone);
    });
    std::vector<Sample> all;
    for (const std::vector<Sample>& of : each) all.insert(all.end(), of.begin(), of.end());
    return all;
  }

  [[nodiscard]] std::vector<SearchVerdict> search_all(CurveWeights weights) const {
    weights.all[0] += static_cast<float>(odds_);
    std::vector<SearchVerdict> verdicts(held_.size());
    tbb::parallel_for(std::size_t{0}, held_.size(), [&](std::size_t i) {
      verdicts[i] = searched(held_[i], weights, config_, true, pictures_);
    });
    return verdicts;
  }

  void tell(const char* what, const std::vector<SearchVerdict>& verdicts) const {
    std::map<std::string, std::pair<int, int>> right;
    for (std::size_t i = 0; i < held_.size(); ++i) {
      auto& [good, all] = right[held_[i].kind];
      good += verdicts[i].wrong_mm <= 5 ? 1 : 0;
      ++all;
      if (verdicts[i].wrong_mm > 5)
        std::printf("  %-60s wrong %.0f mm of %.0f, energy %.0f, the known line's %.0f\n",
                    held_[i].name.c_str(), verdicts[i].wrong_mm,
                    Raster::k_cell_mm * static_cast<double>(held_[i].truth.size()), verdicts[i].energy,
                    verdicts[i].known_energy);
    }
    tell_rivals(verdicts);
    for (const auto& [kind, count] : right)
      std::printf("%s: %s right %d of %d\n", what, kind.c_str(), count.first, count.second);
    std::fflush(stdout);
  }

  /// Where PosteriorConfig comes from: a row for each rival.
  void tell_rivals(const std::vector<SearchVerdict>& verdicts) const {
    std::printf(
        "rival,kind,name,leads,length_mm,more_per_mm,right_share,rival_right_share,above_mm,"
        "two_surfaces,uneven,own_uneven,own_per_mm,rest_per_mm,log_odds\n");
    for (std::size_t i = 0; i < held_.size(); ++i)
      for (const JudgedRival& judged : verdicts[i].rivals)
        std::printf("rival,%s,%s,%s,%.1f,%.3f,%.2f,%.2f,%.1f,%.2f,%.2f,%.2f,%.3f,%.3f,%.2f\n",
                    held_[i].kind.c_str(), held_[i].name.c_str(),
                    !judged.rival.seen ? "unseen"
                    : judged.all_round ? "round"
                                       : "part",
                    judged.rival.length_mm, judged.more_per_mm, judged.right_share, judged.rival_right_share,
                    judged.rival.above_mm, judged.rival.two_surfaces, judged.rival.uneven,
                    judged.rival.own_uneven, judged.rival.own_per_mm, judged.rival.rest_per_mm,
                    judged.log_odds);
  }

  bite_line::CurveConfig config_;
  double odds_;
  std::string pictures_;
  std::vector<Held> held_;
  std::vector<Sample> samples_;
  CurveWeights weights_{};
};

int run(int argc, char** argv) {
  CaseOptions cases;
  bite_line::CurveConfig config;
  double odds = 0;
  std::string pictures;
  std::size_t threads = 2;
  bool only_check = false, rivals = false, leave_out = false;
  options::Command command{"Fits the curve's data term", "bench_curve_fit"};
  command.add_option("--seed", cases.seed, "of the made shoes")->capture_default_str();
  command.add_option("--ordinary", cases.ordinary, "made shoes")->capture_default_str();
  command.add_option("--guards", cases.guards, "with a toe guard")->capture_default_str();
  command.add_option("--heels", cases.heels, "with a high heel")->capture_default_str();
  command.add_option("--flush", cases.flush, "whose sole stands out by a tenth to three tenths")
      ->capture_default_str();
  command.add_option("--sewn", cases.sewn, "whose upper has a seam all the way round")->capture_default_str();
  command.add_option("--bend", config.bend_mm, "of the curve")->capture_default_str();
  command.add_option("--odds", odds, "added to the product's log odds of the line before anything was seen")
      ->capture_default_str();
  command.add_option("--pictures", pictures, "unrolled sides with their curves go to this folder, as PPM");
  command.add_option("--threads", threads, "so many at once")->capture_default_str();
  command.add_flag("--check", only_check, "the product's own weights, fitting none");
  command.add_flag("--rivals", rivals, "fit what tells rivals, with the product's own weights");
  command.add_flag("--leave-out", leave_out, "each class and shape in turn");
  if (const std::optional<int> status = read_options(command, argc, argv)) return *status;
  cases.unknown_shapes = rivals;
  const tbb::global_control limit{tbb::global_control::max_allowed_parallelism, threads};
  CurveFit fit{cases, config, odds, pictures};
  if (only_check || rivals) {
    rivals ? fit.fit_rivals() : fit.check();
    return 0;
  }
  fit.run();
  if (leave_out) fit.leave_out();
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  return biteline::bench::run(argc, argv);
}
