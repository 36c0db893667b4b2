// SPDX-License-Identifier: MIT
#include "tests/bench/second_look/made_work.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"

namespace biteline::bench {
namespace {

constexpr double k_line_step_mm = 0.5;

SE3 draw_place(sim::Random& random) {
  const double yaw_rad = random.uniform({-std::numbers::pi, std::numbers::pi});
  return geometry::make_se3(
      Eigen::Quaterniond{Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ())},
      Vec3{random.uniform({200, 600}), random.uniform({-300, 300}), random.uniform({20, 80})});
}

/// What an arm does not repeat of its way.
class NotRepeated {
 public:
  NotRepeated(sim::Random& random, double turn_mm) : turn_mm_{turn_mm} {
    for (auto& coordinate : waves_)
      for (Wave& wave : coordinate)
        wave = {.count = std::round(turn_mm / random.uniform({50, 400})),
                .cosine = random.gaussian(),
                .sine = random.gaussian()};
  }
  /// About the head, 200 mm from the wall.
  [[nodiscard]] SE3 at(double way_mm) const {
    constexpr double k_repeat_mm = 0.014, k_repeat_rad = 3e-5;
    Twist off;
    for (int i = 0; i < 6; ++i) {
      double sum = 0;
      for (const Wave& wave : waves_[static_cast<std::size_t>(i)]) {
        const double at_rad = 2 * std::numbers::pi * wave.count * way_mm / turn_mm_;
        sum += wave.cosine * std::cos(at_rad) + wave.sine * std::sin(at_rad);
      }
      off[i] = (i < 3 ? k_repeat_mm : k_repeat_rad) * sum / std::sqrt(6.0);
    }
    return geometry::exp_se3(off);
  }

 private:
  struct Wave {
    double count, cosine, sine;
  };
  std::array<std::array<Wave, 6>, 6> waves_{};
  double turn_mm_;
};

cloud::PointCloud as_cloud(const sim::ScannedCloud& scanned) {
  cloud::PointCloud cloud;
  cloud.points = scanned.points;
  cloud.profile = scanned.profile;
  cloud.column = scanned.column;
  cloud.amplitude = scanned.amplitude;
  cloud.width_px = scanned.width_px;
  return cloud;
}

/// Profile by profile, about the head that sees it.
void disturb(cloud::PointCloud& cloud, const sim::MadeShoe& shoe, const SE3& T_base_shoe,
             const NotRepeated& arm) {
  const double profiles = cloud.profile.back() + 1.0;
  SE3 T = SE3::Identity();
  std::uint32_t last = cloud.profile.front() + 1;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.profile[i] != last) {
      last = cloud.profile[i];
      const double way_mm = shoe.perimeter_mm() * last / profiles;
      const sim::Outline::Place place = shoe.outline().at(way_mm);
      const Vec2 eye = place.point + 141 * place.normal;
      SE3 T_base_head = SE3::Identity();
      T_base_head.translation() = T_base_shoe * Vec3{eye.x(), eye.y(), 55};
      T = T_base_head * arm.at(way_mm) * T_base_head.inverse();
    }
    cloud.points[i] = (T * cloud.points[i].cast<double>()).cast<float>();
  }
}

/// Places of the outline for so many faults, 60 mm and more apart.
std::vector<double> fault_places(sim::Random& random, std::size_t count, double perimeter_mm) {
  std::vector<double> places;
  const double part_mm = perimeter_mm / static_cast<double>(count);
  const double first_mm = random.uniform({0, part_mm});
  for (std::size_t i = 0; i < count; ++i)
    places.push_back(first_mm + static_cast<double>(i) * part_mm +
                     random.uniform({0, std::max(0.0, part_mm - 60)}));
  return places;
}

sim::WorkFault draw_fault(sim::Random& random, sim::WorkFault::Kind kind, const sim::BandPlan& plan) {
  using Kind = sim::WorkFault::Kind;
  sim::WorkFault fault{.kind = kind};
  const bool both = random.chance(0.5), lower = random.chance(0.5);
  switch (kind) {
    case Kind::Gap:
      fault.length_mm = random.uniform({1, 20});
      break;
    case Kind::Narrow:
    case Kind::Wide:
      fault.length_mm = random.uniform({6, 30});
      fault.by_mm = random.uniform({1, 1.8});
      fault.low = both || lower;
      fault.high = both || !lower;
      break;
    case Kind::Double:
      fault.length_mm = random.uniform({5, 20});
      break;
    case Kind::Drop:
      fault.length_mm = random.uniform({2, 5});
      fault.by_mm = plan.offset_mm + plan.width_mm / 2 + 0.8 + fault.length_mm / 2;
      break;
  }
  return fault;
}

sim::ShoeParameters parameters_of(const WorkCase& made) {
  const sim::ShoeParameters sample = sim::draw_shoe(made.shoe_class, made.seed);
  return made.bare ? sim::bare_upper_of(sample, 0, 0) : sample;
}

std::vector<sim::TrueLinePoint> line_of(const WorkCase& made, const sim::MadeShoe& shoe) {
  if (!made.bare) return sim::true_line(shoe, k_line_step_mm);
  const sim::MadeShoe sample{sim::draw_shoe(made.shoe_class, made.seed)};
  return sim::carried_line(sim::true_line(sample, k_line_step_mm), shoe);
}

}  // namespace

WorkCase work_case(std::uint64_t first_seed, int index) {
  constexpr std::array k_classes{
      sim::ShoeClass::Deep,     sim::ShoeClass::Shallow, sim::ShoeClass::Step,    sim::ShoeClass::Decorated,
      sim::ShoeClass::Stitched, sim::ShoeClass::Glossy,  sim::ShoeClass::Cupsole, sim::ShoeClass::Vulcanised,
      sim::ShoeClass::Midsole,  sim::ShoeClass::Boot};
  constexpr std::array k_works{sim::Work::WetGlue, sim::Work::DryGlue, sim::Work::ColouredGlue,
                               sim::Work::Ground, sim::Work::Roughed};
  const auto i = static_cast<std::size_t>(index);
  WorkCase made{.shoe_class = k_classes[i % k_classes.size()],
                .seed = first_seed + i,
                .bare = (i / k_classes.size()) % 2 == 0,
                .work = i % 20 == 19 ? sim::Work::Unseen : k_works[(i / 3) % k_works.size()]};
  sim::Random random{made.seed ^ 0x574F524BULL};
  const double low_mm = made.bare ? random.uniform({-2, 0}) : random.uniform({2, 3});
  made.plan.width_mm = random.uniform({5, 10});
  made.plan.offset_mm = low_mm + made.plan.width_mm / 2;
  made.light_ratio = random.uniform({0.6, 1.4});
  if (index % 4 == 3) return made;
  using Kind = sim::WorkFault::Kind;
  constexpr std::array k_kinds{Kind::Gap, Kind::Narrow, Kind::Gap, Kind::Drop,
                               Kind::Gap, Kind::Wide,   Kind::Gap, Kind::Double};
  const sim::MadeShoe shoe{parameters_of(made)};
  const std::vector<double> places = fault_places(random, 3, shoe.perimeter_mm());
  for (std::size_t k = 0; k < places.size(); ++k) {
    made.plan.faults.push_back(draw_fault(random, k_kinds[(i + k * 3) % k_kinds.size()], made.plan));
    made.plan.faults.back().s_mm = places[k];
  }
  return made;
}

MadeWork make_work(const WorkCase& made) {
  sim::ShoeParameters parameters = parameters_of(made);
  sim::MadeShoe shoe{parameters};
  const std::vector<sim::TrueLinePoint> line = line_of(made, shoe);
  sim::Random random{made.seed * 16 + static_cast<std::uint64_t>(made.shoe_class)};
  const SE3 T_base_shoe = draw_place(random);
  parameters.worked = sim::lay_band(shoe, line, made.plan, sim::draw_film(made.work, made.seed));
  MadeWork work{.first = {},
                .second = {},
                .line = {},
                .plan = {.low_mm = made.plan.offset_mm - made.plan.width_mm / 2,
                         .high_mm = made.plan.offset_mm + made.plan.width_mm / 2},
                .faults = {},
                .low_base = {},
                .high_base = {},
                .shoe = std::move(shoe),
                .worked = sim::MadeShoe{parameters},
                .T_base_shoe = T_base_shoe,
                .true_line = line};
  sim::ScanSettings scan{.profile_step_mm = made.profile_step_mm, .seed = made.seed, .stripe = true};
  work.first = as_cloud(sim::scan_quickly(work.shoe, scan, T_base_shoe));
  scan.seed += 1'000'000;
  scan.light_ratio = made.light_ratio;
  scan.begin_s_mm = random.uniform({0, made.profile_step_mm});  // profiles never stand where they stood
  work.second = as_cloud(sim::scan_quickly(work.worked, scan, T_base_shoe));
  disturb(work.second, work.shoe, T_base_shoe, NotRepeated{random, work.shoe.perimeter_mm()});

  std::vector<double> along_mm{0};
  for (std::size_t i = 0; i < line.size(); ++i) {
    const sim::TrueLinePoint& p = line[i];
    work.line.points.push_back({.position = T_base_shoe * p.point_shoe,
                                .normal = T_base_shoe.linear() * p.normal_shoe,
                                .tangent = Vec3::Zero(),
                                .confidence = 1});
    along_mm.push_back(along_mm.back() + (line[(i + 1) % line.size()].point_shoe - p.point_shoe).norm());
    const sim::Section section = work.shoe.section(p.s_mm);
    const sim::WorkedBand::Edges& edges = parameters.worked->edges[i];
    work.low_base.push_back(T_base_shoe * section.point(edges.low_z_mm));
    work.high_base.push_back(T_base_shoe * section.point(edges.high_z_mm));
  }
  for (std::size_t i = 0; i < line.size(); ++i)
    work.line.points[i].tangent = (work.line.points[(i + 1) % line.size()].position -
                                   work.line.points[(i + line.size() - 1) % line.size()].position)
                                      .normalized();
  const auto on_line = [&](double s_mm) {
    const double turn_mm = work.shoe.perimeter_mm();
    const double at = std::fmod(s_mm + turn_mm, turn_mm) / turn_mm * static_cast<double>(line.size());
    const auto before = std::min(static_cast<std::size_t>(at), line.size() - 1);
    return std::lerp(along_mm[before], along_mm[before + 1], at - static_cast<double>(before));
  };
  for (const sim::WorkFault& fault : made.plan.faults)
    work.faults.push_back({.made = fault,
                           .along = {.from_mm = on_line(fault.s_mm - fault.length_mm / 2),
                                     .to_mm = on_line(fault.s_mm + fault.length_mm / 2)}});
  return work;
}

}  // namespace biteline::bench
