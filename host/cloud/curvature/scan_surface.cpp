// SPDX-License-Identifier: MIT
#include "host/cloud/curvature/scan_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/contracts.hpp"

namespace biteline::curvature {

namespace {

constexpr float k_run_mm = 0.25F;
constexpr float k_radius_mm = 1.5F;
/// Profiles farther apart than the radius: the neighbourhood grows to take in those beside, up to here.
constexpr float k_widest_mm = 4.0F;
/// A neighbour that takes part need not be at the radius itself.
constexpr float k_beyond_spacing = 1.3F;
/// Runs looked at to either side of a point's own column: those within the radius, and as many again for rows
/// that are shifted against each other.
constexpr std::ptrdiff_t k_reach_runs = 14;
/// A head that stands still sends profiles of the same place: no more of them than this are kept.
constexpr std::size_t k_most_rows = 256;
constexpr std::size_t k_least_neighbours = 8;
/// Normals of neighbouring runs that differ by more (cosine) stand on two sides of an edge.
constexpr float k_same_side = 0.8F;
constexpr float k_offset_ratio = 1.0F / 3.0F;

template <class Runs>
std::ptrdiff_t at_column(const Runs& runs, float column) {
  return std::lower_bound(runs.begin(), runs.end(), column,
                          [](const auto& run, float c) { return run.column < c; }) -
         runs.begin();
}

/// Calls use(run) for every step-th run of a row about a column.
template <class Runs, class Use>
void for_each_near(const Runs& runs, float column, std::ptrdiff_t step, Use&& use) {
  const std::ptrdiff_t middle = at_column(runs, column);
  for (std::ptrdiff_t k = -k_reach_runs; k <= k_reach_runs; ++k) {
    const std::ptrdiff_t i = middle + k * step;
    if (i >= 0 && i < std::ssize(runs)) use(runs[static_cast<std::size_t>(i)]);
  }
}

template <class Runs>
float spacing_mm(const Runs& now, const Runs& before) {
  std::vector<float> nearest;
  const std::size_t step = std::max<std::size_t>(1, now.size() / 24);
  for (std::size_t i = 0; i < now.size(); i += step) {
    float least = std::numeric_limits<float>::max();
    for_each_near(before, now[i].column, 1, [&](const auto& run) {
      least = std::min(least, (run.place_mm - now[i].place_mm).squaredNorm());
    });
    nearest.push_back(least);
  }
  if (nearest.empty()) return std::numeric_limits<float>::infinity();
  std::nth_element(nearest.begin(), nearest.begin() + std::ssize(nearest) / 2, nearest.end());
  return std::sqrt(nearest[nearest.size() / 2]);
}

}  // namespace

ScanSurface::ScanSurface() : batch_{std::make_unique<Batch>()} {
  batch_->fall = 0.5F;
}

void ScanSurface::add_profile(std::span<const Eigen::Vector3f> points_base,
                              std::span<const std::uint16_t> columns, const Eigen::Vector3f& eye_base) {
  BITELINE_EXPECTS(points_base.size() == columns.size());
  Row next{.eye = eye_base, .way_mm = 0, .runs = {}, .columns = {columns.begin(), columns.end()}};
  for (std::size_t i = 0; i < points_base.size();) {
    const Eigen::Vector3f& start = points_base[i];
    const std::size_t first = i;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    // A point always belongs to its own run: so the loop goes on even where a difference is no number.
    do {
      sum += points_base[i] - start;
      ++i;
    } while (i < points_base.size() && (points_base[i] - start).squaredNorm() < k_run_mm * k_run_mm);
    const auto count = static_cast<float>(i - first);
    next.runs.push_back({.place_mm = start + sum / count,
                         .normal = Eigen::Vector3f::Zero(),
                         .column = 0.5F * static_cast<float>(columns[first] + columns[i - 1]),
                         .mean_per_mm = std::numeric_limits<float>::quiet_NaN(),
                         .points = static_cast<std::uint32_t>(i - first)});
  }
  if (!rows_.empty()) {
    const float step = spacing_mm(next.runs, rows_.back().runs);
    next.way_mm = rows_.back().way_mm + (step <= k_widest_mm ? step : 2 * k_widest_mm);  // else a gap
  }
  rows_.push_back(std::move(next));
  settle(false);
}

void ScanSurface::finish() {
  settle(true);
}

void ScanSurface::settle(bool all) {
  const bool crowded = rows_.size() > k_most_rows;
  for (; with_normals_ < end_row(); ++with_normals_) {
    Row& of = row(with_normals_);
    const float ahead = rows_.back().way_mm - of.way_mm;
    if (!all && !crowded && ahead < k_widest_mm) break;
    choose_neighbours(with_normals_);
    fit_normals(of);
  }
  for (; given_out_ < with_normals_; ++given_out_) {
    Row& of = row(given_out_);
    const std::size_t last = *std::max_element(of.beside.begin(), of.beside.begin() + of.beside_count);
    if (last >= with_normals_) break;
    fit_curvature(of);
    give_out(of);
  }
  std::size_t needed = given_out_;
  for (std::size_t number = given_out_; number < with_normals_; ++number) {
    const Row& of = row(number);
    needed = std::min(needed, *std::min_element(of.beside.begin(), of.beside.begin() + of.beside_count));
  }
  while (first_row_ < needed && (crowded || rows_.back().way_mm - rows_.front().way_mm > 3 * k_widest_mm)) {
    rows_.pop_front();
    ++first_row_;
  }
}

void ScanSurface::choose_neighbours(std::size_t number) {
  Row& of = row(number);
  of.radius_mm = k_radius_mm;
  float spacing = 0;
  for (const std::size_t next : {number - 1, number + 1}) {
    if (next < first_row_ || next >= end_row()) continue;  // number - 1 of 0 is beyond every end
    const float apart = std::abs(row(next).way_mm - of.way_mm);
    if (apart <= k_widest_mm) spacing = std::max(spacing, apart);
  }
  of.radius_mm = std::min(k_widest_mm, std::max(k_radius_mm, k_beyond_spacing * spacing));
  of.beside[of.beside_count++] = number;
  const auto take = [&](std::ptrdiff_t direction) {
    std::ptrdiff_t farthest = 0;
    const auto there = [&](std::ptrdiff_t steps) {
      return static_cast<std::ptrdiff_t>(number) + direction * steps;
    };
    while (there(farthest + 1) >= static_cast<std::ptrdiff_t>(first_row_) &&
           there(farthest + 1) < static_cast<std::ptrdiff_t>(end_row()) &&
           std::abs(row(static_cast<std::size_t>(there(farthest + 1))).way_mm - of.way_mm) <= of.radius_mm)
      ++farthest;
    if (farthest > 0) of.beside[of.beside_count++] = static_cast<std::size_t>(there(farthest));
    if (farthest > 1) of.beside[of.beside_count++] = static_cast<std::size_t>(there((farthest + 1) / 2));
  };
  take(-1);
  take(+1);
}

template <class Use>
void ScanSurface::for_each_batch(Row& of, bool with_normals, Use&& use) {
  Batch& batch = *batch_;
  const float inverse = 1.0F / of.radius_mm;
  const auto step = static_cast<std::ptrdiff_t>(std::ceil(of.radius_mm / k_radius_mm));
  for (std::size_t first = 0; first < of.runs.size(); first += Batch::k_lanes) {
    const std::size_t lanes = std::min(Batch::k_lanes, of.runs.size() - first);
    std::array<bool, Batch::k_lanes> other_rows{};
    batch.rows = 0;
    batch.count.fill(0.0F);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const Run& run = of.runs[first + lane];
      std::size_t count = 0;
      for (std::size_t k = 0; k < of.beside_count; ++k) {
        const Row& other = row(of.beside[k]);
        for_each_near(other.runs, run.column, step, [&](const Run& near) {
          const Eigen::Vector3f d = (near.place_mm - run.place_mm) * inverse;
          if (count == Batch::k_most_neighbours || !(d.squaredNorm() <= 1.0F)) return;
          batch.x[count][lane] = d.x();
          batch.y[count][lane] = d.y();
          batch.z[count][lane] = d.z();
          if (with_normals) {
            batch.nx[count][lane] = near.normal.x();
            batch.ny[count][lane] = near.normal.y();
            batch.nz[count][lane] = near.normal.z();
          }
          ++count;
          other_rows[lane] = other_rows[lane] || k > 0;
        });
      }
      batch.count[lane] = static_cast<float>(count);
      batch.rows = std::max(batch.rows, count);
    }
    use(first, lanes, other_rows);
  }
}

void ScanSurface::fit_normals(Row& of) {
  for_each_batch(of, false, [&](std::size_t first, std::size_t lanes, const auto& other_rows) {
    fit_planes(*batch_);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t i = first + lane;
      Run& run = of.runs[i];
      const Eigen::Vector3f to_eye = (of.eye - run.place_mm).normalized();
      if (other_rows[lane] && batch_->count[lane] >= static_cast<float>(k_least_neighbours)) {
        const Eigen::Vector3f normal{batch_->out_nx[lane], batch_->out_ny[lane], batch_->out_nz[lane]};
        run.normal = normal.dot(to_eye) < 0 ? Eigen::Vector3f(-normal) : normal;
      } else {
        const Eigen::Vector3f along =
            (of.runs[std::min(i + 1, of.runs.size() - 1)].place_mm - of.runs[i == 0 ? 0 : i - 1].place_mm)
                .normalized();
        const Eigen::Vector3f across = to_eye - along.dot(to_eye) * along;
        run.normal = across.norm() > 0.1F ? across.normalized() : to_eye;
      }
    }
  });
}

void ScanSurface::fit_curvature(Row& of) {
  for_each_batch(of, true, [&](std::size_t first, std::size_t lanes, const auto& other_rows) {
    fit_level_sets(*batch_, k_offset_ratio);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (other_rows[lane] && batch_->count[lane] >= static_cast<float>(2 * k_least_neighbours) &&
          batch_->trust[lane] != 0.0F)
        of.runs[first + lane].mean_per_mm = batch_->mean[lane] / of.radius_mm;
    }
  });
}

/// Normals of points lie between those of their run and of the next one to their side.
void ScanSurface::give_out(const Row& of) {
  std::size_t point = 0;
  for (std::size_t i = 0; i < of.runs.size(); ++i) {
    const Run& own = of.runs[i];
    for (std::uint32_t k = 0; k < own.points; ++k, ++point) {
      const float column = of.columns[point];
      const std::size_t other_i = column < own.column ? i - 1 : i + 1;  // 0 - 1 is beyond the end
      Eigen::Vector3f normal = own.normal;
      if (other_i < of.runs.size() && column != own.column) {
        const Run& other = of.runs[other_i];
        const float share = (column - own.column) / (other.column - own.column);
        if (other.normal.dot(own.normal) > k_same_side && std::abs(share) <= 1.0F)
          normal = ((1 - share) * own.normal + share * other.normal).normalized();
      }
      normals_.push_back(normal);
      mean_per_mm_.push_back(own.mean_per_mm);
    }
  }
}

}  // namespace biteline::curvature
