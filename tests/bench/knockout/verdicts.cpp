// SPDX-License-Identifier: MIT
// One line for each case: name, verdict, error in mm.  run.sh compares these between the product as it is and
// with one of its heuristics knocked out.
//
//   knockout_verdicts
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>

#include "common/config/sensor_yaml.hpp"
#include "common/stripe/peak_extractor.hpp"
#include "common/stripe/peak_selector.hpp"
#include "hal/sim/shoe/random.hpp"
#include "host/bite_line/evaluation/cloud_error.hpp"
#include "host/bite_line/evaluation/line_error.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/calibration/head/head_calibration.hpp"
#include "host/cloud/ply.hpp"
#include "host/intake/session_run.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/known_shoe.hpp"
#include "tests/support/last_pair.hpp"
#include "tests/support/line_sweep.hpp"
#include "tests/support/made_pair.hpp"
#include "tests/support/made_stripe.hpp"
#include "tests/support/shape_truth.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::bench {
namespace {

namespace fs = std::filesystem;

const fs::path k_golden{BITELINE_GOLDEN};

void row(const std::string& name, const std::string& verdict, double error_mm) {
  std::printf("%s\t%s\t%.4f\n", name.c_str(), verdict.c_str(), error_mm);
  std::fflush(stdout);
}

template <class Refusal>
std::string code_of(const std::optional<Refusal>& refusal) {
  return refusal ? std::string{"refused: "} + report::told(*refusal).reason_code : "refused";
}

void line_row(const std::string& name, const cloud::PointCloud& cloud, const cloud::ClosedLine& truth) {
  const bite_line::Extraction found = bite_line::find_bite_line(cloud, {});
  if (!found.found) return row(name, code_of(found.refusal), 0);
  if (truth.points.empty()) return row(name, "a line where there is none", 0);
  const evaluation::LineError error = evaluation::line_error(found.line, truth);
  row(name, error.mean_mm <= 0.08 ? "right" : error.mean_mm <= 0.5 ? "imprecise" : "wrong", error.mean_mm);
}

/// What may lie about a shoe in a cell.
enum class Besides { Nothing, Table, Strays, InnerWall };
constexpr const char* k_besides_names[] = {"alone", "on a table", "with strays", "with an inner wall"};

cloud::PointCloud with(cloud::PointCloud cloud, Besides besides, const SE3& T_base_shoe, std::uint64_t seed) {
  sim::Random random{seed * 31 + 7};
  const std::size_t points = cloud.size();
  const auto add = [&](const Vec3& p_shoe) { cloud.points.push_back((T_base_shoe * p_shoe).cast<float>()); };
  for (std::size_t i = 0; besides == Besides::Table && i < 100'000; ++i)
    add({random.uniform({-100, 400}), random.uniform({-200, 200}), 0.02 * random.gaussian() - 0.3});
  for (std::size_t i = 0; besides == Besides::Strays && i < points / 100; ++i)
    add({random.uniform({-60, 360}), random.uniform({-120, 120}), random.uniform({-30, 120})});
  // The far wall of an open upper, seen over the near collar: thinned, 4 mm behind the outer surface.
  for (std::size_t i = 0; besides == Besides::InnerWall && i < points; i += 4) {
    const Vec3 p = T_base_shoe.inverse() * cloud.points[i].cast<double>();
    if (p.z() > 40) add({p.x(), p.y() * (1 - 4 / std::max(std::abs(p.y()), 10.0)), p.z()});
  }
  if (besides != Besides::Nothing) {
    cloud.profile.clear();
    cloud.column.clear();
  }
  return cloud;
}

void line_rows() {
  for (std::size_t c = 0; c < sim::k_shoe_class_names.size(); ++c) {
    const auto shoe_class = static_cast<sim::ShoeClass>(c);
    for (const std::uint64_t seed : {41, 42}) {
      for (const Besides besides : {Besides::Nothing, Besides::Table, Besides::Strays, Besides::InnerWall}) {
        if (besides != Besides::Nothing && seed != 41) continue;
        const sim::ShoeParameters shoe = sim::draw_shoe(shoe_class, seed);
        const SE3 T_base_shoe = geometry::make_se3(
            Eigen::Quaterniond{Eigen::AngleAxisd{0.7 * static_cast<double>(seed), Vec3::UnitZ()}},
            {400, -60, 35});
        const cloud::PointCloud cloud =
            with(test::scanned(shoe, T_base_shoe, {.column_step_mm = 0.15, .seed = seed}), besides,
                 T_base_shoe, seed);
        line_row(std::string{"line, "} + std::string{sim::k_shoe_class_names[c]} + " " +
                     std::to_string(seed) + ", " + k_besides_names[static_cast<int>(besides)],
                 cloud, test::as_line(sim::true_line(sim::MadeShoe{shoe}, 0.5), T_base_shoe));
      }
    }
  }
  const auto golden = cloud::read_cloud(k_golden / "sample/cloud.ply");
  const auto truth = cloud::read_positions(k_golden / "sample/truth/groove.csv");
  if (golden && truth) line_row("line, golden sample", *golden, *truth);
  for (const test::KnownShoe& shoe : test::k_known_shoes) {
    const auto cloud = test::scan_of(shoe);
    if (!cloud) continue;
    const bite_line::Extraction found = bite_line::find_bite_line(*cloud, {});
    const test::ShoeVerdict verdict = test::judge(shoe, found);
    row(std::string{"line, "} + shoe.name,
        found.found ? (verdict.right ? "right" : "wrong") : code_of(found.refusal), verdict.off_mm);
  }
}

void sweep_row(std::uint64_t seed, std::uint64_t index, double crease_ratio) {
  test::SweepCell cell = test::sweep_cell(seed, index);
  cell.crease_ratio = crease_ratio;
  const test::SweepScan scan = test::scan_of(cell);
  line_row("line, " + std::string{sim::name_of(cell.shoe.shoe_class)} + " with " +
               std::string{sim::name_of(cell.shoe.decoy)} + ", fault " +
               std::string{test::name_of(cell.fault)} + ", " + std::to_string(index),
           scan.cloud, scan.truth);
}

/// Shoes of the sweep that need what other rows do not.
void sweep_rows() {
  constexpr std::uint64_t k_seed = 20'261'122;
  constexpr std::uint64_t k_later_seed = 70'531;
  constexpr double k_nearly_flush = 0.12;
  // Tilted ones, strays beside and on them, caps' edges.
  for (const std::uint64_t index : {43, 47, 67, 121, 128, 148, 178, 283}) sweep_row(k_seed, index, 1);
  // A pump that hardly holds, and two boxes whose lids hang over.
  for (const std::uint64_t index : {855, 8, 117}) sweep_row(k_later_seed, index, 1);
  // Soles whose ledges and welts are stronger than their line.
  for (const std::uint64_t index : {6, 65, 109, 125, 136, 196})
    sweep_row(k_later_seed, index, k_nearly_flush);
}

/// A shoe that somebody pushes by 3 mm when half of the scan is done: its line is nowhere.
void pushed_row() {
  test::SweepCell cell = test::sweep_cell(71'101, 3);
  cell.fault = test::CloudFault::None;
  cloud::PointCloud cloud = test::scan_of(cell).cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (2 * cloud.profile[i] > cloud.profile.back()) cloud.points[i] += Eigen::Vector3f{2.1F, 2.1F, 0};
  line_row("line, pushed by 3 mm half-way round", cloud, {});
}

/// A sole that is nearly flush, with a stitch groove of its own about as good as its line.
void material_row() {
  test::SweepCell cell = test::sweep_cell(41'001, 16);
  cell.fault = test::CloudFault::None;
  cell.crease_ratio = 0.11;
  cell.stripe = true;
  const test::SweepScan scan = test::scan_of(cell);
  line_row("line, nearly flush midsole of another material", scan.cloud, scan.truth);
}

/// Shapes of public origin with a known line, or none.
void shape_rows() {
  constexpr double k_right_mm = 5.0;
  for (const test::Shape& shape : test::k_shapes) {
    const auto cloud = test::cloud_of(shape);
    const auto truth = test::truth_of(shape);
    if (!cloud || !truth || (truth->line.points.empty() && !truth->has_none)) continue;
    const bite_line::Extraction found = bite_line::find_bite_line(*cloud, {});
    const std::string name = std::string{"shape, "} + shape.name;
    if (!found.found) {
      row(name, code_of(found.refusal), 0);
    } else if (truth->has_none) {
      row(name, "a line where there is none", 0);
    } else {
      const test::LineOnShape line = test::line_on_shape(found.line, truth->line);
      row(name, line.wrong_mm <= k_right_mm ? "right" : "wrong", line.mean_mm);
    }
  }
}

void transfer_row(const std::string& name, const test::MadePair& pair, const Eigen::Affine3d& change,
                  const transfer::TransferOptions& options) {
  cloud::PointCloud upper = pair.upper_cloud;
  for (Eigen::Vector3f& p : upper.points) p = (change * p.cast<double>()).cast<float>();
  cloud::ClosedLine truth = pair.upper_line;
  for (cloud::LinePoint& p : truth.points) p.position = change * p.position;
  const transfer::Transfer found =
      transfer::transfer_line({.cloud = pair.sample_cloud, .line = pair.sample_line}, upper, options);
  if (!found.found) return row(name, code_of(found.refusal), 0);
  const double mean_mm = evaluation::line_error(found.carried.line, truth).mean_mm;
  row(name, mean_mm <= 0.2 ? "right" : mean_mm <= 0.5 ? "imprecise" : "wrong", mean_mm);
}

Eigen::Affine3d scaled(double x, double y, double z) {
  Eigen::Affine3d change = Eigen::Affine3d::Identity();
  change.linear() = Vec3{x, y, z}.asDiagonal();
  return change;
}

/// A factory that grades by the length alone, sections and heights as they are.
void longer_row(const std::string& name, test::MadePair pair, sim::ShoeParameters size) {
  size.outline.length_mm *= 0.87;
  const sim::MadeShoe upper{sim::bare_upper_of(size, 0.15, 9)};
  pair.upper_cloud = test::scanned(upper.parameters(), pair.T_base_upper, {.column_step_mm = 0.2});
  pair.upper_line =
      test::as_line(sim::carried_line(sim::true_line(sim::MadeShoe{size}, 1.0), upper), pair.T_base_upper);
  transfer_row(name, pair, Eigen::Affine3d::Identity(), {.align = {.grade = true}});
}

/// Collars that agree with each other and not with the shoe.
void collar_rows() {
  const test::MadePair pair = test::last_pair({.seed = 7, .collar = test::Collar::Parallel});
  for (const double ratio : {0.96, 1.04})
    transfer_row("transfer, collar cut parallel, " + std::to_string(ratio) + ", graded", pair,
                 scaled(ratio, ratio, ratio), {.align = {.grade = true}});
}

void transfer_rows() {
  for (const sim::ShoeClass shoe_class : {sim::ShoeClass::Deep, sim::ShoeClass::Stitched}) {
    for (const std::uint64_t seed : {3, 6}) {
      const test::MadePair pair =
          test::made_pair({.shoe_class = shoe_class, .seed = seed, .scan = {.column_step_mm = 0.2}});
      const std::string name =
          "transfer, " + std::string{sim::name_of(shoe_class)} + " " + std::to_string(seed);
      const transfer::TransferOptions graded{.align = {.grade = true}};
      transfer_row(name + ", same size", pair, scaled(1, 1, 1), {});
      transfer_row(name + ", all 4 % larger, graded", pair, scaled(1.04, 1.04, 1.04), graded);
      transfer_row(name + ", 3 % smaller, graded", pair, scaled(0.97, 0.97, 0.97), graded);
      transfer_row(name + ", higher by 2 %, graded", pair, scaled(1.04, 1.04, 1.02), graded);
      longer_row(name + ", 13 % shorter, sections as they are, graded", pair,
                 sim::draw_shoe(shoe_class, seed));
      transfer_row(name + ", another size", pair, scaled(1.04, 1.04, 1.04), {});
      transfer_row(name + ", other foot", pair, scaled(1, -1, 1), {});
      transfer_row(name + ", upside down", pair, scaled(1, -1, -1), {});
    }
  }
}

void calibration_row(const std::string& name, const fs::path& folder) {
  calibration::HeadInput input;
  input.camera = *calibration::read_camera_folder(folder);
  input.laser = *calibration::read_laser_folder(folder);
  input.hand_eye = *calibration::read_hand_eye_folder(folder);
  const calibration::HeadCalibration found = calibration::calibrate_head(input);
  if (found.refused) return row(name, "refused", 0);
  const auto truth = config::read_sensor_yaml(folder / "truth/sensor.yaml");
  double sum_mm2 = 0, count = 0;
  for (int u = 50; u < 1600; u += 50) {
    for (int v = 470; v < 780; v += 20, ++count)
      sum_mm2 += (geometry::triangulate(found.fit.state.camera, found.fit.state.plane, Vec2(u, v)) -
                  geometry::triangulate(truth->camera, truth->laser_plane, Vec2(u, v)))
                     .squaredNorm();
  }
  const double rms_mm = std::sqrt(sum_mm2 / count);
  // The bar of a whole set; the golden one has a third of its pictures.
  row(name, rms_mm <= 0.010 ? "right" : rms_mm <= 0.030 ? "imprecise" : "wrong", rms_mm);
}

/// Black beyond an edge that comes to the stripe at 15 degrees: the columns that are taken for the surface.
void print_row() {
  const double angle_rad = 15 * std::numbers::pi / 180;
  stripe::test::MadeStripe made;
  made.width_px = 400;
  made.amplitude = 150;
  made.noise.speckle_contrast = 0.1F;
  made.row_px = [](int u) { return 60 + 0.05 * u; };
  const std::vector<double> mean = stripe::test::on_surface(made, [&](double u, double v) {
    return (u - 200) * std::sin(angle_rad) + (v - 70) * std::cos(angle_rad) > 0 ? 0.05 : 1.0;
  });
  std::mt19937_64 random{5};
  const std::vector<std::uint8_t> pixels = stripe::test::expose(made, mean, random);
  auto extractor = stripe::PeakExtractor::create({.noise = made.noise}, made.width_px, made.height_px);
  const auto peaks = std::make_unique<stripe::Peaks>();
  const auto selection = std::make_unique<stripe::Selection>();
  extractor->rt_extract({.pixels = pixels.data(), .stride_bytes = static_cast<std::size_t>(made.width_px)},
                        *peaks);
  stripe::PeakSelector{stripe::SelectorConfig{}}.rt_select(*peaks, *selection);
  double sum_px2 = 0, count = 0;
  for (int u = 0; u < made.width_px; ++u) {
    const auto column = static_cast<std::size_t>(u);
    const stripe::Selected& selected = selection->columns[column];
    if (selected.kept_index < 0 || selected.flags != 0) continue;
    const stripe::Peak& peak = peaks->columns[column].kept[static_cast<std::size_t>(selected.kept_index)];
    if ((peak.flags & stripe::k_peak_poor_fit) != 0) continue;
    sum_px2 += std::pow(static_cast<double>(peak.row_px) - made.row_px(u), 2);
    ++count;
  }
  const double rms_px = std::sqrt(sum_px2 / std::max(count, 1.0));
  row("stripe, black print, px", count > 100 && rms_px <= 0.15 ? "right" : "imprecise", rms_px);
}

void replay_row(const std::string& name, const fs::path& session, double right_mm) {
  const auto run = intake::run_sensor_on_session({.session = session,
                                                  .sensor_file = {},
                                                  .sensor_options = {},
                                                  .program = fs::path{BITELINE_SENSOR},
                                                  .progress = {},
                                                  .on_profile = {}});
  const auto mesh = cloud::read_mesh(session / "truth/reference.ply");
  if (!run || !mesh) return row(name, "failed", 0);
  const auto error = evaluation::cloud_error(run->cloud, evaluation::ReferenceSurface{*mesh});
  const bool right = error.rms_mm <= right_mm && error.q999_mm <= 4 * right_mm;
  row(name, right ? "right" : "imprecise", error.rms_mm);
}

void run() {
  replay_row("stripe, golden part", k_golden / "part", 0.0105);
  if (const auto session = test::shared_data("sessions/sport3"))
    replay_row("stripe, sport3", *session, 0.0105);
  print_row();
  calibration_row("calibration, golden head", k_golden / "head");
  if (const auto folder = test::shared_data("calib/head21")) calibration_row("calibration, head21", *folder);
  line_rows();
  pushed_row();
  sweep_rows();
  material_row();
  shape_rows();
  transfer_rows();
  collar_rows();
}

}  // namespace
}  // namespace biteline::bench

int main() {
  biteline::bench::run();
}
