// SPDX-License-Identifier: MIT
#include "host/transfer/transfer.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "host/cloud/flagged.hpp"
#include "host/transfer/align/diagnosis.hpp"
#include "host/transfer/carry/point_surface.hpp"
#include "host/transfer/carry/scan_mesh.hpp"
#include "host/transfer/uncertainty.hpp"

namespace biteline::transfer {
namespace {

using transfer::Alignment;
using transfer::PlacedPoint;
using transfer::Sample;
using transfer::Upper;

/// What the two scans are made into before anything is compared.
struct Prepared {
  std::optional<Result<Sample>> sample;
  std::optional<Result<Upper>> upper;
  std::optional<Result<transfer::ScanMesh>> mesh;  ///< only of an organised scan
};

Prepared prepare(const SampleFiles& sample, const cloud::PointCloud& upper) {
  Prepared prepared;
  tbb::parallel_invoke([&] { prepared.sample = transfer::prepare_sample(sample.cloud, sample.line); },
                       [&] { prepared.upper = transfer::prepare_upper(upper); },
                       [&] {
                         if (upper.organised()) prepared.mesh = transfer::ScanMesh::create(upper);
                       });
  return prepared;
}

bool has_mesh(const Prepared& prepared) {
  return prepared.mesh && prepared.mesh->has_value();
}

std::vector<PlacedPoint> placed_line(const cloud::ClosedLine& line, const Sample& sample,
                                     const Alignment& alignment) {
  const SE3 T_shoe_base = sample.T_base_shoe.inverse();
  std::vector<PlacedPoint> placed;
  placed.reserve(line.points.size());
  for (const cloud::LinePoint& point : line.points) {
    const Alignment::OnLine on_upper = alignment.placed(
        {.point = T_shoe_base * point.position, .normal = T_shoe_base.linear() * point.normal});
    placed.push_back({.position = on_upper.point,
                      .normal = on_upper.normal,
                      .confidence = point.confidence,
                      .sample_u95_mm = point.u95_mm.value_or(0)});
  }
  return placed;
}

/// Where the sample's wall was not seen its line is bridged, too, and keeps its distance.
void interpolate_walls(std::vector<PlacedPoint>& placed) {
  const std::size_t size = placed.size();
  const std::vector<PlacedPoint> seen = placed;
  for (std::size_t i = 0; i < size; ++i) {
    if (seen[i].wall_mm) continue;
    std::size_t behind = 1, before = 1;
    while (behind < size && !seen[(i + size - behind) % size].wall_mm) ++behind;
    while (before < size && !seen[(i + before) % size].wall_mm) ++before;
    if (behind == size) return;
    const double share = static_cast<double>(behind) / static_cast<double>(behind + before);
    placed[i].wall_mm =
        (1 - share) * *seen[(i + size - behind) % size].wall_mm + share * *seen[(i + before) % size].wall_mm;
  }
}

/// Along each ray to the sample's wall above the line: the mean over some heights above its groove and over a
/// few mm along the line, so that stitches do not count.
void find_walls(const transfer::RaySurface& sample, const cloud::ClosedLine& line, const Vec3& up,
                std::vector<PlacedPoint>& placed) {
  constexpr std::array k_heights_mm{5.0, 6.0, 7.0, 8.0};
  constexpr double k_reach_mm = 15, k_half_window_mm = 3;
  std::vector<double> sums_mm(placed.size(), 0), counts(placed.size(), 0);
  tbb::parallel_for(std::size_t{0}, placed.size(), [&](std::size_t i) {
    const cloud::LinePoint& p = line.points[i];
    const Vec3 level = (p.normal - p.normal.dot(up) * up).normalized();
    for (const double height_mm : k_heights_mm) {
      const auto hit =
          sample.cast({.origin = p.position + height_mm * up, .direction = level, .reach_mm = k_reach_mm});
      if (!hit) continue;
      sums_mm[i] += hit->distance_mm;
      counts[i] += 1;
    }
  });
  const std::size_t size = placed.size();
  const auto half =
      static_cast<std::size_t>(k_half_window_mm * static_cast<double>(size) / cloud::length_mm(line));
  const auto windowed = [&](std::size_t i) -> std::optional<double> {
    double sum_mm = 0, count = 0;
    for (std::size_t k = 0; k <= 2 * half; ++k) {
      sum_mm += sums_mm[(i + size + k - half) % size];
      count += counts[(i + size + k - half) % size];
    }
    return count > 0 ? std::optional{sum_mm / count} : std::nullopt;
  };
  for (std::size_t i = 0; i < size; ++i) placed[i].wall_mm = windowed(i);
  interpolate_walls(placed);
}

/// Mesh where there is one; scattered points where not, and where the mesh leaves gaps.  Gaps of both are
/// bridged as the sample's wall runs.
transfer::CarriedLine carry(const SampleFiles& sample, const Vec3& sample_up, const cloud::PointCloud& upper,
                            const Prepared& prepared, std::vector<PlacedPoint> placed,
                            const transfer::CarryOptions& options) {
  const transfer::ScanMesh* mesh = has_mesh(prepared) ? &**prepared.mesh : nullptr;
  if (mesh != nullptr) {
    transfer::CarriedLine carried = transfer::carry_line(*mesh, placed, options);
    if (carried.hits == carried.rays) return carried;
  }
  const auto sample_mesh = transfer::ScanMesh::create(sample.cloud);
  if (sample_mesh) {
    find_walls(*sample_mesh, sample.line, sample_up, placed);
  } else {
    find_walls(transfer::PointSurface{sample.cloud.points}, sample.line, sample_up, placed);
  }
  const transfer::PointSurface points{upper.points};
  if (mesh == nullptr) return transfer::carry_line(points, placed, options);
  return transfer::carry_line(transfer::FirstOf{*mesh, points}, placed, options);
}

/// Of another size: twice the standard deviation of alignment and of what the fit of two shapes leaves, and
/// how far another reading of the sizes would move the line.
double graded_sigma_mm(const Alignment& alignment) {
  return std::hypot(alignment.line_sigma_mm, alignment.shape_rms_mm) + alignment.rival_mm / 2;
}

void tell_sigmas(const Alignment& alignment, bool graded, const CarryOptions& options,
                 std::vector<PlacedPoint>& placed) {
  if (!graded) return tell_spread(alignment.belief, alignment.placement.T_target_source, options, placed);
  for (PlacedPoint& point : placed) point.sigma_mm = graded_sigma_mm(alignment);
}

std::vector<double> sigmas_of(const std::vector<PlacedPoint>& placed) {
  std::vector<double> sigmas_mm;
  for (const PlacedPoint& point : placed) sigmas_mm.push_back(point.sigma_mm);
  return sigmas_mm;
}

std::vector<double> sigmas_of(const cloud::ClosedLine& line) {
  constexpr double k_u95_sigmas = 1.96;
  std::vector<double> sigmas_mm;
  for (const cloud::LinePoint& point : line.points) sigmas_mm.push_back(*point.u95_mm / k_u95_sigmas);
  return sigmas_mm;
}

/// What both scans do not know of themselves.  The sample's part came with its points.
void tell_of_scans(const cloud::ClosedLine& sample, const uncertainty::WholeScan& upper, const Vec3& up,
                   Transfer& transfer) {
  add_scan(upper, up, transfer.carried.line);
  transfer.sample_u95 = std::all_of(sample.points.begin(), sample.points.end(),
                                    [](const cloud::LinePoint& point) { return point.u95_mm.has_value(); });
  transfer.head_u95 = upper.head.has_value();
  transfer.arm = upper.arm;
}

/// Why a carried line with so much flagged is none, as one that is found; nothing where it is one.
std::optional<Refusal> flagged_refusal(const CarriedLine& carried, const Alignment& alignment) {
  const cloud::Flagged flagged = cloud::flagged_of(carried.line);
  if (!flagged.too_much()) return std::nullopt;
  const auto words = FixedText<240>::format(
      "%.0f %% of the carried line's length is unsure, and U95 is above %.0f mm on another %.0f %% (together "
      "at most %.0f %%); %.0f mm were not seen on the upper and are bridged",
      100 * flagged.unsure, cloud::k_sure_mm, 100 * flagged.uncertain, 100 * cloud::k_most_flagged_share,
      carried.bridged_mm);
  std::string reason = words.c_str();
  if (!alignment.next_step.empty()) reason += "; " + alignment.next_step;
  return Refusal{.code = Refused::TooMuchUnsure, .reason = std::move(reason)};
}

double mean_confidence(const cloud::ClosedLine& line) {
  double sum = 0;
  for (const cloud::LinePoint& point : line.points) sum += point.confidence;
  return line.points.empty() ? 0 : sum / static_cast<double>(line.points.size());
}

Refused code_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::TooLittleOverlap:
      return Refused::TooLittleOverlap;
    case Verdict::DirectionNotFixed:
      return Refused::DirectionNotFixed;
    case Verdict::OtherFoot:
      return Refused::OtherFoot;
    case Verdict::OtherSize:
      return Refused::OtherSize;
    case Verdict::UpsideDown:
      return Refused::UpsideDown;
    case Verdict::OtherModel:
      return Refused::OtherModel;
    case Verdict::Aligned:
    case Verdict::NotConverged:
      break;
  }
  return Refused::AlignmentNotConverged;
}

Transfer refused(Refused code, const Error& why) {
  return {.refusal = Refusal{.code = code, .reason = std::string{why.where.view()}}};
}

/// Each lap ends where the next begins; what was noted stays after an early end.
class LapClock {
 public:
  explicit LapClock(std::vector<report::StageTime>& stages) : stages_{stages} {}
  void lap(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    stages_.push_back({.name = name, .seconds = std::chrono::duration<double>(now - begin_).count()});
    begin_ = now;
  }

 private:
  std::vector<report::StageTime>& stages_;
  std::chrono::steady_clock::time_point begin_{std::chrono::steady_clock::now()};
};

}  // namespace

Transfer transfer_line(const SampleFiles& sample, const cloud::PointCloud& upper,
                       const TransferOptions& options) {
  Transfer transfer;
  LapClock clock{transfer.stages};
  const Prepared prepared = prepare(sample, upper);
  if (!*prepared.sample) return refused(Refused::SampleUnusable, prepared.sample->error());
  if (!*prepared.upper) return refused(Refused::UpperWithoutShoe, prepared.upper->error());
  transfer.from_mesh = has_mesh(prepared);
  clock.lap("prepare");

  const Sample& made_sample = **prepared.sample;
  transfer.alignment = transfer::align(made_sample, **prepared.upper, options.align);
  clock.lap("align");
  const Alignment& alignment = transfer.alignment;
  if (alignment.verdict == Verdict::OtherModel) {
    const Diagnosis diagnosis = diagnose(made_sample, **prepared.upper, options.align, alignment);
    transfer.alignment.verdict = diagnosis.verdict;
    transfer.refusal = Refusal{.code = code_of(diagnosis.verdict), .reason = diagnosis.reason};
    clock.lap("diagnose");
    return transfer;
  }
  const Vec3 up = alignment.placement.T_target_source.linear().col(2);
  const CarryOptions carrying{.direction = options.direction, .up = up, .max_gap_mm = options.max_gap_mm};
  transfer.placed = placed_line(sample.line, made_sample, alignment);
  tell_sigmas(alignment, options.align.grade, carrying, transfer.placed);
  transfer.bound_mm = bound_mm(sigmas_of(transfer.placed));
  if (!alignment.accepted()) {
    transfer.refusal = Refusal{.code = code_of(alignment.verdict), .reason = alignment.reason};
    return transfer;
  }

  const Vec3 sample_up = made_sample.T_base_shoe.linear().col(2);
  transfer.carried = carry(sample, sample_up, upper, prepared, transfer.placed, carrying);
  clock.lap("rays");
  transfer.refusal = transfer.carried.refusal;
  if (!transfer.refusal) {
    tell_of_scans(sample.line, options.upper_scan, up, transfer);
    transfer.bound_mm = bound_mm(sigmas_of(transfer.carried.line));
    transfer.refusal = flagged_refusal(transfer.carried, alignment);
    if (transfer.refusal) transfer.carried.line = {};
  }
  transfer.found = !transfer.refusal;
  transfer.confidence = mean_confidence(transfer.carried.line);
  return transfer;
}

}  // namespace biteline::transfer
