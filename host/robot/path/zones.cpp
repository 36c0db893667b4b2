// SPDX-License-Identifier: MIT
#include "host/robot/path/zones.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/closed_curve.hpp"

namespace biteline::path {
namespace {

// An outline whose area lies in the middle may be either way round: soles have 2 to 4 % of their length.
constexpr double k_least_lead_ratio = 0.005;
constexpr double k_least_run_mm = 10;

/// How far each place lies from the line's beginning at the heel, as a share of its length, and how far along
/// the shoe.
struct Places {
  std::vector<double> round_ratio, along_ratio;

  explicit Places(std::span<const Vec3> line) {
    const ShoeEnds ends = shoe_ends(line);
    const double length_mm = std::max(1e-9, ends.toe_mm - ends.heel_mm);
    std::size_t heel = 0;
    for (const Vec3& point : line) {
      along_ratio.push_back((point.head<2>().dot(ends.heel_to_toe) - ends.heel_mm) / length_mm);
      if (along_ratio.back() < along_ratio[heel]) heel = along_ratio.size() - 1;
    }
    const std::size_t count = line.size();
    for (std::size_t i = 0; i < count; ++i)
      round_ratio.push_back(static_cast<double>((i + count - heel) % count) / static_cast<double>(count));
  }

  [[nodiscard]] bool within(std::size_t i, const Zone& zone) const {
    switch (zone.where) {
      case Zone::Where::Heel:
        return along_ratio[i] <= zone.reach_ratio;
      case Zone::Where::Toe:
        return along_ratio[i] >= 1 - zone.reach_ratio;
      case Zone::Where::Stretch:
        break;
    }
    const bool behind = round_ratio[i] >= zone.from_ratio, before = round_ratio[i] <= zone.to_ratio;
    return zone.from_ratio < zone.to_ratio ? behind && before : behind || before;
  }
};

/// Share of a zone's own values at a place of it: 0 at a border to what is worked otherwise, 1 from
/// `ramp_steps` on, smooth at both.
double share_at(std::span<const PlaceWork> work, std::size_t i, double ramp_steps) {
  const auto most = static_cast<std::ptrdiff_t>(std::ceil(ramp_steps));
  double steps = ramp_steps;
  for (const std::ptrdiff_t way : {-1, 1}) {
    for (std::ptrdiff_t k = 1; k <= most; ++k) {
      const PlaceWork& other = work[geometry::round_index(i, way * k, work.size())];
      if (other.zone == work[i].zone) continue;
      // What is left out asks for no ramp: the tool enters and leaves as it works.
      if (!other.left_out) steps = std::min(steps, static_cast<double>(k - 1));
      break;
    }
  }
  const double t = ramp_steps > 0 ? steps / ramp_steps : 1;
  return t * t * (3 - 2 * t);
}

/// What the zones say of each place.
void work_in_zones(std::vector<PlaceWork>& work, std::span<const Vec3> line, double spacing_mm,
                   const Process& process) {
  const Places places{line};
  for (std::size_t i = 0; i < work.size(); ++i) {
    for (std::size_t z = 0; z < process.zones.size() && work[i].zone < 0; ++z) {
      if (places.within(i, process.zones[z])) work[i].zone = static_cast<int>(z);
    }
    if (work[i].zone >= 0) work[i].left_out = process.zones[static_cast<std::size_t>(work[i].zone)].left_out;
  }
  for (std::size_t i = 0; i < work.size(); ++i) {
    if (work[i].zone < 0) continue;
    const Zone& zone = process.zones[static_cast<std::size_t>(work[i].zone)];
    const double share = share_at(work, i, zone.ramp_mm / spacing_mm);
    TipPlacement& placement = work[i].placement;
    placement.outward_mm += share * zone.outward_by_mm;
    placement.up_mm += share * zone.up_by_mm;
    placement.tilt_rad += share * zone.tilt_by_rad;
    placement.lead_rad += share * zone.lead_by_rad;
    work[i].speed_ratio = zone.speed_ratio;
  }
}

/// The piece that a place belongs to; none: it is not worked.
const Piece* piece_at(std::span<const Piece> pieces, double mm) {
  const auto holds = [&](const Piece& p) {
    return p.from_mm <= p.to_mm ? mm >= p.from_mm && mm <= p.to_mm : mm >= p.from_mm || mm <= p.to_mm;
  };
  const auto found = std::ranges::find_if(pieces, holds);
  return found == pieces.end() ? nullptr : &*found;
}

/// Nothing beyond them is worked.  A place belongs to one within half a step.
void keep_only(std::vector<PlaceWork>& work, double spacing_mm, const std::vector<Piece>& pieces) {
  std::vector<Piece> wide = pieces;
  for (Piece& p : wide) {
    p.from_mm -= 0.5 * spacing_mm;
    p.to_mm += 0.5 * spacing_mm;
  }
  for (std::size_t i = 0; i < work.size(); ++i) {
    const Piece* piece = piece_at(wide, static_cast<double>(i) * spacing_mm);
    if (piece == nullptr)
      work[i].left_out = true;
    else
      work[i].speed_ratio *= piece->speed_ratio;
  }
}

/// Maximal runs of places that `taken` says yes to; one closed run has as many steps as there are places.
template <class Taken>
std::vector<Run> runs_where(std::size_t count, Taken taken) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < count; ++i) {
    if (!taken(i) || taken((i + count - 1) % count)) continue;
    Run run{.first = i};
    while (taken((i + run.steps + 1) % count)) ++run.steps;
    runs.push_back(run);
  }
  return runs;
}

/// Evenly round the line, about so far apart.
std::vector<Vec3> places_along(const cloud::ClosedLine& line, double spacing_mm) {
  const geometry::ArcLength along{line.points.size(), [&](std::size_t i) { return line.points[i].position; }};
  std::vector<Vec3> places;
  for (const geometry::OnCurve& at : along.even(along.count_for(spacing_mm)))
    places.push_back(at.between(line.points[at.before].position, line.points[at.after].position));
  return places;
}

}  // namespace

Process on_foot(Process process, const std::string& foot) {
  if (foot.empty() || process.foot.empty() || process.foot == foot) return process;
  process.foot = foot;
  for (Zone& zone : process.zones) {
    // Clockwise from the heel's end on the one foot is anticlockwise on the other.
    const double from = zone.from_ratio;
    zone.from_ratio = 1 - zone.to_ratio;
    zone.to_ratio = 1 - from;
  }
  return process;
}

bool needs_foot(const Process& process) {
  const auto stretch = [](const Zone& zone) { return zone.where == Zone::Where::Stretch; };
  return !process.foot.empty() && std::ranges::any_of(process.zones, stretch);
}

std::vector<double> round_ratios(std::span<const Vec3> line) {
  return Places{line}.round_ratio;
}

ShoeEnds shoe_ends(std::span<const Vec3> line) {
  const auto count = static_cast<double>(line.size());
  Vec2 mean = Vec2::Zero();
  for (const Vec3& point : line) mean += point.head<2>() / count;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Vec2 middle = Vec2::Zero();
  double area = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vec2 a = line[i].head<2>() - mean, b = line[(i + 1) % line.size()].head<2>() - mean;
    spread += a * a.transpose();
    const double part = 0.5 * (a.x() * b.y() - a.y() * b.x());
    area += part;
    middle += part * (a + b) / 3;
  }
  const double angle_rad = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  ShoeEnds ends{.heel_to_toe = {std::cos(angle_rad), std::sin(angle_rad)}};
  const auto reach = [&] {
    ends.heel_mm = 1e18;
    ends.toe_mm = -1e18;
    for (const Vec3& point : line) {
      const double mm = point.head<2>().dot(ends.heel_to_toe);
      ends.heel_mm = std::min(ends.heel_mm, mm);
      ends.toe_mm = std::max(ends.toe_mm, mm);
    }
    const double at_mm = (mean + (area != 0 ? Vec2(middle / area) : Vec2::Zero())).dot(ends.heel_to_toe);
    ends.lead_ratio = (at_mm - ends.heel_mm) / std::max(1e-9, ends.toe_mm - ends.heel_mm) - 0.5;
  };
  reach();
  if (ends.lead_ratio < 0) {
    ends.heel_to_toe = -ends.heel_to_toe;
    reach();
  }
  return ends;
}

std::vector<PlaceWork> work_along(std::span<const Vec3> line, double spacing_mm, const Process& process) {
  std::vector<PlaceWork> work(line.size(), PlaceWork{.placement = process.placement});
  if (!process.zones.empty()) work_in_zones(work, line, spacing_mm, process);
  if (!process.only.empty()) keep_only(work, spacing_mm, process.only);
  return work;
}

std::vector<Run> runs_along(std::span<const PlaceWork> work, const Process& process, std::size_t entry,
                            std::size_t overlap) {
  const std::size_t count = work.size();
  const Run closed{.first = entry, .steps = count + overlap};
  const auto all = [&](auto taken) {
    for (std::size_t i = 0; i < count; ++i) {
      if (!taken(i)) return false;
    }
    return true;
  };
  const auto runs_of = [&](auto taken) {
    return all(taken) ? std::vector<Run>{closed} : runs_where(count, taken);
  };
  std::vector<Run> runs = runs_of([&](std::size_t i) { return !work[i].left_out; });
  std::ranges::sort(runs, {}, [&](const Run& run) { return (run.first + count - entry) % count; });
  for (std::size_t z = 0; z < process.zones.size(); ++z) {
    if (process.zones[z].left_out || process.zones[z].passes < 2) continue;
    const std::vector<Run> again =
        runs_of([&](std::size_t i) { return work[i].zone == static_cast<int>(z) && !work[i].left_out; });
    for (int pass = 1; pass < process.zones[z].passes; ++pass)
      runs.insert(runs.end(), again.begin(), again.end());
  }
  return runs;
}

std::vector<Check> check_pieces(const cloud::ClosedLine& line, const Process& process) {
  if (process.only.empty()) return {};
  constexpr double k_spacing_mm = 0.1, k_least_mm = 1;
  const std::vector<Vec3> places = places_along(line, k_spacing_mm);
  double longest_mm = 0;
  for (const Run& run : runs_along(work_along(places, k_spacing_mm, process), process, 0, 0))
    longest_mm = std::max(longest_mm, static_cast<double>(run.steps) * k_spacing_mm);
  Check check{.name = "pieces",
              .passed = longest_mm >= k_least_mm,
              .value = longest_mm,
              .limit = k_least_mm,
              .unit = "mm of the longest piece",
              .arc_mm = -1,
              .detail = {}};
  if (!check.passed) check.detail = "the process's zones leave nothing of them";
  return {check};
}

std::vector<Check> check_zones(const cloud::ClosedLine& line, const Process& process) {
  if (process.zones.empty()) return {};
  constexpr double k_spacing_mm = 1;
  const std::vector<Vec3> places = places_along(line, k_spacing_mm);
  const double lead_ratio = shoe_ends(places).lead_ratio;
  Check ends{.name = "heel and toe",
             .passed = lead_ratio >= k_least_lead_ratio,
             .value = 100 * lead_ratio,
             .limit = 100 * k_least_lead_ratio,
             .unit = "% of its length",
             .arc_mm = -1,
             .detail = {}};
  if (!ends.passed) ends.detail = "the line's shape does not tell its heel from its toe, as zones need it";
  double shortest_mm = cloud::length_mm(line);
  Process whole = process;
  whole.only.clear();
  const std::vector<Run> runs = runs_along(work_along(places, k_spacing_mm, whole), whole, 0, 0);
  for (const Run& run : runs)
    shortest_mm = std::min(shortest_mm, static_cast<double>(run.steps) * k_spacing_mm);
  if (runs.empty()) shortest_mm = 0;
  Check length{.name = "zones",
               .passed = shortest_mm >= k_least_run_mm,
               .value = shortest_mm,
               .limit = k_least_run_mm,
               .unit = "mm of the shortest stretch",
               .arc_mm = -1,
               .detail = {}};
  if (!length.passed)
    length.detail =
        runs.empty() ? "nothing of the line is left to work" : "a stretch between zones is too short";
  return {ends, length};
}

}  // namespace biteline::path
