// SPDX-License-Identifier: MIT
#include "common/stripe/peak_selector.hpp"

#include <CppUTest/TestHarness.h>

#include <memory>

namespace biteline::stripe {

TEST_GROUP(PeakSelector) {
  static constexpr int k_columns = 400;
  std::unique_ptr<Peaks> peaks = std::make_unique<Peaks>();
  std::unique_ptr<Selection> selection = std::make_unique<Selection>();
  std::unique_ptr<PeakSelector> sut = std::make_unique<PeakSelector>(SelectorConfig{});

  void setup() override {
    clear();
  }
  void clear() {
    peaks->column_count = k_columns;
    for (ColumnPeaks& column : peaks->columns) column = {};
  }
  struct Line {
    int first, end;
    double row_px, slope_px;
    float amplitude;
  };
  /// Adds peaks, the strongest of a column first.
  void add(const Line& line) {
    for (int u = line.first; u < line.end; ++u) {
      ColumnPeaks& column = peaks->columns[static_cast<std::size_t>(u)];
      Peak peak{.row_px = static_cast<float>(line.row_px + line.slope_px * (u - line.first)),
                .sigma_row_px = 0.05F,
                .amplitude = line.amplitude,
                .width_px = 5};
      if (column.kept_count == 1 && column.kept[0].amplitude < peak.amplitude)
        std::swap(peak, column.kept[0]);
      column.kept[column.kept_count++] = peak;
      ++column.seen_count;
    }
  }
  float chosen_row(int u) {
    const Selected& selected = selection->columns[static_cast<std::size_t>(u)];
    return peaks->columns[static_cast<std::size_t>(u)]
        .kept[static_cast<std::size_t>(selected.kept_index)]
        .row_px;
  }
  std::uint8_t flags(int u) {
    return selection->columns[static_cast<std::size_t>(u)].flags;
  }
};

TEST(PeakSelector, LongDimStripeWinsOverShortBrightGlare) {
  add({.first = 0, .end = k_columns, .row_px = 100, .slope_px = 0.1, .amplitude = 80});
  add({.first = 150, .end = 190, .row_px = 60, .slope_px = 0.5, .amplitude = 250});
  sut->rt_select(*peaks, *selection);
  for (int u = 0; u < k_columns; ++u) {
    DOUBLES_EQUAL(100 + 0.1 * u, static_cast<double>(chosen_row(u)), 1e-3);
    LONGS_EQUAL(0, flags(u));
  }
}

TEST(PeakSelector, AMirrorImageAlongHalfOfTheStripeDoesNotWinByItsLight) {
  // Black beside patent leather: both halves' stripe dim, the patent leather's mirror image ten times as
  // bright.
  add({.first = 0, .end = k_columns, .row_px = 200, .slope_px = 0, .amplitude = 60});
  add({.first = 180, .end = k_columns, .row_px = 120, .slope_px = 0, .amplitude = 600});
  sut->rt_select(*peaks, *selection);
  for (int u = 0; u < k_columns; ++u) DOUBLES_EQUAL(200, static_cast<double>(chosen_row(u)), 1e-3);
}

TEST(PeakSelector, PreviousProfileDecidesBetweenEquals) {
  // Two stripes, nearly as long and bright; the last profile showed one of them.
  add({.first = 0, .end = k_columns, .row_px = 150, .slope_px = 0, .amplitude = 100});
  sut->rt_select(*peaks, *selection);
  clear();
  add({.first = 0, .end = k_columns, .row_px = 152, .slope_px = 0, .amplitude = 100});
  add({.first = 0, .end = k_columns, .row_px = 60, .slope_px = 0, .amplitude = 130});
  sut->rt_select(*peaks, *selection);
  DOUBLES_EQUAL(152, static_cast<double>(chosen_row(200)), 1e-3);
}

TEST(PeakSelector, SteepWallAndGrooveStayOneStretch) {
  // Rises by three rows per column and falls again, as a groove's walls do.
  add({.first = 0, .end = 100, .row_px = 100, .slope_px = 0, .amplitude = 150});
  for (int u = 100; u < 120; ++u)
    add({.first = u, .end = u + 1, .row_px = 100 + 3.0 * (u - 99), .slope_px = 0, .amplitude = 60});
  for (int u = 120; u < 140; ++u)
    add({.first = u, .end = u + 1, .row_px = 160 - 3.0 * (u - 119), .slope_px = 0, .amplitude = 60});
  add({.first = 140, .end = k_columns, .row_px = 100, .slope_px = 0, .amplitude = 150});
  sut->rt_select(*peaks, *selection);
  int breaks = 0;
  for (int u = 1; u < k_columns; ++u) {
    breaks += selection->columns[static_cast<std::size_t>(u)].joined ? 0 : 1;
    LONGS_EQUAL(0, flags(u) & (k_selection_reflection | k_selection_discontinuous));
  }
  CHECK(breaks <= 3);  // the rims may part it, nothing is lost
}

TEST(PeakSelector, IslandBesideAHoleIsSurfaceAndOneFarAwayIsNot) {
  add({.first = 0, .end = 350, .row_px = 100, .slope_px = 0, .amplitude = 150});
  add({.first = 370, .end = 378, .row_px = 106, .slope_px = 0, .amplitude = 150});
  add({.first = 385, .end = 393, .row_px = 240, .slope_px = 0, .amplitude = 150});
  sut->rt_select(*peaks, *selection);
  LONGS_EQUAL(0, flags(374));
  CHECK(flags(389) & k_selection_reflection);
}

TEST(PeakSelector, SinglePeaksAreDiscontinuous) {
  add({.first = 0, .end = 300, .row_px = 100, .slope_px = 0, .amplitude = 150});
  add({.first = 350, .end = 352, .row_px = 30, .slope_px = 0, .amplitude = 255});
  sut->rt_select(*peaks, *selection);
  CHECK(flags(350) & k_selection_discontinuous);
  CHECK(flags(350) & k_selection_reflection);
  LONGS_EQUAL(-1, selection->columns[345].kept_index);
}

TEST(PeakSelector, DimEndOfAStretchIsMixed) {
  add({.first = 0, .end = 200, .row_px = 100, .slope_px = 0, .amplitude = 150});
  peaks->columns[199].kept[0].amplitude = 40;
  sut->rt_select(*peaks, *selection);
  CHECK(flags(199) & k_selection_edge_mixed);
  LONGS_EQUAL(0, flags(198));
}

TEST(PeakSelector, APoorFitIsSurfaceOnlyWhereBothSidesGoOnToIt) {
  // Speckle on a slope; between two levels three rows to either side; at the end, where one side tells
  // nothing.
  add({.first = 0, .end = 150, .row_px = 100, .slope_px = 0.5, .amplitude = 150});
  add({.first = 150, .end = 250, .row_px = 178, .slope_px = 0, .amplitude = 150});
  for (const std::size_t u : {60U, 61U, 150U, 248U}) peaks->columns[u].kept[0].flags = k_peak_poor_fit;
  peaks->columns[150].kept[0].row_px = 176.2F;
  sut->rt_select(*peaks, *selection);
  LONGS_EQUAL(0, flags(60));
  LONGS_EQUAL(0, flags(61));
  CHECK(flags(150) & k_selection_edge_mixed);
  CHECK(flags(248) & k_selection_edge_mixed);
  LONGS_EQUAL(0, flags(149));
  LONGS_EQUAL(0, flags(151));
}

TEST(PeakSelector, FirstLastAndStrongestAreWhatTheySay) {
  add({.first = 0, .end = k_columns, .row_px = 100, .slope_px = 0, .amplitude = 80});
  add({.first = 0, .end = k_columns, .row_px = 60, .slope_px = 0, .amplitude = 200});
  struct Row {
    PeakChoice choice;
    double row_px;
  };
  for (const Row& row :
       {Row{PeakChoice::First, 60}, Row{PeakChoice::Last, 100}, Row{PeakChoice::Strongest, 60}}) {
    sut = std::make_unique<PeakSelector>(SelectorConfig{.choice = row.choice});
    sut->rt_select(*peaks, *selection);
    DOUBLES_EQUAL(row.row_px, static_cast<double>(chosen_row(7)), 1e-3);
  }
}

TEST(PeakSelector, NoiseInEveryColumnIsBoundedWork) {
  // Two unrelated peaks in each column: nothing links, everything is flagged.
  for (int u = 0; u < k_columns; ++u) {
    add({.first = u, .end = u + 1, .row_px = (u * 7919) % 300 + 20.0, .slope_px = 0, .amplitude = 100});
    add({.first = u, .end = u + 1, .row_px = (u * 104729) % 300 + 400.0, .slope_px = 0, .amplitude = 90});
  }
  sut->rt_select(*peaks, *selection);
  int flagged = 0;
  for (int u = 0; u < k_columns; ++u) flagged += (flags(u) & k_selection_reflection) != 0 ? 1 : 0;
  CHECK(flagged > k_columns * 8 / 10);
}

}  // namespace biteline::stripe
