// SPDX-License-Identifier: MIT
// The sweep of made shoes with designed soles, decoys, materials and faults, and of things that are no shoes:
// how many are right, refused and wrong, and how many wrong ones that still allows with 95 %.
//
// --crease makes the bite line's own step and depth so much of what was drawn, and nothing else: with 0.2 and
// less a sole is nearly flush, and most of its decoys are stronger than the line.
// --guard lets every designed sole wrap up over the toe: the line climbs up to 22 mm, nearly upright.
// --heel lifts the line at the heel by so much of the length, 0.4 for a high one: it lies above a low shoe's
// upper.
// A row (--rows, stderr) begins with the index by which `--from INDEX --count 1` makes that shoe again.
// --save writes each cloud, its true line, the line found and all candidates there, to be looked at.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/parallel_for_each.h>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/published/published_line.hpp"
#include "host/cloud/ply.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/support/line_sweep.hpp"

namespace biteline::bench {
namespace {

struct Options {
  SweepOptions cells{};
  std::string decoy{}, fault{};
  double crease_ratio{1};
  std::string save{};
  std::size_t threads{2};
  bool published{false};
  bool rows{false};
  bool materials{false};
  bool guard{false};
  std::optional<double> heel_ratio{};

  [[nodiscard]] bool asks_for(const test::SweepCell& cell) const {
    const auto fits = [](const std::string& asked, std::string_view is) {
      return asked.empty() || asked == is;
    };
    return cells.asks_for(cell) && fits(decoy, sim::name_of(cell.shoe.decoy)) &&
           fits(fault, test::name_of(cell.fault));
  }
};

struct Tally : SweepTally {
  double sum_mm{0};
  int lines{0};

  void add(const test::SweepVerdict& verdict, bool plain_to_see, bool found) {
    SweepTally::add(verdict, plain_to_see);
    if (!found) return;
    sum_mm += verdict.mean_mm;
    ++lines;
  }
};

void print(const std::string& what, const Tally& tally, const Tally* peer) {
  std::printf("{\"bench\":\"line.sweep\",\"what\":\"%s: wrong of %d\",%s,\"mean_mm\":%.4f", what.c_str(),
              tally.scans, tally.row("shapes").c_str(), tally.sum_mm / std::max(1, tally.lines));
  if (peer != nullptr) {
    std::printf(",\"peer\":\"published\",\"peer_value\":%d,\"peer_right\":%d,\"peer_refused\":%d",
                peer->wrong, peer->right, peer->refused);
  }
  std::printf("}\n");
}

std::vector<Vec3> places_of(const cloud::ClosedLine& line) {
  std::vector<Vec3> places;
  for (const cloud::LinePoint& p : line.points) places.push_back(p.position);
  return places;
}

bool write_positions(const std::string& file, const std::vector<Vec3>& line) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out{std::fopen(file.c_str(), "w"), &std::fclose};
  if (!out) return false;
  std::fprintf(out.get(), "#x [mm],y [mm],z [mm]\n");
  for (const Vec3& p : line) std::fprintf(out.get(), "%.4f,%.4f,%.4f\n", p.x(), p.y(), p.z());
  return true;
}

/// The line with what it says of itself.
bool write_found(const std::string& file, const cloud::ClosedLine& line) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out{std::fopen(file.c_str(), "w"), &std::fclose};
  if (!out) return false;
  std::fprintf(out.get(), "#x [mm],y [mm],z [mm],confidence [1],u95 [mm],bridged [1]\n");
  for (const cloud::LinePoint& p : line.points)
    std::fprintf(out.get(), "%.4f,%.4f,%.4f,%.4f,%.4f,%d\n", p.position.x(), p.position.y(), p.position.z(),
                 p.confidence, p.u95_mm.value_or(0), p.source == cloud::PointSource::Bridged ? 1 : 0);
  return true;
}

class Sweep {
 public:
  explicit Sweep(Options options) : options_{std::move(options)} {}

  void run() {
    const tbb::global_control limit{tbb::global_control::max_allowed_parallelism, options_.threads};
    tbb::parallel_for_each(options_.cells.indices(), [&](std::uint64_t index) {
      test::SweepCell cell = test::sweep_cell(options_.cells.seed, index);
      cell.crease_ratio = options_.crease_ratio;
      cell.stripe = options_.materials;
      cell.shoe.toe_guard = options_.guard;
      cell.shoe.heel_ratio = options_.heel_ratio;
      if (options_.asks_for(cell)) judge(index, cell);
    });
    for (const auto& [what, tally] : ours_) {
      const auto peer = published_.find(what);
      print(what, tally, peer == published_.end() ? nullptr : &peer->second);
    }
    for (const auto& [reason, count] : reasons_)
      std::printf(
          "{\"bench\":\"line.sweep\",\"what\":\"shoes refused: %s\",\"ours\":%d,\"unit\":\"shoes\"}\n",
          reason.c_str(), count);
  }

 private:
  void save(std::uint64_t index, const test::SweepScan& scan, const bite_line::Extraction& found) const {
    const std::string beside = (std::filesystem::path{options_.save} / std::to_string(index)).string();
    bool written = cloud::write_cloud(beside + ".ply", scan.cloud).has_value();
    const auto write = [&](const std::string& what, const std::vector<Vec3>& line) {
      if (!line.empty()) written = write_positions(beside + what + ".csv", line) && written;
    };
    write("_truth", places_of(scan.truth));
    if (found.found) written = write_found(beside + "_line.csv", found.line) && written;
    for (std::size_t i = 0; i < found.candidates.size(); ++i)
      write("_candidate_" + std::to_string(i), found.candidates[i].points);
    if (!written) std::fprintf(stderr, "%s: cannot be written\n", beside.c_str());
  }

  void judge(std::uint64_t index, const test::SweepCell& cell) {
    const test::SweepScan scan = test::scan_of(cell);
    const bite_line::Extraction found = bite_line::find_bite_line(scan.cloud, {});
    if (!options_.save.empty()) save(index, scan, found);
    const test::SweepVerdict verdict = test::judge(scan, found);
    test::SweepVerdict peer;
    bool peer_found = false;
    if (options_.published) {
      const bite_line::Extraction theirs = published::find_bite_line(scan.cloud.points, {});
      peer = test::judge(scan, theirs);
      peer_found = theirs.found;
    }
    const std::lock_guard lock{mutex_};
    const std::string kind = cell.is_shoe() ? "all shoes" : "all that have no line";
    for (const std::string& what : {kind, "class " + std::string{sim::name_of(cell.shoe.shoe_class)},
                                    "decoy " + std::string{sim::name_of(cell.shoe.decoy)},
                                    "fault " + std::string{test::name_of(cell.fault)}}) {
      if (!cell.is_shoe() && what.rfind("decoy", 0) == 0) continue;
      ours_[what].add(verdict, scan.plain_to_see, found.found);
      if (options_.published) published_[what].add(peer, scan.plain_to_see, peer_found);
    }
    if (verdict.judged == test::Judged::Refused && found.refusal)
      ++reasons_[report::refusal_row(found.refusal->code).name];
    if (!options_.rows) return;
    std::fprintf(
        stderr, "%5llu %-10s %-13s %-9s %-7s %s wrong %.1f mm mean %.3f max %.2f flagged %.3f conf %.3f %s\n",
        static_cast<unsigned long long>(index), std::string{sim::name_of(cell.shoe.shoe_class)}.c_str(),
        std::string{sim::name_of(cell.shoe.decoy)}.c_str(), std::string{test::name_of(cell.fault)}.c_str(),
        word_for(verdict.judged), scan.plain_to_see ? "plain" : "weak", verdict.wrong_mm, verdict.mean_mm,
        verdict.max_mm, verdict.flagged_share, found.confidence, found.reason().c_str());
  }

  Options options_;
  std::mutex mutex_;
  std::map<std::string, Tally> ours_, published_;
  std::map<std::string, int> reasons_;
};

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  using namespace biteline;
  bench::Options asked;
  options::Command command{"Made shoes, and things that are none: right, refused, wrong", "bench_line_sweep"};
  asked.cells.add_to(command);
  command.add_option("--decoy", asked.decoy, "shoes with this decoy alone");
  command.add_option("--fault", asked.fault, "clouds with this fault alone");
  command.add_option("--crease", asked.crease_ratio, "the bite line's own step and depth, times this")
      ->capture_default_str();
  command.add_option("--save", asked.save, "clouds and lines go to this folder");
  command.add_option("--threads", asked.threads, "so many at once")->capture_default_str();
  command.add_flag("--published", asked.published, "the published method beside it");
  command.add_flag("--materials", asked.materials, "clouds with the stripe's amplitude and width");
  command.add_flag("--guard", asked.guard, "designed soles wrap up over the toe");
  command.add_option("--heel", asked.heel_ratio, "heels of designed shoes are so high, over their length");
  command.add_flag("--rows", asked.rows, "a row for each, on stderr");
  if (const std::optional<int> status = bench::read_options(command, argc, argv)) return *status;
  bench::Sweep{asked}.run();
  return 0;
}
