// SPDX-License-Identifier: MIT
#include "host/transfer/transfer.hpp"

#include <tbb/parallel_invoke.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "host/bite_line/side/seam.hpp"
#include "host/cloud/flagged.hpp"
#include "host/transfer/align/diagnosis.hpp"
#include "host/transfer/carry/beside_line.hpp"
#include "host/transfer/carry/point_surface.hpp"
#include "host/transfer/carry/scan_mesh.hpp"
#include "host/transfer/uncertainty.hpp"

namespace biteline::transfer {
namespace {

using transfer::Alignment;
using transfer::PlacedPoint;
using transfer::Sample;
using transfer::Upper;

/// What only an organised scan tells: the upper's mesh, and whether it stood still.  Made beside whatever
/// goes on until it is asked for.
class ScanBeside {
 public:
  explicit ScanBeside(const cloud::PointCloud& upper) {
    if (!upper.organised()) return;
    work_.run([this, &upper] { mesh_ = ScanMesh::create(upper); });
    work_.run([this, &upper] { seam_ = bite_line::seam_step(upper); });
  }
  ScanBeside(const ScanBeside&) = delete;
  ScanBeside& operator=(const ScanBeside&) = delete;
  ~ScanBeside() {
    try {
      work_.wait();
    } catch (...) {  // nobody asks for it any more
    }
  }

  void wait() { work_.wait(); }
  /// Null where there is none.  Pre, as of the next: waited for.
  [[nodiscard]] const ScanMesh* mesh() const { return mesh_ && mesh_->has_value() ? &**mesh_ : nullptr; }
  [[nodiscard]] const std::optional<bite_line::SeamStep>& seam() const { return seam_; }

 private:
  tbb::task_group work_;
  std::optional<Result<ScanMesh>> mesh_;
  std::optional<bite_line::SeamStep> seam_;
};

std::vector<PlacedPoint> placed_line(const cloud::ClosedLine& line, const Sample& sample,
                                     const Alignment& alignment, const AlignOptions& align,
                                     const CarryOptions& carrying) {
  const SE3 T_shoe_base = sample.T_base_shoe.inverse();
  std::vector<Alignment::OnLine> on_sample;
  std::vector<PlacedPoint> placed;
  placed.reserve(line.points.size());
  for (const cloud::LinePoint& point : line.points) {
    on_sample.push_back(
        {.point = T_shoe_base * point.position, .normal = T_shoe_base.linear() * point.normal});
    const Alignment::OnLine on_upper = alignment.placed(on_sample.back());
    placed.push_back({.position = on_upper.point,
                      .normal = on_upper.normal,
                      .confidence = point.confidence,
                      .sample_u95_mm = point.u95_mm.value_or(0)});
  }
  if (align.grade)
    tell_graded_spread(alignment, on_sample, carrying, placed);
  else
    tell_spread(alignment.belief, alignment.placement.T_target_source, carrying, placed);
  return placed;
}

/// Mesh where there is one; scattered points where not, and where the mesh leaves gaps.  Gaps of both are
/// bridged as the sample's wall runs.
CarriedLine carry(const ReadySample& sample, const cloud::PointCloud& upper, const ScanMesh* mesh,
                  std::vector<PlacedPoint> placed, const CarryOptions& options) {
  if (mesh != nullptr && all_met(*mesh, placed, options)) return carry_line(*mesh, placed, options);
  std::optional<PointSurface> points;
  tbb::parallel_invoke([&] { points.emplace(points_beside(upper.points, placed, options)); },
                       [&] { (void)sample.walls_mm(); });
  for (std::size_t i = 0; i < placed.size(); ++i) placed[i].wall_mm = sample.walls_mm()[i];
  if (mesh == nullptr) return carry_line(*points, placed, options);
  return carry_line(FirstOf{*mesh, *points}, placed, options);
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
  // Not its owner, and gone before it.
  return transfer_line(ReadySample{std::shared_ptr<const SampleFiles>{std::shared_ptr<void>{}, &sample}},
                       upper, options);
}

Transfer transfer_line(const ReadySample& sample, const cloud::PointCloud& upper,
                       const TransferOptions& options) {
  const cloud::ClosedLine& line = sample.files().line;
  Transfer transfer;
  LapClock clock{transfer.stages};
  ScanBeside beside{upper};
  std::optional<Result<Upper>> made_upper;
  tbb::parallel_invoke([&] { (void)sample.prepared(); }, [&] { made_upper = prepare_upper(upper); });
  if (!sample.prepared()) return refused(Refused::SampleUnusable, sample.prepared().error());
  if (!*made_upper) return refused(Refused::UpperWithoutShoe, made_upper->error());
  clock.lap("prepare");

  const Sample& made_sample = *sample.prepared();
  transfer.alignment = transfer::align(made_sample, **made_upper, options.align);
  beside.wait();
  transfer.seam = beside.seam();
  const ScanMesh* upper_mesh = beside.mesh();
  transfer.from_mesh = upper_mesh != nullptr;
  clock.lap("align");
  const Alignment& alignment = transfer.alignment;
  // A shoe that moved fits no sample, and the other reasons would not be the true one.
  transfer.refusal = why_moved(transfer.seam);
  if (transfer.refusal) return transfer;
  if (alignment.verdict == Verdict::OtherModel) {
    const Diagnosis diagnosis = diagnose(made_sample, **made_upper, options.align, alignment);
    transfer.alignment.verdict = diagnosis.verdict;
    transfer.refusal = Refusal{.code = code_of(diagnosis.verdict), .reason = diagnosis.reason};
    clock.lap("diagnose");
    return transfer;
  }
  const Vec3 up = alignment.placement.T_target_source.linear().col(2);
  const CarryOptions carrying{.direction = options.direction, .up = up, .max_gap_mm = options.max_gap_mm};
  transfer.placed = placed_line(line, made_sample, alignment, options.align, carrying);
  transfer.bound_mm = bound_mm(sigmas_of(transfer.placed));
  if (!alignment.accepted()) {
    transfer.refusal = Refusal{.code = code_of(alignment.verdict), .reason = alignment.reason};
    return transfer;
  }

  transfer.carried = carry(sample, upper, upper_mesh, transfer.placed, carrying);
  clock.lap("rays");
  transfer.refusal = transfer.carried.refusal;
  if (!transfer.refusal) {
    tell_of_scans(line, options.upper_scan, up, transfer);
    transfer.bound_mm = bound_mm(sigmas_of(transfer.carried.line));
    transfer.refusal = flagged_refusal(transfer.carried, alignment);
    if (transfer.refusal) transfer.carried.line = {};
  }
  transfer.found = !transfer.refusal;
  transfer.confidence = mean_confidence(transfer.carried.line);
  return transfer;
}

}  // namespace biteline::transfer
