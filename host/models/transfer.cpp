// SPDX-License-Identifier: MIT
#include "host/models/transfer.hpp"

#include <tbb/parallel_invoke.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "host/surface/point_surface.hpp"
#include "host/surface/scan_mesh.hpp"

namespace biteline::models {
namespace {

using registration::Alignment;
using registration::Sample;
using registration::Upper;
using surface::PlacedPoint;

/// What the two scans are made into before anything is compared.
struct Prepared {
  std::optional<Result<Sample>> sample;
  std::optional<Result<Upper>> upper;
  std::optional<Result<surface::ScanMesh>> mesh;  ///< only of an organised scan
};

Prepared prepare(const SampleFiles& sample, const cloud::PointCloud& upper) {
  Prepared prepared;
  tbb::parallel_invoke([&] { prepared.sample = registration::prepare_sample(sample.cloud, sample.line); },
                       [&] { prepared.upper = registration::prepare_upper(upper); },
                       [&] {
                         if (upper.organised()) prepared.mesh = surface::ScanMesh::create(upper);
                       });
  return prepared;
}

std::vector<PlacedPoint> placed_line(const line::ClosedLine& line, const Sample& sample, const Alignment& alignment) {
  const SE3 T_shoe_base = sample.T_base_shoe.inverse();
  std::vector<PlacedPoint> placed;
  placed.reserve(line.points.size());
  for (const line::LinePoint& point : line.points) {
    const Alignment::OnLine on_upper =
        alignment.placed({.point = T_shoe_base * point.position, .normal = T_shoe_base.linear() * point.normal});
    placed.push_back({.position = on_upper.point, .normal = on_upper.normal, .confidence = point.confidence});
  }
  return placed;
}

/// Mesh where there is one; scattered points where not, and where the mesh leaves gaps.
surface::CarriedLine carry(const cloud::PointCloud& upper, const Prepared& prepared, const std::vector<PlacedPoint>& placed,
                           const surface::CarryOptions& options) {
  const bool has_mesh = prepared.mesh && prepared.mesh->has_value();
  if (!has_mesh) return surface::carry_line(surface::PointSurface{upper.points}, placed, options);
  const surface::ScanMesh& mesh = **prepared.mesh;
  surface::CarriedLine carried = surface::carry_line(mesh, placed, options);
  if (carried.hits == carried.rays) return carried;
  const surface::PointSurface points{upper.points};
  return surface::carry_line(surface::FirstOf{mesh, points}, placed, options);
}

/// Twice the standard deviation of the alignment.  Graded, also what the fit of two shapes leaves, and how far another
/// reading of the sizes would move the line.
double bound_mm(const Alignment& alignment, bool graded) {
  if (!graded) return 2 * alignment.line_sigma_mm;
  return 2 * std::hypot(alignment.line_sigma_mm, alignment.shape_rms_mm) + alignment.rival_mm;
}

double mean_confidence(const line::ClosedLine& line) {
  double sum = 0;
  for (const line::LinePoint& point : line.points) sum += point.confidence;
  return line.points.empty() ? 0 : sum / static_cast<double>(line.points.size());
}

class StageClock {
 public:
  explicit StageClock(std::vector<Stage>& stages) : stages_{stages} {}
  void lap(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    stages_.push_back({.name = name, .seconds = std::chrono::duration<double>(now - begin_).count()});
    begin_ = now;
  }

 private:
  std::vector<Stage>& stages_;
  std::chrono::steady_clock::time_point begin_{std::chrono::steady_clock::now()};
};

}  // namespace

Transfer transfer_line(const SampleFiles& sample, const cloud::PointCloud& upper, const TransferOptions& options) {
  Transfer transfer;
  StageClock clock{transfer.stages};
  const Prepared prepared = prepare(sample, upper);
  for (const Error* error : {prepared.sample->has_value() ? nullptr : &prepared.sample->error(),
                             prepared.upper->has_value() ? nullptr : &prepared.upper->error()}) {
    if (error == nullptr) continue;
    transfer.reason = error->where.view();  // a cloud that holds no surface of a shoe's size
    return transfer;
  }
  transfer.from_mesh = prepared.mesh && prepared.mesh->has_value();
  clock.lap("prepare");

  transfer.alignment = registration::align(**prepared.sample, **prepared.upper, options.align);
  clock.lap("align");
  transfer.bound_mm = bound_mm(transfer.alignment, options.align.grade);
  if (!transfer.alignment.accepted()) {
    transfer.reason = transfer.alignment.reason;
    return transfer;
  }

  const Vec3 up = transfer.alignment.placement.T_target_source.linear().col(2);
  transfer.placed = placed_line(sample.line, **prepared.sample, transfer.alignment);
  transfer.carried = carry(upper, prepared, transfer.placed,
                           {.direction = options.direction, .up = up, .max_gap_mm = options.max_gap_mm, .line_sigma_mm = transfer.bound_mm / 2});
  clock.lap("rays");
  transfer.reason = transfer.carried.reason;
  transfer.found = transfer.reason.empty();
  transfer.confidence = mean_confidence(transfer.carried.line);
  return transfer;
}

}  // namespace biteline::models
