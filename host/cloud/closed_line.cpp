// SPDX-License-Identifier: MIT
#include "host/cloud/closed_line.hpp"

#include <cmath>
#include <cstdio>

#include "common/csv/table.hpp"
#include "host/report/report.hpp"

namespace biteline::cloud {
namespace {

// Written with six decimals a unit vector is off by 1e-6; 1e-3 catches a lost digit or a swapped field.
constexpr double k_unit_tolerance = 1e-3;

constexpr const char* k_header = "#x [mm],y [mm],z [mm],nx [],ny [],nz [],tx [],ty [],tz [],confidence []\n";

Result<Vec3> read_vector(const csv::Row& row, std::size_t first_field) {
  Vec3 v;
  for (std::size_t i = 0; i < 3; ++i) {
    BITELINE_ASSIGN(v[static_cast<Eigen::Index>(i)], row.number(first_field + i));
  }
  return v;
}

Result<Vec3> read_direction(const csv::Row& row, std::size_t first_field, const std::filesystem::path& file) {
  BITELINE_ASSIGN(const Vec3 v, read_vector(row, first_field));
  if (std::abs(v.norm() - 1) > k_unit_tolerance) {
    return fail(Errc::BadValue, "%s row %d, fields %zu to %zu: a unit vector expected, found length %.4f",
                file.c_str(), row.number(), first_field + 1, first_field + 3, v.norm());
  }
  return Vec3(v.normalized());
}

Result<ClosedLine> at_least_three(ClosedLine line, const std::filesystem::path& file) {
  if (line.points.size() < 3) {
    return fail(Errc::BadFormat, "%s: at least 3 points expected, found %zu", file.c_str(),
                line.points.size());
  }
  return line;
}

}  // namespace

double length_mm(const ClosedLine& line) {
  double sum_mm = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    sum_mm += (line.points[(i + 1) % line.points.size()].position - line.points[i].position).norm();
  }
  return sum_mm;
}

Result<ClosedLine> read_line(const std::filesystem::path& file) {
  ClosedLine line;
  BITELINE_TRY(csv::read_table(file, 10, 10, [&](const csv::Row& row) -> Result<void> {
    LinePoint point;
    BITELINE_ASSIGN(point.position, read_vector(row, 0));
    BITELINE_ASSIGN(point.normal, read_direction(row, 3, file));
    BITELINE_ASSIGN(point.tangent, read_direction(row, 6, file));
    BITELINE_ASSIGN(point.confidence, row.number(9));
    if (point.confidence < 0 || point.confidence > 1) {
      return fail(Errc::BadValue, "%s row %d, field 10: a confidence from 0 to 1 expected", file.c_str(),
                  row.number());
    }
    line.points.push_back(point);
    return {};
  }));
  return at_least_three(std::move(line), file);
}

Result<ClosedLine> read_positions(const std::filesystem::path& file) {
  ClosedLine line;
  // A truth file may carry further columns: only the first three count here.
  constexpr std::size_t k_most_fields = 64;
  BITELINE_TRY(csv::read_table(file, 3, k_most_fields, [&](const csv::Row& row) -> Result<void> {
    LinePoint point{
        .position = Vec3::Zero(), .normal = Vec3::Zero(), .tangent = Vec3::Zero(), .confidence = 0};
    BITELINE_ASSIGN(point.position, read_vector(row, 0));
    line.points.push_back(point);
    return {};
  }));
  return at_least_three(std::move(line), file);
}

Result<void> write_line(const std::filesystem::path& file, const ClosedLine& line) {
  std::string text = k_header;
  char row[320];
  for (const LinePoint& p : line.points) {
    std::snprintf(row, sizeof row, "%.5f,%.5f,%.5f,%.7f,%.7f,%.7f,%.7f,%.7f,%.7f,%.4f\n", p.position.x(),
                  p.position.y(), p.position.z(), p.normal.x(), p.normal.y(), p.normal.z(), p.tangent.x(),
                  p.tangent.y(), p.tangent.z(), p.confidence);
    text += row;
  }
  return report::write_file_atomically(file, text);
}

}  // namespace biteline::cloud
