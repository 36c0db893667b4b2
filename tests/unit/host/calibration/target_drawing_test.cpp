// SPDX-License-Identifier: MIT
#include "host/calibration/rings/target_drawing.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <cmath>
#include <sstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::calibration {
namespace {

constexpr RingTarget k_target{
    .rows = 4, .cols = 7, .pitch_mm = 14, .outer_diameter_mm = 12, .inner_diameter_mm = 6, .planes = 2};
constexpr double k_mm_per_point = 25.4 / 72;

/// The content of the only page, as a reader finds it: by the table at the end.
std::string content_of(const std::string& pdf) {
  const std::size_t table = std::stoul(pdf.substr(pdf.rfind("startxref") + 10));
  CHECK_EQUAL(0, pdf.compare(table, 5, "xref\n"));
  std::istringstream rows{pdf.substr(table)};
  std::string word;
  std::size_t first = 0, count = 0;
  rows >> word >> first >> count;
  std::string content;
  for (std::size_t i = first; i < count; ++i) {
    std::size_t place = 0;
    rows >> place >> word >> word;
    if (word != "n") continue;
    const std::string head = std::to_string(i) + " 0 obj\n";
    CHECK_EQUAL(0, pdf.compare(place, head.size(), head));
    const std::size_t length_at = pdf.find("<< /Length ", place);
    if (i != 4) continue;
    const std::size_t length = std::stoul(pdf.substr(length_at + 11));
    const std::size_t begin = pdf.find("stream\n", place) + 7;
    content = pdf.substr(begin, length);
    CHECK_EQUAL(0, pdf.compare(begin + length, 9, "endstream"));
  }
  return content;
}

}  // namespace

TEST_GROUP(TargetDrawing){};

TEST(TargetDrawing, PdfHasEveryRingWhereAndAsLargeAsTheNumbersSay) {
  const TargetSheet sheet = target_sheet(k_target);
  LONGS_EQUAL(56, sheet.rings.size());
  std::istringstream lines{content_of(target_pdf(k_target))};
  std::size_t rings = 0;
  double off_max_mm = 0;
  std::array<double, 2> at{};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words{line};
    std::array<double, 6> p{};
    if (line.ends_with(" c")) {
      for (double& number : p) words >> number;
      // The middle of an arc is where a Bezier curve is farthest off a circle.
      const double x = (at[0] + 3 * p[0] + 3 * p[2] + p[4]) / 8, y = (at[1] + 3 * p[1] + 3 * p[3] + p[5]) / 8;
      const TargetSheet::Ring& ring = sheet.rings.at(rings);
      const double radius_mm =
          std::hypot(x * k_mm_per_point - ring.x_mm, sheet.height_mm - y * k_mm_per_point - ring.y_mm);
      off_max_mm = std::max(off_max_mm, std::abs(radius_mm - sheet.ring_radius_mm));
      at = {p[4], p[5]};
    } else if (line.ends_with(" m")) {
      words >> at[0] >> at[1];
    } else if (line == "s") {
      ++rings;
    }
  }
  LONGS_EQUAL(56, rings);
  // A millionth of a radius of 4.5 mm, twice for the table's six digits.
  DOUBLES_EQUAL(0, off_max_mm, 1e-5);
}

TEST(TargetDrawing, CaptionHasAllNumbersAndFitsTheSheet) {
  for (const std::string& drawing : {target_pdf(k_target), target_svg(k_target)}) {
    STRCMP_CONTAINS("rows: 4, cols: 7, pitch: 14, outer_diameter: 12, inner_diameter: 6, planes: 2",
                    drawing.c_str());
    STRCMP_CONTAINS("50 mm", drawing.c_str());
  }
  const TargetSheet sheet = target_sheet(k_target);
  for (const TargetSheet::Ring& ring : sheet.rings) {
    CHECK(ring.x_mm > 6 && ring.x_mm + 6 < sheet.width_mm && ring.y_mm > 6 &&
          ring.y_mm + 6 < sheet.height_mm);
  }
  // Between the grids lies the cut, and no ring touches it.
  const TargetSheet::Stroke& cut = sheet.strokes.front();
  CHECK(cut.dashed);
  for (const TargetSheet::Ring& ring : sheet.rings) CHECK(std::abs(ring.x_mm - cut.x0_mm) > 6);
}

TEST(TargetDrawing, NumbersBesideItAreReadBack) {
  const test::TemporaryFolder folder;
  const auto read = read_target(folder.write("target.yaml", target_text(k_target)));
  SUCCEEDS(read);
  STRCMP_EQUAL(target_text(k_target).c_str(), target_text(*read).c_str());
  LONGS_EQUAL(2, read->planes);
}

TEST(TargetDrawing, AChessboardHasItsSquaresAndIsReadBack) {
  constexpr RingTarget k_board{
      .rows = 4, .cols = 6, .pitch_mm = 9, .planes = 2, .kind = TargetKind::Chessboard};
  const TargetSheet sheet = target_sheet(k_board);
  LONGS_EQUAL(0, sheet.rings.size());
  LONGS_EQUAL(2 * 18, sheet.squares.size());  // of 5 x 7, the first one black
  const TargetSheet::Square &first = sheet.squares[0], &second = sheet.squares[1];
  DOUBLES_EQUAL(18, second.x_mm - first.x_mm, 1e-9);
  std::istringstream lines{content_of(target_pdf(k_board))};
  std::size_t squares = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.ends_with(" re f")) continue;
    std::istringstream words{line};
    double x = 0, y = 0, width = 0, height = 0;
    words >> x >> y >> width >> height;
    const TargetSheet::Square& square = sheet.squares.at(squares++);
    DOUBLES_EQUAL(square.x_mm, x * k_mm_per_point, 1e-5);
    DOUBLES_EQUAL(square.y_mm, sheet.height_mm - (y + height) * k_mm_per_point, 1e-5);
    DOUBLES_EQUAL(9, width * k_mm_per_point, 1e-5);
    CHECK(square.x_mm > 0 && square.x_mm + 9 < sheet.width_mm);
    CHECK(std::abs(square.x_mm + 4.5 - sheet.strokes.front().x0_mm) > 4.5);  // the cut
  }
  LONGS_EQUAL(36, squares);
  STRCMP_CONTAINS("square_rows: 5, square_cols: 7, pitch: 9", target_svg(k_board).c_str());
  const test::TemporaryFolder folder;
  const auto read = read_target(folder.write("target.yaml", target_text(k_board)));
  SUCCEEDS(read);
  STRCMP_EQUAL(target_text(k_board).c_str(), target_text(*read).c_str());
  CHECK(read->chessboard());
}

}  // namespace biteline::calibration
