// SPDX-License-Identifier: MIT
// Made shoes, worked with known faults, scanned before and after: which faults the second look finds, what it
// invents, and how far its edges lie off.
//   bench_second_look [first seed] [shoes] [first index] [mm between profiles]
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/bench/second_look/made_work.hpp"

namespace biteline::bench {
namespace {

using second_look::Arc;
using second_look::Fault;
using second_look::FaultKind;
using second_look::Findings;
using Made = sim::WorkFault::Kind;

/// Ends of faults are known to one profile.
constexpr double k_slack_mm = 1.5;
constexpr double k_fault_end_mm = 4;

double way_mm(double from_mm, double to_mm, double line_mm) {
  return std::remainder(to_mm - from_mm, line_mm);
}

bool overlap(const Arc& a, const Arc& b, double line_mm) {
  const auto middle = [&](const Arc& arc) {
    const double length = std::fmod(arc.to_mm - arc.from_mm + line_mm, line_mm);
    return std::pair{arc.from_mm + length / 2, length / 2};
  };
  const auto [at_a, half_a] = middle(a);
  const auto [at_b, half_b] = middle(b);
  return std::abs(way_mm(at_a, at_b, line_mm)) < half_a + half_b + k_slack_mm;
}

FaultKind kind_of(Made made) {
  switch (made) {
    case Made::Gap:
      return FaultKind::Missing;
    case Made::Narrow:
      return FaultKind::Narrow;
    case Made::Wide:
      return FaultKind::Wide;
    case Made::Double:
      return FaultKind::Doubled;
    case Made::Drop:
      break;
  }
  return FaultKind::Beside;
}

/// A drop that lies against the band makes it wide.
bool tells(const Fault& fault, const TrueFault& truth, double line_mm) {
  const bool kind = fault.kind == kind_of(truth.made.kind) ||
                    (truth.made.kind == Made::Drop && fault.kind == FaultKind::Wide);
  return kind && overlap(fault.along, truth.along, line_mm);
}

struct Counts {
  int made{0}, found{0}, not_told{0};
};

struct EdgeTally {
  std::vector<double> off_mm{};
  std::size_t within_u95{0};
};

struct Tally {
  Counts long_gaps{}, short_gaps{}, narrow{}, wide{}, doubled{}, drops{};
  std::array<int, 5> invented{};
  int refused{0}, shoes{0}, clean{0}, clean_ok{0};
  double planned_mm{0}, unclear_mm{0}, unseen_planned_mm{0}, unseen_unclear_mm{0};
  EdgeTally edges{}, edges_at_ends{};
  std::vector<double> gap_end_mm{};
  double seconds{0};

  Counts& counts_of(const TrueFault& fault) {
    switch (fault.made.kind) {
      case Made::Gap:
        return fault.made.length_mm >= 2 ? long_gaps : short_gaps;
      case Made::Narrow:
        return narrow;
      case Made::Wide:
        return wide;
      case Made::Double:
        return doubled;
      case Made::Drop:
        break;
    }
    return drops;
  }
};

double distance_mm(const Vec3& point, const std::vector<Vec3>& closed) {
  double best = 1e9;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    const Vec3 d = closed[(i + 1) % closed.size()] - closed[i];
    const double share = std::clamp((point - closed[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (closed[i] + share * d - point).norm());
  }
  return best;
}

void count_edges(const MadeWork& work, const Findings& found, Tally& tally) {
  for (std::size_t i = 0; i < found.places.size(); i += 2) {
    const second_look::BandPlace& place = found.places[i];
    const Arc here{.from_mm = place.along_mm, .to_mm = place.along_mm};
    const bool at_drop = std::ranges::any_of(work.faults, [&](const TrueFault& truth) {
      return truth.made.kind == Made::Drop && overlap(here, truth.along, found.line_mm);
    });
    if (at_drop) continue;
    // Where a made fault begins or ends the true edge turns by a millimetre in a millimetre.
    const bool at_end = std::ranges::any_of(work.faults, [&](const TrueFault& truth) {
      return std::min(std::abs(way_mm(truth.along.from_mm, place.along_mm, found.line_mm)),
                      std::abs(way_mm(truth.along.to_mm, place.along_mm, found.line_mm))) < k_fault_end_mm;
    });
    EdgeTally& edges = at_end ? tally.edges_at_ends : tally.edges;
    const auto take = [&](const std::optional<second_look::BandEdge>& edge, const std::vector<Vec3>& truth) {
      if (!edge) return;
      const double off_mm = distance_mm(edge->base, truth);
      edges.off_mm.push_back(off_mm);
      edges.within_u95 += off_mm <= edge->u95_mm ? 1 : 0;
      if (off_mm > 0.3 && !at_end)
        std::fprintf(stderr, "  edge off by %.2f (U95 %.2f) at %.0f\n", off_mm, edge->u95_mm, place.along_mm);
    };
    take(place.low, work.low_base);
    take(place.high, work.high_base);
  }
}

void count(const WorkCase& made, const MadeWork& work, const Findings& found, Tally& tally) {
  ++tally.shoes;
  if (made.work == sim::Work::Unseen) {
    tally.unseen_planned_mm += found.planned_mm;
    tally.unseen_unclear_mm += found.unclear_mm;
    for (const Fault& fault : found.faults) ++tally.invented[static_cast<std::size_t>(fault.kind)];
    return;
  }
  if (found.refusal) {
    ++tally.refused;
    return;
  }
  tally.planned_mm += found.planned_mm;
  tally.unclear_mm += found.unclear_mm;
  for (const TrueFault& truth : work.faults) {
    Counts& counts = tally.counts_of(truth);
    ++counts.made;
    const auto hit =
        std::ranges::find_if(found.faults, [&](const Fault& f) { return tells(f, truth, found.line_mm); });
    if (hit != found.faults.end()) {
      ++counts.found;
      if (truth.made.kind == Made::Gap) {
        tally.gap_end_mm.push_back(std::abs(way_mm(truth.along.from_mm, hit->along.from_mm, found.line_mm)));
        tally.gap_end_mm.push_back(std::abs(way_mm(truth.along.to_mm, hit->along.to_mm, found.line_mm)));
      }
    } else if (std::ranges::any_of(found.cannot_tell, [&](const second_look::CannotTell& c) {
                 return overlap(c.along, truth.along, found.line_mm);
               })) {
      ++counts.not_told;
    } else {
      std::fprintf(stderr, "  lost: %s of %.1f mm by %.1f at %.0f to %.0f\n",
                   second_look::name_of(kind_of(truth.made.kind)), truth.made.length_mm, truth.made.by_mm,
                   truth.along.from_mm, truth.along.to_mm);
    }
  }
  for (const Fault& fault : found.faults) {
    const bool true_one = std::ranges::any_of(
        work.faults, [&](const TrueFault& truth) { return tells(fault, truth, found.line_mm); });
    if (true_one) continue;
    ++tally.invented[static_cast<std::size_t>(fault.kind)];
    for (const TrueFault& truth : work.faults)
      std::fprintf(stderr, "    made: %s of %.1f mm at %.0f to %.0f\n",
                   second_look::name_of(kind_of(truth.made.kind)), truth.made.length_mm, truth.along.from_mm,
                   truth.along.to_mm);
    std::fprintf(stderr, "  invented: %s %.1f to %.1f, across %.1f to %.1f\n",
                 second_look::name_of(fault.kind), fault.along.from_mm, fault.along.to_mm, fault.low_mm,
                 fault.high_mm);
  }
  if (work.faults.empty()) {
    ++tally.clean;
    tally.clean_ok += found.faults.empty() ? 1 : 0;
  }
  count_edges(work, found, tally);
}

double at_share(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void print(const char* name, const EdgeTally& t) {
  const auto within =
      static_cast<double>(std::ranges::count_if(t.off_mm, [](double mm) { return mm <= 0.15; }));
  const double edges = std::max(1.0, static_cast<double>(t.off_mm.size()));
  std::printf("%s, %.0f, off [mm]: median %.3f, p95 %.3f, most %.3f; within 0.15 mm %.2f %%, U95 %.2f %%\n",
              name, edges, at_share(t.off_mm, 0.5), at_share(t.off_mm, 0.95), at_share(t.off_mm, 1),
              100 * within / edges, 100 * static_cast<double>(t.within_u95) / edges);
}

void print(const Tally& t) {
  const auto counts = [](const char* name, const Counts& c) {
    std::printf("%-18s %3d of %3d found, of %d it says that it cannot tell\n", name, c.found, c.made,
                c.not_told);
  };
  std::printf("%d shoes, %d refused, %.2f s each\n", t.shoes, t.refused, t.seconds / std::max(1, t.shoes));
  counts("gaps from 2 mm", t.long_gaps);
  counts("gaps below 2 mm", t.short_gaps);
  counts("narrow", t.narrow);
  counts("wide", t.wide);
  counts("doubled", t.doubled);
  counts("drops beside", t.drops);
  std::printf(
      "invented: missing %d, narrow %d, wide %d, beside %d, doubled %d; %d of %d without a fault told so\n",
      t.invented[0], t.invented[1], t.invented[2], t.invented[3], t.invented[4], t.clean_ok, t.clean);
  std::printf("cannot tell: %.2f %% of the length; of work that leaves no trace %.1f %%\n",
              100 * t.unclear_mm / std::max(1.0, t.planned_mm),
              100 * t.unseen_unclear_mm / std::max(1.0, t.unseen_planned_mm));
  print("edges", t.edges);
  print("edges where a fault begins or ends", t.edges_at_ends);
  std::printf("ends of gaps off [mm]: median %.2f, p95 %.2f, most %.2f\n", at_share(t.gap_end_mm, 0.5),
              at_share(t.gap_end_mm, 0.95), at_share(t.gap_end_mm, 1));
}

void run(std::uint64_t first_seed, int shoes, int first_index, double profile_step_mm) {
  Tally tally;
  for (int i = first_index; i < first_index + shoes; ++i) {
    WorkCase made = work_case(first_seed, i);
    made.profile_step_mm = profile_step_mm;
    const MadeWork work = make_work(made);
    const auto begin = std::chrono::steady_clock::now();
    const Findings found = second_look::look_again(work.first, work.second, work.line, work.plan);
    tally.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::fprintf(stderr,
                 "%d %s%s %s: contrast %.0f, light %.2f of %.2f, worked %.0f of %.0f mm, unclear %.0f; %s\n",
                 i, std::string(sim::name_of(made.shoe_class)).c_str(), made.bare ? " upper" : "",
                 std::string(sim::k_work_names[static_cast<std::size_t>(made.work)]).c_str(),
                 found.contrast_ratio, found.light_ratio, made.light_ratio, found.worked_mm, found.planned_mm,
                 found.unclear_mm, found.refusal ? found.refusal->reason.c_str() : "");
    const std::size_t before = tally.edges.off_mm.size();
    count(made, work, found, tally);
    const std::vector<double> own(tally.edges.off_mm.begin() + static_cast<std::ptrdiff_t>(before),
                                  tally.edges.off_mm.end());
    std::fprintf(stderr, "  edges: median %.3f, p95 %.3f\n", at_share(own, 0.5), at_share(own, 0.95));
  }
  print(tally);
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  biteline::bench::run(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 9001,
                       argc > 2 ? std::atoi(argv[2]) : 20, argc > 3 ? std::atoi(argv[3]) : 0,
                       argc > 4 ? std::atof(argv[4]) : 1);
}
