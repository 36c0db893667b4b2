// SPDX-License-Identifier: MIT
// Our line and the published one over the classes of made shoes: how often right, refused, wrong; how well
// calibrated.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "hal/sim/shoe/true_line.hpp"
#include "host/bite_line/evaluation/line_error.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/published/published_line.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/support/cloud_faults.hpp"

namespace biteline::bench {
namespace {

constexpr double k_right_mm = 0.08;  // mean error of a right line
// A line that misses this mean by little is imprecise; beyond it, it follows something else.
constexpr double k_wrong_mm = 0.5;
// Confidence of a point: that it lies within 0.3 mm.  Whoever wants a tenth of that takes points this sure.
constexpr double k_sure_ratio = 0.8;

constexpr std::array k_disturbances{
    test::CloudFault::Tilt,   test::CloudFault::Table,  test::CloudFault::Post,    test::CloudFault::Strays,
    test::CloudFault::Sector, test::CloudFault::Sparse, test::CloudFault::Shuffled};

struct Case {
  cloud::PointCloud cloud;
  cloud::ClosedLine truth;
};

/// `upper`: the shoe's upper before it gets a sole, which has no bite line whatever is sewn on it.
Case make_case(sim::ShoeClass shoe_class, std::uint64_t seed, bool upper = false) {
  const sim::ShoeParameters drawn = sim::draw_shoe(shoe_class, seed);
  const sim::MadeShoe shoe{upper ? sim::bare_upper_of(drawn, 0.15, seed) : drawn};
  sim::Random random{seed * 77 + 5};
  SE3 T_base_shoe = SE3::Identity();
  T_base_shoe.linear() =
      Eigen::AngleAxisd(random.uniform({-std::numbers::pi, std::numbers::pi}), Vec3::UnitZ())
          .toRotationMatrix();
  T_base_shoe.translation() =
      Vec3{random.uniform({200, 600}), random.uniform({-300, 300}), random.uniform({20, 80})};
  const sim::ScannedCloud scan = sim::scan_quickly(shoe, {.seed = seed}, T_base_shoe);
  Case made;
  made.cloud.points = scan.points;
  made.cloud.profile = scan.profile;
  made.cloud.column = scan.column;
  for (const sim::TrueLinePoint& point : sim::true_line(shoe, 0.5)) {
    made.truth.points.push_back({.position = T_base_shoe * point.point_shoe,
                                 .normal = T_base_shoe.linear() * point.normal_shoe,
                                 .tangent = Vec3::Zero(),
                                 .confidence = 1});
  }
  return made;
}

/// The cloud spoilt, the truth moved along where the shoe itself is.
void disturb(Case& made, test::CloudFault fault, std::uint64_t seed) {
  std::vector<Vec3> line;
  for (const cloud::LinePoint& p : made.truth.points) line.push_back(p.position);
  const Eigen::Affine3d moved = test::spoil(made.cloud, fault, seed, line);
  for (cloud::LinePoint& p : made.truth.points) {
    p.position = moved * p.position;
    p.normal = moved.linear() * p.normal;
  }
}

struct Tally {
  int shoes{0}, right{0}, imprecise{0}, wrong{0}, refused{0};
  double sum_mm{0}, worst_mean_mm{0}, worst_max_mm{0}, normal2_deg2{0};
  int lines{0};
};

/// Of the points that claim a confidence within a tenth, the share that is within 0.3 mm.
struct Calibration {
  std::vector<double> claimed = std::vector<double>(10, 0.0);
  std::vector<double> held = std::vector<double>(10, 0.0);
  std::vector<double> count = std::vector<double>(10, 0.0);
};

/// Distance to the nearest true point, which lie half a millimetre apart, and its normal's angle.
struct ToTruth {
  double distance_mm{0};
  double normal_deg{0};
};

ToTruth to_truth(const cloud::LinePoint& point, const cloud::ClosedLine& truth) {
  std::size_t near = 0;
  double best = 1e18;
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    const double distance2 = (truth.points[i].position - point.position).squaredNorm();
    if (distance2 < best) {
      best = distance2;
      near = i;
    }
  }
  // Half a step along the line is no error: take out the part along the truth's own direction.
  const std::size_t count = truth.points.size();
  const Vec3 along =
      (truth.points[(near + 1) % count].position - truth.points[(near + count - 1) % count].position)
          .normalized();
  const Vec3 offset = point.position - truth.points[near].position;
  const double cosine = std::clamp(point.normal.dot(truth.points[near].normal), -1.0, 1.0);
  return {(offset - offset.dot(along) * along).norm(), std::acos(cosine) * 180 / std::numbers::pi};
}

void judge(const Case& made, const bite_line::Extraction& found, bool bare, Tally& tally,
           Calibration* calibration, std::string& row, bool only_sure = false) {
  ++tally.shoes;
  char text[300];
  if (!found.found) {
    bare ? ++tally.right : ++tally.refused;
    std::snprintf(text, sizeof text, "%s (%.2f) %s", bare ? "right" : "REFUSED", found.confidence,
                  found.reason().c_str());
    row = text;
    return;
  }
  if (bare) {
    ++tally.wrong;
    row = "WRONG: a line on a bare upper";
    return;
  }
  evaluation::LineError error = evaluation::line_error(found.line, made.truth);
  double normal2_deg2 = 0;
  for (const cloud::LinePoint& point : found.line.points) {
    const ToTruth truth = to_truth(point, made.truth);
    normal2_deg2 += truth.normal_deg * truth.normal_deg / static_cast<double>(found.line.points.size());
    if (calibration == nullptr) continue;
    const auto bin = static_cast<std::size_t>(std::clamp(point.confidence * 10, 0.0, 9.0));
    calibration->claimed[bin] += point.confidence;
    calibration->held[bin] += truth.distance_mm <= 0.3 ? 1 : 0;
    calibration->count[bin] += 1;
  }
  if (only_sure) {
    // What was not seen is a guess and says so: judged where the line claims to be sure.
    double sum = 0;
    double count = 0;
    for (const cloud::LinePoint& point : found.line.points) {
      if (point.confidence < k_sure_ratio) continue;
      sum += to_truth(point, made.truth).distance_mm;
      count += 1;
    }
    error.mean_mm = sum / std::max(count, 1.0);
  }
  ++tally.lines;
  tally.sum_mm += error.mean_mm;
  tally.worst_mean_mm = std::max(tally.worst_mean_mm, error.mean_mm);
  tally.worst_max_mm = std::max(tally.worst_max_mm, error.max_mm);
  tally.normal2_deg2 += normal2_deg2;
  const char* word = error.mean_mm <= k_right_mm   ? "right"
                     : error.mean_mm <= k_wrong_mm ? "IMPRECISE"
                                                   : "WRONG";
  if (error.mean_mm <= k_right_mm)
    ++tally.right;
  else if (error.mean_mm <= k_wrong_mm)
    ++tally.imprecise;
  else
    ++tally.wrong;
  std::snprintf(text, sizeof text,
                "%s mean %.4f p95 %.3f max %.3f complete %.3f normal %.2f deg conf %.3f bridged %.1f", word,
                error.mean_mm, error.p95_mm, error.max_mm, error.complete, std::sqrt(normal2_deg2),
                found.confidence, found.bridged_mm);
  row = text;
}

void print(const std::string& name, const Tally& ours, const Tally& theirs) {
  std::printf(
      "{\"bench\":\"line.class\",\"what\":\"%s: right of %d "
      "shoes\",\"ours\":%d,\"unit\":\"shoes\",\"peer\":\"published\",\"peer_value\":%d,"
      "\"refused\":%d,\"imprecise\":%d,\"wrong\":%d,\"mean_mm\":%.4f,\"worst_mean_mm\":%.4f,\"worst_max_mm\":"
      "%.3f,\"normal_rms_deg\":%.3f,"
      "\"peer_refused\":%d,\"peer_imprecise\":%d,\"peer_wrong\":%d}\n",
      name.c_str(), ours.shoes, ours.right, theirs.right, ours.refused, ours.imprecise, ours.wrong,
      ours.lines > 0 ? ours.sum_mm / ours.lines : 0.0, ours.worst_mean_mm, ours.worst_max_mm,
      ours.lines > 0 ? std::sqrt(ours.normal2_deg2 / ours.lines) : 0.0, theirs.refused, theirs.imprecise,
      theirs.wrong);
  std::fflush(stdout);
}

struct Asked {
  std::uint64_t seeds{23}, from{1};
  std::string only{};
  bool ours_alone{false}, rows{false};
};

bool is_known(const std::string& name) {
  const auto is_it = [&](test::CloudFault fault) { return test::name_of(fault) == name; };
  const auto plain_end = sim::k_shoe_class_names.begin() + sim::k_plain_classes;
  return name.empty() || name == "upper" ||
         std::find(sim::k_shoe_class_names.begin(), plain_end, name) != plain_end ||
         std::any_of(k_disturbances.begin(), k_disturbances.end(), is_it);
}

int run(const Asked& asked) {
  if (!is_known(asked.only)) {
    std::fprintf(stderr, "no class or fault %s\n", asked.only.c_str());
    return 2;
  }
  Tally all_ours;
  Tally all_published;
  Calibration calibration;
  const auto add = [](Tally& sum, const Tally& t) {
    sum.shoes += t.shoes;
    sum.right += t.right;
    sum.imprecise += t.imprecise;
    sum.wrong += t.wrong;
    sum.refused += t.refused;
    sum.sum_mm += t.sum_mm;
    sum.lines += t.lines;
    sum.normal2_deg2 += t.normal2_deg2;
    sum.worst_mean_mm = std::max(sum.worst_mean_mm, t.worst_mean_mm);
    sum.worst_max_mm = std::max(sum.worst_max_mm, t.worst_max_mm);
  };
  for (std::size_t c = 0; c < sim::k_plain_classes; ++c) {
    const std::string name{sim::k_shoe_class_names[c]};
    if (!asked.only.empty() && asked.only != name) continue;
    Tally ours;
    Tally theirs;
    for (std::uint64_t seed = asked.from; seed < asked.from + asked.seeds; ++seed) {
      const Case made = make_case(static_cast<sim::ShoeClass>(c), seed);
      const bool bare = made.truth.points.empty();
      std::string row;
      judge(made, bite_line::find_bite_line(made.cloud, {}), bare, ours, &calibration, row);
      if (asked.rows)
        std::fprintf(stderr, "%-9s %3llu ours      %s\n", name.c_str(), static_cast<unsigned long long>(seed),
                     row.c_str());
      if (asked.ours_alone) continue;
      judge(made, published::find_bite_line(made.cloud.points, {}), bare, theirs, nullptr, row);
      if (asked.rows)
        std::fprintf(stderr, "%-9s %3llu published %s\n", name.c_str(), static_cast<unsigned long long>(seed),
                     row.c_str());
    }
    print(name, ours, theirs);
    add(all_ours, ours);
    add(all_published, theirs);
  }
  print("all", all_ours, all_published);
  if (asked.only.empty() || asked.only == "upper") {
    Tally ours;
    for (std::uint64_t seed = asked.from; seed < asked.from + asked.seeds; ++seed) {
      // Every other one with the seams and stitches that a line could be taken for.
      const std::size_t c = seed % 2 == 0 ? seed / 2 % 9 : static_cast<std::size_t>(sim::ShoeClass::Stitched);
      const Case made = make_case(static_cast<sim::ShoeClass>(c), seed, true);
      std::string row;
      judge(made, bite_line::find_bite_line(made.cloud, {}), true, ours, nullptr, row);
      if (asked.rows)
        std::fprintf(stderr, "%-9s %3llu %-9s %s\n", "upper", static_cast<unsigned long long>(seed),
                     std::string{sim::k_shoe_class_names[c]}.c_str(), row.c_str());
    }
    print("uppers without a sole", ours, {});
  }
  for (std::size_t d = 0; d < k_disturbances.size(); ++d) {
    const std::string name{test::name_of(k_disturbances[d])};
    if (!asked.only.empty() && asked.only != name) continue;
    Tally ours;
    for (std::uint64_t seed = asked.from; seed < asked.from + asked.seeds; ++seed) {
      // Every class but the bare one in turn.
      Case made = make_case(static_cast<sim::ShoeClass>(seed % 9), seed + 1000);
      disturb(made, k_disturbances[d], seed);
      std::string row;
      judge(made, bite_line::find_bite_line(made.cloud, {}), false, ours, &calibration, row,
            k_disturbances[d] == test::CloudFault::Sector);
      if (asked.rows)
        std::fprintf(stderr, "%-9s %3llu %-9s %s\n", name.c_str(), static_cast<unsigned long long>(seed),
                     std::string{sim::k_shoe_class_names[seed % 9]}.c_str(), row.c_str());
    }
    print("disturbed by " + name, ours, {});
  }
  for (std::size_t bin = 0; bin < 10; ++bin) {
    if (calibration.count[bin] < 1) continue;
    std::printf(
        "{\"bench\":\"line.calibration\",\"what\":\"share within 0.3 mm of points claiming "
        "%.2f\",\"ours\":%.3f,\"unit\":\"share\",\"target\":%.3f,\"points\":%.0f}\n",
        calibration.claimed[bin] / calibration.count[bin], calibration.held[bin] / calibration.count[bin],
        calibration.claimed[bin] / calibration.count[bin], calibration.count[bin]);
  }
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  namespace bench = biteline::bench;
  bench::Asked asked;
  biteline::options::Command command{"Made shoes of each class: our line and the published one",
                                     "bench_line_class"};
  command.add_option("--seeds", asked.seeds, "so many shoes of each class")->capture_default_str();
  command.add_option("--from", asked.from, "the first seed")->capture_default_str();
  command.add_option("--class", asked.only, "this class alone, or `upper`, or a fault of the cloud");
  command.add_flag("--no-published", asked.ours_alone, "our line alone");
  command.add_flag("--rows", asked.rows, "a row for each shoe, on stderr");
  if (const std::optional<int> status = bench::read_options(command, argc, argv)) return *status;
  return bench::run(asked);
}
