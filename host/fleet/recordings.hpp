// SPDX-License-Identifier: MIT
#pragma once
/// \file Recordings that the centre has asked cells for, in its database.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/fleet/centre.hpp"
#include "host/fleet/recording_limits.hpp"

namespace biteline::fleet {

/// Removed: it was whole, and went by age or space.
enum class FetchState { Asked, Coming, Whole, Refused, Removed };
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
  bool marked{false};              ///< stays, however old it is
};

/// Thread: the centre's owner.
class Recordings {
 public:
  /// Where a recording that is whole stands.
  using FileOf = std::function<std::filesystem::path(const FetchRow&)>;

  explicit Recordings(Centre& centre) : centre_{centre} {}

  /// The number of the fetch; one that is open already is that one.  Of a scan name that more than one memory
  /// of the cell has had, the newest counts.  Errc::InvalidArgument: the centre knows no such shoe.
  [[nodiscard]] Result<std::int64_t> ask(const std::string& cell, const std::string& scan);
  [[nodiscard]] Result<FetchRow> row(std::int64_t number);
  /// Newest first, at most 200.
  [[nodiscard]] Result<std::vector<FetchRow>> list();
  /// The oldest open one of each cell.
  [[nodiscard]] Result<std::vector<FetchRow>> open();
  /// All but what names it and its mark; one that has ended stays as it is.  One that is whole takes the
  /// place of an older one of the same scan, and its mark.
  [[nodiscard]] Result<void> note(const FetchRow& row);
  /// Of the newest that is whole.  Errc::InvalidArgument: none of this scan is here.
  [[nodiscard]] Result<void> mark(const std::string& cell, const std::string& scan, bool marked);
  /// Removes what is beyond the limits, and notes what is gone.  A file that cannot be removed is told in its
  /// row.
  [[nodiscard]] Result<void> tidy(const RecordingLimits& limits, const FileOf& file_of);

 private:
  [[nodiscard]] Result<std::vector<FetchRow>> rows(const std::string& rest);
  Centre& centre_;
};

}  // namespace biteline::fleet
