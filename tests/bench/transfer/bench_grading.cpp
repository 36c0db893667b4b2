// SPDX-License-Identifier: MIT
// Lines carried to other sizes of a model whose factory's law nobody knows: by one sample and the usual law,
// and by two samples that teach it.
//   bench_grading [first seed] [models]
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "host/transfer/grading.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/made_sizes.hpp"

namespace biteline::bench {
namespace {

constexpr std::array k_changes{-0.1, -0.075, -0.05, -0.025, 0.0, 0.025, 0.05, 0.075, 0.1};
constexpr double k_first = -0.05, k_second = 0.05;  // of the samples
constexpr std::array k_classes{sim::ShoeClass::Deep, sim::ShoeClass::Shallow, sim::ShoeClass::Step,
                               sim::ShoeClass::Decorated};

struct Tally {
  int shoes{0}, refused{0}, bound_broken{0};
  double within{0}, points{0}, error_mm{0}, bound_mm{0}, worst_mm{0};
};

void print(const std::string& what, const Tally& tally) {
  const double lines = std::max(1, tally.shoes - tally.refused);
  std::printf(
      "{\"bench\":\"transfer.grading\",\"what\":\"%s\",\"shoes\":%d,\"refused\":%d,\"mean_mm\":%.3f,"
      "\"worst_mean_mm\":%.3f,\"bound_mm\":%.3f,\"points_within\":%.3f,\"bound_broken\":%d}\n",
      what.c_str(), tally.shoes, tally.refused, tally.error_mm / lines, tally.worst_mm,
      tally.bound_mm / lines, tally.points > 0 ? tally.within / tally.points : 0, tally.bound_broken);
  std::fflush(stdout);
}

void add(Tally& tally, const std::string& name, const transfer::Transfer& carried,
         const cloud::ClosedLine& truth) {
  ++tally.shoes;
  const transfer::Grade& grade = carried.alignment.placement.grade;
  if (!carried.found) {
    ++tally.refused;
    std::fprintf(stderr, "%s refused %s\n", name.c_str(), carried.reason().c_str());
    return;
  }
  double sum_mm = 0, within = 0;
  for (const cloud::LinePoint& point : carried.carried.line.points) {
    const double off_mm = test::distance_mm(point.position, truth);
    sum_mm += off_mm;
    within += off_mm <= carried.bound_mm ? 1 : 0;
  }
  const auto count = static_cast<double>(carried.carried.line.points.size());
  tally.error_mm += sum_mm / count;
  tally.worst_mm = std::max(tally.worst_mm, sum_mm / count);
  tally.bound_mm += carried.bound_mm;
  tally.within += within / count;
  tally.points += 1;
  if (within < 0.95 * count) ++tally.bound_broken;
  std::fprintf(
      stderr,
      "%s mean %.3f bound %.3f within %.2f shape %.3f sigma %.3f rim %d length %.4f width %.4f along "
      "%.4f across %.4f height %.4f offset %.2f steps %d\n",
      name.c_str(), sum_mm / count, carried.bound_mm, within / count, carried.alignment.shape_rms_mm,
      carried.alignment.line_sigma_mm, static_cast<int>(carried.alignment.rim_used), grade.length,
      grade.width, grade.section_along, grade.section_across, grade.height, grade.offset_mm,
      carried.alignment.iterations);
}

void run(std::uint64_t first, int models) {
  std::array<Tally, k_changes.size()> usual{}, taught{};
  for (int m = 0; m < models; ++m) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(m);
    const test::FactoryLaw law = test::drawn_law(seed);
    const test::MadeModel model{k_classes[static_cast<std::size_t>(m) % k_classes.size()], seed, law, {}};
    const transfer::ReadySample a{model.sample(k_first)}, b{model.sample(k_second)};
    const auto grading = transfer::teach_grading(*a.prepared(), *b.prepared());
    if (!grading) {
      std::fprintf(stderr, "%d no law: %s\n", m, to_line(grading.error()).c_str());
      continue;
    }
    const transfer::Grade& g = grading->between;
    std::fprintf(
        stderr, "%d law width %.3f +- %.3f (%.3f) height %.3f +- %.3f (%.3f) along %.3f across %.3f\n", m,
        grading->law.width.mean, grading->law.width.sigma,
        (law.width.at(k_second) / law.width.at(k_first) - 1) / (g.length - 1), grading->law.height.mean,
        grading->law.height.sigma, (law.height.at(k_second) / law.height.at(k_first) - 1) / (g.length - 1),
        grading->law.section_along.mean, grading->law.section_across.mean);
    const transfer::GradingLaw law_b = transfer::law_from(grading->law, grading->between);
    for (std::size_t i = 0; i < k_changes.size(); ++i) {
      const double change = k_changes[i];
      const bool other_foot = (m + static_cast<int>(i)) % 2 == 1;
      const SE3 T_base_upper = geometry::make_se3(
          Eigen::Quaterniond{Eigen::AngleAxisd{0.7 * static_cast<double>(i), Vec3::UnitZ()}}, {430, 90, 48});
      const transfer::SampleFiles upper = model.upper(change, other_foot, seed + 1000 + i, T_base_upper);
      const bool is_first = std::abs(change - k_first) <= std::abs(change - k_second);
      const std::string name =
          std::to_string(m) + " " + std::to_string(change) + (other_foot ? " other" : " same");
      const transfer::ReadySample& nearest = is_first ? a : b;
      add(taught[i], name + " taught",
          transfer::transfer_line(
              nearest, upper.cloud,
              {.align = {.mirror = other_foot, .grade = true, .law = is_first ? grading->law : law_b}}),
          upper.line);
      add(usual[i], name + " usual",
          transfer::transfer_line(a, upper.cloud, {.align = {.mirror = other_foot, .grade = true}}),
          upper.line);
    }
  }
  for (std::size_t i = 0; i < k_changes.size(); ++i) print("usual " + std::to_string(k_changes[i]), usual[i]);
  for (std::size_t i = 0; i < k_changes.size(); ++i)
    print("taught " + std::to_string(k_changes[i]), taught[i]);
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  biteline::bench::run(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 7001,
                       argc > 2 ? std::atoi(argv[2]) : 10);
}
