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
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include "host/bite_line/curve/curve_posterior.hpp"
#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/geometry/logistic.hpp"
#include "tests/bench/line/curve_cases.hpp"
#include "tests/bench/line/curve_fit_held.hpp"
#include "tests/bench/line/curve_fit_samples.hpp"
#include "tests/bench/line/curve_fit_search.hpp"
#include "tests/bench/line/sweep_options.hpp"

namespace biteline::bench {
namespace {

using bite_line::CreaseLooks;
using bite_line::CreaseSigns;
using bite_line::CurveWeights;
using bite_line::k_crease_signs;
using bite_line::Raster;
using bite_line::SignWeights;

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
    log_likelihood += row.weight * std::log(geometry::logistic((row.yes ? 1 : -1) * w.dot(row.signs)));
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
      if (std::optional<Held> held = held_of(of)) held_.push_back(*std::move(held));
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
    // Neighbours look alike: of a run of 60 mm is known what one place would say that nothing else is like.
    constexpr double k_place_weight = 0.05;
    std::vector<Row> round, part, place;
    const auto row = [](const auto& signs, bool yes, double weight = 1) {
      return Row{
          .signs = Eigen::Map<const Eigen::VectorXd>(signs.data(), static_cast<Eigen::Index>(signs.size())),
          .yes = yes,
          .weight = weight};
    };
    // Made shoes and shapes of public origin count half each.
    std::array<double, 2> places_of{};
    for (std::size_t i = 0; i < held_.size(); ++i)
      places_of[held_[i].made()] += static_cast<double>(verdicts[i].places.size());
    const double half = 0.5 * k_place_weight * (places_of[0] + places_of[1]);
    for (std::size_t i = 0; i < held_.size(); ++i) {
      const SearchVerdict& verdict = verdicts[i];
      for (const JudgedPlace& judged : verdict.places)
        place.push_back(row(judged.signs, judged.wrong, half / places_of[held_[i].made()]));
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
    print_fit("place", place, 0.5);
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
    tell_places(verdicts);
    for (const auto& [kind, count] : right)
      std::printf("%s: %s right %d of %d\n", what, kind.c_str(), count.first, count.second);
    std::fflush(stdout);
  }

  /// A row for each place that the third fit reads.
  void tell_places(const std::vector<SearchVerdict>& verdicts) const {
    for (std::size_t i = 0; i < held_.size(); ++i)
      for (const JudgedPlace& judged : verdicts[i].places) {
        std::printf("place,%s,%s,%d", held_[i].kind.c_str(), held_[i].name.c_str(), judged.wrong ? 1 : 0);
        for (const double sign : judged.signs) std::printf(",%.3f", sign);
        std::printf("\n");
      }
  }

  /// Where PosteriorConfig comes from: a row for each rival.
  void tell_rivals(const std::vector<SearchVerdict>& verdicts) const {
    std::printf(
        "rival,kind,name,leads,length_mm,more_per_mm,right_share,rival_right_share,above_mm,"
        "two_surfaces,uneven,own_per_mm,faintest_per_mm,log_odds\n");
    for (std::size_t i = 0; i < held_.size(); ++i)
      for (const JudgedRival& judged : verdicts[i].rivals)
        std::printf("rival,%s,%s,%s,%.1f,%.3f,%.2f,%.2f,%.1f,%.2f,%.2f,%.3f,%.3f,%.2f\n",
                    held_[i].kind.c_str(), held_[i].name.c_str(),
                    !judged.rival.seen ? "unseen"
                    : judged.all_round ? "round"
                                       : "part",
                    judged.rival.length_mm, judged.more_per_mm, judged.right_share, judged.rival_right_share,
                    judged.rival.above_mm, judged.rival.two_surfaces, judged.rival.uneven,
                    judged.rival.own_per_mm, judged.rival.faintest_per_mm, judged.log_odds);
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
