// SPDX-License-Identifier: MIT
// The finder on made shoes of new seeds (ordinary, toe guards, high heels, nearly flush soles, seams all
// round) and on shapes of public origin: right, wrong, for review, refused, and the processor time each
// takes. What holds no line is a thing, and right where nothing is found on it.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/place/point_spread.hpp"
#include "host/cloud/ply.hpp"
#include "host/cloud/uncertainty/radius.hpp"
#include "tests/bench/line/curve_cases.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/shape_truth.hpp"

namespace biteline::bench {
namespace {

/// A line, and what it took of the processor: other work beside it does not count.
struct Found {
  bite_line::Extraction line;
  double ms{0};
};

template <class Find>
Found timed(Find&& find) {
  const std::clock_t begin = std::clock();
  Found found{.line = find(), .ms = 0};
  found.ms = 1000.0 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return found;
}

struct Verdict {
  std::string word;  ///< right, WRONG, review, refused, or found where the line is not known
  double wrong_mm{0}, mean_mm{0}, flagged{0};
  double all_off_mm{0};  ///< length off by more than 1 mm and the truth's own, flagged or not
};

double all_off_mm(const CurveCase& of, const cloud::ClosedLine& line) {
  const double step_mm = cloud::length_mm(line) / static_cast<double>(line.points.size());
  double sum = 0;
  for (const cloud::LinePoint& point : line.points)
    sum += test::distance_mm(point.position, of.scan.truth) > 1 + of.truth_mm ? step_mm : 0;
  return sum;
}

Verdict verdict_of(const CurveCase& of, bite_line::Extraction found) {
  const bite_line::Verdict said = found.verdict();
  Verdict verdict{.word = said == bite_line::Verdict::Ok       ? "found"
                          : said == bite_line::Verdict::Review ? "review"
                                                               : "refused"};
  if (said == bite_line::Verdict::Refused) return verdict;
  if (of.kind == "thing" && said == bite_line::Verdict::Ok) verdict.word = "WRONG";
  if (of.scan.truth.points.empty()) return verdict;
  verdict.all_off_mm = all_off_mm(of, found.line);
  found.found = true;  // a line for review is measured, too
  if (of.truth_mm > 0) {
    const test::LineOnShape on = test::line_on_shape(found.line, of.scan.truth, of.truth_mm);
    verdict.wrong_mm = on.wrong_mm;
    verdict.mean_mm = on.mean_unflagged_mm;
    verdict.flagged = on.flagged;
  } else {
    const test::SweepVerdict judged = test::judge(of.scan, found);
    verdict.wrong_mm = judged.wrong_mm;
    verdict.mean_mm = judged.mean_mm;
    verdict.flagged = judged.flagged_share;
  }
  if (said == bite_line::Verdict::Ok) verdict.word = verdict.wrong_mm > 5 ? "WRONG" : "right";
  return verdict;
}

struct Tally {
  int all{0}, right{0}, wrong{0}, review{0}, refused{0}, plain{0}, plain_not_right{0};
  int review_off{0};  ///< lines for review of which more than 5 mm are off, flagged or not
  double mean_mm{0}, ms{0};

  void add(const CurveCase& of, const Verdict& verdict, double took_ms) {
    ++all;
    right += verdict.word == "right" || verdict.word == "found" ? 1 : 0;
    wrong += verdict.word == "WRONG" ? 1 : 0;
    review += verdict.word == "review" ? 1 : 0;
    review_off += verdict.word == "review" && verdict.all_off_mm > 5 ? 1 : 0;
    refused += verdict.word == "refused" ? 1 : 0;
    plain += of.scan.plain_to_see ? 1 : 0;
    plain_not_right += of.scan.plain_to_see && verdict.word != "right" ? 1 : 0;
    ms += took_ms;
    if (verdict.word == "right") mean_mm += verdict.mean_mm;
  }
};

class Judge {
 public:
  Judge(std::string save, const std::string& points) : save_{std::move(save)} {
    if (points.empty()) return;
    points_.reset(std::fopen(points.c_str(), "w"));
    if (points_)
      std::fprintf(points_.get(),
                   "kind,name,truth_mm,x_mm,z_mm,hold,within,other_mm,doubt,sharp,u95_mm,off_mm\n");
  }

  void judge(const CurveCase& of) {
    std::optional<bite_line::Workings> workings;
    const Found found = timed([&] { return bite_line::find_bite_line(of.scan.cloud, {}, &workings); });
    tell(of, found);
    if (points_ && workings && !of.scan.truth.points.empty()) write_points(of, found.line, *workings);
    if (!save_.empty()) save(of, found.line);
  }

  void summary() const {
    for (const auto& [what, tally] : tallies_)
      std::printf(
          "{\"bench\":\"line.curve\",\"what\":\"%s\",\"shoes\":%d,\"right\":%d,\"wrong\":%d,\"review\":%d,"
          "\"review_off\":%d,\"refused\":%d,\"plain\":%d,\"plain_not_right\":%d,\"mean_mm\":%.3f,\"ms\":%.0f}"
          "\n",
          what.c_str(), tally.all, tally.right, tally.wrong, tally.review, tally.review_off, tally.refused,
          tally.plain, tally.plain_not_right, tally.mean_mm / std::max(1, tally.right),
          tally.ms / std::max(1, tally.all));
  }

 private:
  void tell(const CurveCase& of, const Found& found) {
    const Verdict verdict = verdict_of(of, found.line);
    tallies_[of.kind].add(of, verdict, found.ms);
    std::fprintf(stderr, "%-56s %-8s %s wrong %.1f of %.1f mm mean %.3f flagged %.3f conf %.3f %.0f ms %s\n",
                 of.name.c_str(), verdict.word.c_str(), of.scan.plain_to_see ? "plain" : "weak",
                 verdict.wrong_mm, verdict.all_off_mm, verdict.mean_mm, verdict.flagged,
                 found.line.confidence, found.ms, found.line.reason().c_str());
    for (const report::StageTime& stage : found.line.stages)
      std::fprintf(stderr, " %s %.0f", stage.name, 1000 * stage.seconds);
    std::fprintf(stderr, "\n");
  }

  /// Of each placed station, what its confidence is made of, and how far it is from the known line.
  void write_points(const CurveCase& of, const bite_line::Extraction& found,
                    const bite_line::Workings& workings) const {
    for (const bite_line::PlacedStation& p : workings.placed.points) {
      const bite_line::PointSpread own = bite_line::spread_of(p);
      const Vec3 at = found.T_base_shoe * p.position;
      std::fprintf(
          points_.get(), "%s,%s,%.3f,%.2f,%.2f,%.4f,%.4f,%.3f,%.3f,%.4f,%.4f,%.3f\n", of.kind.c_str(),
          of.name.c_str(), of.truth_mm, p.position.x(), p.position.z(), own.hold, own.within, own.other_mm,
          p.doubt, p.sharp,
          uncertainty::u95_mm(uncertainty::principal_axes(own.covariance_mm2), own.hold, own.other_mm),
          test::distance_mm(at, of.scan.truth));
    }
  }

  void save(const CurveCase& of, const bite_line::Extraction& found) const {
    const std::filesystem::path folder{save_};
    bool written = cloud::write_cloud(folder / (of.name + ".ply"), of.scan.cloud).has_value();
    if (found.found) written = cloud::write_line(folder / (of.name + ".csv"), found.line) && written;
    if (!written) std::fprintf(stderr, "%s: cannot be written\n", of.name.c_str());
  }

  std::string save_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> points_{nullptr, &std::fclose};
  std::map<std::string, Tally> tallies_;
};

int run(int argc, char** argv) {
  CaseOptions cases{.seed = 9201, .unknown_shapes = true};
  std::string save, points;
  bool no_shapes = false;
  options::Command command{"The finder on made shoes and on shapes of public origin", "bench_curve"};
  command.add_option("--seed", cases.seed, "of the made shoes")->capture_default_str();
  command.add_option("--ordinary", cases.ordinary, "made shoes")->capture_default_str();
  command.add_option("--guards", cases.guards, "with a toe guard")->capture_default_str();
  command.add_option("--heels", cases.heels, "with a high heel")->capture_default_str();
  command.add_option("--flush", cases.flush, "whose sole stands out by a tenth to three tenths")
      ->capture_default_str();
  command.add_option("--sewn", cases.sewn, "whose upper has a seam all the way round")->capture_default_str();
  command.add_option("--heel", cases.heel_ratio, "its height over the length")->capture_default_str();
  command.add_flag("--made", no_shapes, "made shoes alone");
  command.add_option("--save", save, "clouds and lines go to this folder");
  command.add_option("--points", points, "a row for each of the line's stations goes to this file");
  if (const std::optional<int> status = read_options(command, argc, argv)) return *status;
  cases.shapes = !no_shapes;
  Judge judge{save, points};
  for_cases(cases, [&](CurveCase&& of) { judge.judge(of); });
  judge.summary();
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  return biteline::bench::run(argc, argv);
}
