// SPDX-License-Identifier: MIT
#include "host/cloud/closed_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <string_view>

#include "common/core/fixed_text.hpp"
#include "common/core/numbers.hpp"
#include "common/csv/table.hpp"
#include "host/cloud/far_line.hpp"
#include "host/cloud/source_word.hpp"
#include "host/report/report.hpp"

namespace biteline::cloud {
namespace {

// Written with six decimals a unit vector is off by 1e-6; 1e-3 catches a lost digit or a swapped field.
constexpr double k_unit_tolerance = 1e-3;

/// 100 000 km: a double still holds a thousandth of a millimetre.
constexpr NumberRange k_anywhere_mm{.minimum = -1e11, .maximum = 1e11};

constexpr const char* k_header = "#x [mm],y [mm],z [mm],nx [],ny [],nz [],tx [],ty [],tz [],confidence []";
constexpr const char* k_optional_header = ",u95 [mm],flags [],source []";
constexpr std::size_t k_fields = 10, k_u95 = 10, k_flags = 11, k_source = 12, k_all_fields = 13;

constexpr std::array<std::string_view, 4> k_source_words{"seen", "bridged", "carried", "mended"};

Result<Vec3> read_vector(const csv::Row& row, std::size_t first_field, NumberRange range = k_plausible_mm) {
  Vec3 v;
  for (std::size_t i = 0; i < 3; ++i) {
    BITELINE_ASSIGN(v[static_cast<Eigen::Index>(i)], row.number(first_field + i, range));
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

Result<std::optional<double>> read_u95(const csv::Row& row, const std::filesystem::path& file) {
  if (row.text(k_u95).empty()) return std::optional<double>{};
  BITELINE_ASSIGN(const double u95_mm, row.number(k_u95));
  if (!(u95_mm >= 0)) {
    return fail(Errc::BadValue, "%s row %d, field %zu: a U95 of 0 mm or more expected", file.c_str(),
                row.number(), k_u95 + 1);
  }
  return std::optional{u95_mm};
}

Result<std::uint32_t> read_flags(const csv::Row& row, const std::filesystem::path& file) {
  BITELINE_ASSIGN(const std::int64_t flags, row.integer(k_flags));
  if (flags < 0 || flags > std::numeric_limits<std::uint32_t>::max()) {
    return fail(Errc::BadValue, "%s row %d, field %zu: flags from 0 to 2^32 - 1 expected", file.c_str(),
                row.number(), k_flags + 1);
  }
  return static_cast<std::uint32_t>(flags);
}

Result<PointSource> read_source(const csv::Row& row, const std::filesystem::path& file) {
  const std::string_view word = row.text(k_source);
  const auto at = std::find(k_source_words.begin(), k_source_words.end(), word);
  if (at == k_source_words.end()) {
    return fail(Errc::BadValue,
                "%s row %d, field %zu: seen, bridged, carried or mended expected, found '%.20s'",
                file.c_str(), row.number(), k_source + 1, std::string(word).c_str());
  }
  return static_cast<PointSource>(at - k_source_words.begin());
}

/// The columns that a file may lack, as far as this row has them.
Result<void> read_optional(const csv::Row& row, const std::filesystem::path& file, LinePoint& point) {
  if (row.size() > k_u95) {
    BITELINE_ASSIGN(point.u95_mm, read_u95(row, file));
  }
  if (row.size() > k_flags) {
    BITELINE_ASSIGN(point.flags, read_flags(row, file));
  }
  if (row.size() > k_source) {
    BITELINE_ASSIGN(point.source, read_source(row, file));
  }
  return {};
}

bool has_optional(const ClosedLine& line) {
  return std::any_of(line.points.begin(), line.points.end(), [](const LinePoint& p) {
    return p.u95_mm || p.flags != 0 || p.source != PointSource::Seen;
  });
}

Result<ClosedLine> at_least_three(ClosedLine line, const std::filesystem::path& file) {
  if (line.points.size() < 3) {
    return fail(Errc::BadFormat, "%s: at least 3 points expected, found %zu", file.c_str(),
                line.points.size());
  }
  return line;
}

Result<ClosedLine> line_of(const std::filesystem::path& file, NumberRange places) {
  ClosedLine line;
  BITELINE_TRY(csv::read_table(file, k_fields, k_all_fields, [&](const csv::Row& row) -> Result<void> {
    LinePoint point;
    BITELINE_ASSIGN(point.position, read_vector(row, 0, places));
    BITELINE_ASSIGN(point.normal, read_direction(row, 3, file));
    BITELINE_ASSIGN(point.tangent, read_direction(row, 6, file));
    BITELINE_ASSIGN(point.confidence, row.number(9));
    if (point.confidence < 0 || point.confidence > 1) {
      return fail(Errc::BadValue, "%s row %d, field 10: a confidence from 0 to 1 expected", file.c_str(),
                  row.number());
    }
    BITELINE_TRY(read_optional(row, file, point));
    line.points.push_back(point);
    return {};
  }));
  return at_least_three(std::move(line), file);
}

Result<ClosedLine> positions_of(const std::filesystem::path& file, NumberRange places) {
  ClosedLine line;
  // A truth file may carry further columns: only the first three count here.
  constexpr std::size_t k_most_fields = 64;
  BITELINE_TRY(csv::read_table(file, 3, k_most_fields, [&](const csv::Row& row) -> Result<void> {
    LinePoint point{
        .position = Vec3::Zero(), .normal = Vec3::Zero(), .tangent = Vec3::Zero(), .confidence = 0};
    BITELINE_ASSIGN(point.position, read_vector(row, 0, places));
    line.points.push_back(point);
    return {};
  }));
  return at_least_three(std::move(line), file);
}

}  // namespace

std::string_view source_word(PointSource source) {
  return k_source_words.at(static_cast<std::size_t>(source));
}

void flag_unsure(LinePoint& point) {
  if (!(point.confidence >= k_sure_ratio && point.u95_mm.value_or(0) <= k_sure_mm))
    point.flags |= k_line_unsure;
}

double length_mm(const ClosedLine& line) {
  double sum_mm = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    sum_mm += (line.points[(i + 1) % line.points.size()].position - line.points[i].position).norm();
  }
  return sum_mm;
}

Result<ClosedLine> read_line(const std::filesystem::path& file) {
  return line_of(file, k_plausible_mm);
}

Result<ClosedLine> read_far_line(const std::filesystem::path& file) {
  return line_of(file, k_anywhere_mm);
}

Result<ClosedLine> read_positions(const std::filesystem::path& file) {
  return positions_of(file, k_plausible_mm);
}

Result<ClosedLine> read_far_positions(const std::filesystem::path& file) {
  return positions_of(file, k_anywhere_mm);
}

Result<void> write_line(const std::filesystem::path& file, const ClosedLine& line) {
  const bool optional = has_optional(line);
  std::string text = std::string{k_header} + (optional ? k_optional_header : "") + "\n";
  char row[320];
  for (const LinePoint& p : line.points) {
    std::snprintf(row, sizeof row, "%.5f,%.5f,%.5f,%.7f,%.7f,%.7f,%.7f,%.7f,%.7f,%.4f", p.position.x(),
                  p.position.y(), p.position.z(), p.normal.x(), p.normal.y(), p.normal.z(), p.tangent.x(),
                  p.tangent.y(), p.tangent.z(), p.confidence);
    text += row;
    if (optional) {
      const std::string u95 = p.u95_mm ? FixedText<32>::format("%.4f", *p.u95_mm).c_str() : "";
      text += "," + u95 + "," + std::to_string(p.flags) + ",";
      text += source_word(p.source);
    }
    text += '\n';
  }
  return report::write_file_atomically(file, text);
}

}  // namespace biteline::cloud
