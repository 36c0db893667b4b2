// SPDX-License-Identifier: MIT
// The sweep as scans with pictures: made shoes and things before the simulated cell's arm, in its real world,
// through the sensor program and the running scan's line.  How many are right, refused and wrong, how far the
// lines are off, and how many points lie within their U95.
//
// A scan takes some 15 s.  --rows: one for each, on stderr; it begins with the index by which
// `--from INDEX --count 1` makes that scan again.  --keep: the sessions stay there, for `biteline replay`.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/sim/live/arm_way.hpp"
#include "hal/sim/live/reachable_scan.hpp"
#include "hal/sim/record/session_recorder.hpp"
#include "hal/sim/record/surroundings.hpp"
#include "host/intake/live_line.hpp"
#include "host/intake/session_run.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/line_sweep.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_arm = "ur10e";

struct Options {
  SweepOptions cells{.count = 3};
  std::string keep{};
  bool rows{false};
};

/// What may be wrong with a scan beyond the shoe itself.
enum class ScanFault { None, Lamps, SoftArm, Hidden, LostFrames };
constexpr std::string_view k_fault_names[] = {"none", "lamps", "soft arm", "hidden", "lost frames"};

/// One scan to be made.
struct ScanCell {
  test::SweepCell sweep;  ///< its cloud's fault is not used
  ScanFault fault{ScanFault::None};
  double size{42}, speed_mm_s{400}, rate_hz{200};
  double hidden_from{0};  ///< of the scan's frames, where something hides 40 mm of the way
};

ScanCell scan_cell(std::uint64_t seed, std::uint64_t index) {
  ScanCell cell{.sweep = test::sweep_cell(seed, index)};
  sim::Random random = sim::Random{cell.sweep.seed}.fork(31);
  cell.size = random.integer(36, 46);
  cell.speed_mm_s = std::array{100.0, 250.0, 400.0}.at(static_cast<std::size_t>(random.integer(0, 2)));
  cell.rate_hz = cell.speed_mm_s > 100 ? 200 : 100;
  if (random.chance(0.5)) cell.fault = static_cast<ScanFault>(random.integer(1, 4));
  cell.hidden_from = random.uniform({0.1, 0.8});
  return cell;
}

sim::ShoeParameters shoe_of(const ScanCell& cell) {
  sim::DesignedShoe shoe = cell.sweep.shoe;
  const double length_mm = sim::length_of_size_mm(cell.size);
  if (!sim::is_designed(shoe.shoe_class)) return sim::draw_shoe(shoe.shoe_class, cell.sweep.seed, length_mm);
  shoe.length_mm = length_mm;
  return sim::draw_designed_shoe(shoe, cell.sweep.seed);
}

/// Whether the frame reaches the host.
bool comes_in(const ScanCell& cell, std::uint64_t frame, std::uint64_t frames) {
  constexpr double k_hidden_mm = 40;
  constexpr std::uint64_t k_lost_each = 3;
  if (cell.fault == ScanFault::LostFrames) return frame % k_lost_each != 0;
  if (cell.fault != ScanFault::Hidden) return true;
  const double behind_mm = (static_cast<double>(frame) - cell.hidden_from * static_cast<double>(frames)) *
                           cell.speed_mm_s / cell.rate_hz;
  return behind_mm < 0 || behind_mm > k_hidden_mm;
}

/// The session's folder; Errc::OutOfReach where the arm does not get round that shoe.
Result<std::unique_ptr<sim::MadeScene>> record(const ScanCell& cell, const fs::path& folder) {
  constexpr double k_scan_begin_ratio = 0.25, k_many_lamps_grey = 30, k_soft_unseen_ratio = 0.6;
  sim::Disturbances disturbances = sim::common_disturbances();
  if (cell.fault == ScanFault::SoftArm) disturbances.arm.unseen_ratio = k_soft_unseen_ratio;
  BITELINE_ASSIGN(
      auto scene,
      sim::make_scene({.shoe = shoe_of(cell),
                       .place_seed = cell.sweep.seed,
                       .places = sim::places_within_reach_of(k_arm),
                       .head_seed = cell.sweep.seed,
                       .holder = sim::Holder::Bracket,
                       .scan_speed_mm_s = cell.speed_mm_s,
                       .scan_begin_ratio = k_scan_begin_ratio,
                       .scan_clockwise = true,
                       .rate_hz = cell.rate_hz,
                       .ambient_grey = cell.fault == ScanFault::Lamps ? k_many_lamps_grey : sim::k_hall_grey,
                       .surroundings = true}));
  const auto kinematics = sim::ArmKinematics::named(k_arm);
  BITELINE_ASSIGN(const sim::ReachableScan reachable, sim::place_within_reach(*scene, *kinematics, k_arm));
  BITELINE_TRY(sim::record_session(folder, *scene,
                                   {.noise_seed = cell.sweep.seed,
                                    .way = sim::way_of(*reachable.scan, *kinematics, disturbances.arm),
                                    .disturbances = disturbances},
                                   {}));
  return scene;
}

struct Judgement {
  test::SweepScan scan;
  bite_line::Extraction found;
  test::SweepVerdict verdict;
};

/// The line as of a running scan.
Result<Judgement> look(const ScanCell& cell, const fs::path& session, const sim::MadeScene& scene) {
  Judgement judgement;
  intake::LiveLine line{{}};
  const auto frames = static_cast<std::uint64_t>(scene.path.duration_s() * cell.rate_hz);
  BITELINE_ASSIGN(
      const intake::SessionRun run,
      intake::run_sensor_on_session(
          {.session = session,
           .sensor_file = {},
           .sensor_options = {},
           .program = fs::path{BITELINE_SENSOR},
           .progress = {},
           .on_profile = [&](const profile::Profile& profile, std::span<const Eigen::Vector3f> points_base,
                             const cloud::StripeSpan& stripe) {
             if (!comes_in(cell, profile.header.sequence, frames)) return;
             auto& points = judgement.scan.cloud.points;
             points.insert(points.end(), points_base.begin(), points_base.end());
             line.add_profile(profile.header.sequence, points_base, intake::pose_of(profile.header), stripe);
           }}));
  line.close();
  judgement.found = line.wait().extraction;
  test::add_truth(judgement.scan, scene.shoe, Eigen::Affine3d{scene.T_base_shoe});
  judgement.verdict = test::judge(judgement.scan, judgement.found);
  return judgement;
}

struct Tally : SweepTally {
  double sum_mm{0}, points{0}, within{0};

  void add(const Judgement& judgement) {
    SweepTally::add(judgement.verdict, judgement.scan.plain_to_see);
    if (!judgement.found.found || judgement.scan.truth.points.empty()) return;
    for (const cloud::LinePoint& p : judgement.found.line.points) {
      const double off_mm = test::distance_mm(p.position, judgement.scan.truth);
      sum_mm += off_mm;
      points += 1;
      within += p.u95_mm && off_mm <= static_cast<double>(*p.u95_mm) ? 1 : 0;
    }
  }
};

class Pictures {
 public:
  explicit Pictures(Options options) : options_{std::move(options)} {}

  void run() {
    for (const std::uint64_t index : options_.cells.indices()) {
      const ScanCell cell = scan_cell(options_.cells.seed, index);
      if (!options_.cells.asks_for(cell.sweep)) continue;
      if (const Result<void> made = make(index, cell); !made) {
        ++not_made_;
        std::fprintf(stderr, "%5llu %s of size %g: %s\n", static_cast<unsigned long long>(index),
                     std::string{sim::name_of(cell.sweep.shoe.shoe_class)}.c_str(), cell.size,
                     to_line(made.error()).c_str());
      }
    }
    for (const auto& [what, tally] : tallies_) print(what, tally);
    std::printf(
        "{\"bench\":\"line.pictures\",\"what\":\"shoes that the arm cannot scan\",\"ours\":%d,"
        "\"unit\":\"shoes\"}\n",
        not_made_);
  }

 private:
  Result<void> make(std::uint64_t index, const ScanCell& cell) {
    const test::TemporaryFolder temporary;
    const fs::path session =
        (options_.keep.empty() ? temporary.path() : fs::path{options_.keep}) / std::to_string(index);
    BITELINE_ASSIGN(const auto scene, record(cell, session));
    BITELINE_ASSIGN(const Judgement judgement, look(cell, session, *scene));
    const test::SweepCell& sweep = cell.sweep;
    const std::string fault{k_fault_names[static_cast<std::size_t>(cell.fault)]};
    tallies_[sweep.is_shoe() ? "all shoes" : "all that have no line"].add(judgement);
    tallies_["class " + std::string{sim::name_of(sweep.shoe.shoe_class)}].add(judgement);
    tallies_["fault " + fault].add(judgement);
    if (options_.rows) tell(index, cell, fault, judgement);
    return {};
  }

  static void tell(std::uint64_t index, const ScanCell& cell, const std::string& fault,
                   const Judgement& judgement) {
    const test::SweepVerdict& verdict = judgement.verdict;
    std::fprintf(
        stderr,
        "%5llu %-10s %-13s %-11s size %g %3.0f mm/s %-7s %s wrong %.1f mm mean %.3f max %.2f flagged "
        "%.3f conf %.3f moved %.3f %s\n",
        static_cast<unsigned long long>(index), std::string{sim::name_of(cell.sweep.shoe.shoe_class)}.c_str(),
        std::string{sim::name_of(cell.sweep.shoe.decoy)}.c_str(), fault.c_str(), cell.size, cell.speed_mm_s,
        word_for(verdict.judged), judgement.scan.plain_to_see ? "plain" : "weak", verdict.wrong_mm,
        verdict.mean_mm, verdict.max_mm, verdict.flagged_share, judgement.found.confidence,
        judgement.found.seam.value_or(bite_line::SeamStep{}).moved_mm, judgement.found.reason().c_str());
  }

  static void print(const std::string& what, const Tally& tally) {
    const double points = std::max(1.0, tally.points);
    std::printf(
        "{\"bench\":\"line.pictures\",\"what\":\"%s: wrong of %d\",%s,\"mean_mm\":%.4f,"
        "\"within_u95\":%.4f}\n",
        what.c_str(), tally.scans, tally.row("scans").c_str(), tally.sum_mm / points, tally.within / points);
  }

  Options options_;
  std::map<std::string, Tally> tallies_;
  int not_made_{0};
};

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  using namespace biteline;
  bench::Options asked;
  options::Command command{"The sweep as scans with pictures", "bench_line_pictures"};
  asked.cells.add_to(command);
  command.add_option("--keep", asked.keep, "sessions stay in this folder");
  command.add_flag("--rows", asked.rows, "a row for each, on stderr");
  if (const std::optional<int> status = bench::read_options(command, argc, argv)) return *status;
  bench::Pictures{asked}.run();
  return 0;
}
