// SPDX-License-Identifier: MIT
#pragma once
/// \file Recordings that the centre has asked cells for, in its database.

#include <string>
#include <vector>

#include "host/fleet/centre.hpp"

namespace biteline::fleet {

enum class FetchState { Asked, Coming, Whole, Refused };
[[nodiscard]] const char* to_text(FetchState state);

struct FetchRow {
  std::int64_t number{0};
  std::string cell, book, scan;
  FetchState state{FetchState::Asked};
  std::int64_t have{0}, total{0};  ///< bytes; total 0: not known yet
  std::string sha256;              ///< of the whole, as the cell says
  int tries{0};                    ///< times that what came was not the whole that was told
  std::string words;               ///< why it was refused, or where it stands
  bool online{false};              ///< its cell
};

/// Thread: the centre's owner.
class Recordings {
 public:
  explicit Recordings(Centre& centre) : centre_{centre} {}

  /// The number of the fetch; one that is open already is that one.  Of a scan name that more than one memory
  /// of the cell has had, the newest counts.  Errc::InvalidArgument: the centre knows no such shoe.
  [[nodiscard]] Result<std::int64_t> ask(const std::string& cell, const std::string& scan);
  [[nodiscard]] Result<FetchRow> row(std::int64_t number);
  /// Newest first, at most 200.
  [[nodiscard]] Result<std::vector<FetchRow>> list();
  /// The oldest open one of each cell.
  [[nodiscard]] Result<std::vector<FetchRow>> open();
  /// All but what names it; one that has ended stays as it is.
  [[nodiscard]] Result<void> note(const FetchRow& row);

 private:
  [[nodiscard]] Result<std::vector<FetchRow>> rows(const std::string& where);
  Centre& centre_;
};

}  // namespace biteline::fleet
