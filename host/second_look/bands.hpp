// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a row's surface was worked: by the likelihood of worked against not, cell by cell.

#include <optional>
#include <span>
#include <vector>

#include "host/second_look/change.hpp"
#include "host/second_look/second_look.hpp"

namespace biteline::second_look {

/// A piece of a row is told worked, or not, where the likelihood of that is larger by this factor's
/// logarithm: pieces begin at some 100 cells, rows are some 1000, and of 100 shoes not one should be told
/// wrong by chance: ln(100 * 1000 * 100).
inline constexpr double k_told = 16;

/// Fewer rows than this, 10 mm of a fast scan's, do not say what the work changes.
inline constexpr std::size_t k_least_shown = 10;

/// What the work changes at a row, as its neighbours show it, and how plain that is.
struct Expected {
  std::vector<Values> change{};    ///< per row; zero where no row shows any
  std::vector<double> evidence{};  ///< per row: the logarithm that its worked plan would bring
};
[[nodiscard]] Expected expected_change(const Change& change, const Zones& zones,
                                       std::span<const std::uint8_t> planned);

/// Cells from `first` to before `end`.
struct Piece {
  std::size_t first{0}, end{0};
  double told{0};  ///< logarithm of its likelihood
};

/// In sums over the whole band grain averages out; in pieces of it, it does not.
enum class SumOver : std::uint8_t { Band, Piece };
/// A row's cells: logarithm of the likelihood of worked over not worked; 0 where nothing is known.
[[nodiscard]] std::vector<double> likelihood_of(const Change& change, const Values& expected, std::size_t row,
                                                SumOver sum);

/// The piece of the largest sum; empty where no cell speaks for worked.
[[nodiscard]] Piece best_piece(std::span<const double> likelihood);

/// Pieces that are told worked, the likeliest first, and between their ends none that is told unworked.
[[nodiscard]] std::vector<Piece> worked_pieces(std::span<const double> likelihood);

/// How many times the expected change a row's cells changed, and its standard deviation.
struct Multiple {
  double ratio{0}, sigma{0};
};
[[nodiscard]] Multiple multiple_of(const Change& change, const Values& expected, std::size_t row,
                                   const Piece& piece);

/// An end of a piece, in cells from the raster's first; between cells, and its standard deviation.
struct End {
  double cell{0}, sigma_cells{0};
};
/// Mean and spread of the end's place by the likelihoods of several rows, summed.
struct EndSearch {
  std::size_t middle{0};  ///< a cell inside the piece
  std::size_t limit{0};   ///< the end is sought from the middle to here
};
[[nodiscard]] End end_of(std::span<const double> likelihood, const EndSearch& search);

}  // namespace biteline::second_look
