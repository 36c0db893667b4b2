// SPDX-License-Identifier: MIT
#include "host/transfer/ready_sample.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <array>
#include <mutex>
#include <utility>

#include "host/transfer/carry/point_surface.hpp"
#include "host/transfer/carry/scan_mesh.hpp"

namespace biteline::transfer {
namespace {

using Walls = std::vector<std::optional<double>>;

/// Where the sample's wall was not seen its line is bridged, too, and keeps its distance.
Walls interpolated(const Walls& seen) {
  Walls walls = seen;
  const std::size_t size = seen.size();
  for (std::size_t i = 0; i < size; ++i) {
    if (seen[i]) continue;
    std::size_t behind = 1, before = 1;
    while (behind < size && !seen[(i + size - behind) % size]) ++behind;
    while (before < size && !seen[(i + before) % size]) ++before;
    if (behind == size) return walls;
    const double share = static_cast<double>(behind) / static_cast<double>(behind + before);
    walls[i] = (1 - share) * *seen[(i + size - behind) % size] + share * *seen[(i + before) % size];
  }
  return walls;
}

Walls walls_of(const RaySurface& sample, const cloud::ClosedLine& line, const Vec3& up) {
  constexpr std::array k_heights_mm{5.0, 6.0, 7.0, 8.0};
  constexpr double k_reach_mm = 15, k_half_window_mm = 3;
  const std::size_t size = line.points.size();
  std::vector<double> sums_mm(size, 0), counts(size, 0);
  tbb::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
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
  Walls walls;
  for (std::size_t i = 0; i < size; ++i) walls.push_back(windowed(i));
  return interpolated(walls);
}

Walls walls_of(const SampleFiles& files, const Vec3& up) {
  if (const auto mesh = ScanMesh::create(files.cloud)) return walls_of(*mesh, files.line, up);
  return walls_of(PointSurface{files.cloud.points}, files.line, up);
}

}  // namespace

struct ReadySample::Made {
  std::once_flag asked_for_sample, asked_for_walls;
  std::optional<Result<Sample>> sample;
  Walls walls_mm;
};

ReadySample::ReadySample(std::shared_ptr<const SampleFiles> files)
    : files_{std::move(files)}, made_{std::make_unique<Made>()} {}
ReadySample::ReadySample(SampleFiles files)
    : ReadySample{std::make_shared<const SampleFiles>(std::move(files))} {}
ReadySample::ReadySample(ReadySample&&) noexcept = default;
ReadySample& ReadySample::operator=(ReadySample&&) noexcept = default;
ReadySample::~ReadySample() = default;

// Isolated: a task taken up while one part is made must not wait for that part.
const Result<Sample>& ReadySample::prepared() const {
  std::call_once(made_->asked_for_sample, [this] {
    tbb::this_task_arena::isolate([this] { made_->sample = prepare_sample(files_->cloud, files_->line); });
  });
  return *made_->sample;
}

const Walls& ReadySample::walls_mm() const {
  std::call_once(made_->asked_for_walls, [this] {
    const Vec3 up = prepared()->T_base_shoe.linear().col(2);
    tbb::this_task_arena::isolate([&] { made_->walls_mm = walls_of(*files_, up); });
  });
  return made_->walls_mm;
}

void ReadySample::make_all() const {
  if (prepared()) (void)walls_mm();
}

}  // namespace biteline::transfer
