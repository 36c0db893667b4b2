// SPDX-License-Identifier: MIT
#pragma once
/// \file index.html of a result folder: what was found, how good, how long it took, with the pictures beside
/// it.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::report {

/// Builds one page of headings, figures, pictures and links; needs no network, and reads without its scripts.
/// Light and dark.  Texts are escaped.
class Page {
 public:
  enum class Mood { Good, Look, Refused, Plain };  ///< Look: found, but a person should look at it

  /// `verdict` stands large under the title.
  Page(const std::string& title, const std::string& verdict, Mood mood);

  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// Name and value, a row each.
  void figures(const std::vector<std::pair<std::string, std::string>>& rows);
  /// A table with a heading for each column; rows as wide as the heading.
  void table(const std::vector<std::string>& headings, const std::vector<std::vector<std::string>>& rows);
  /// Bars of the stages' seconds.
  void durations(const std::vector<std::pair<std::string, double>>& stages_s);
  /// `file` relative to the page.
  void picture(const std::string& file, const std::string& caption);
  void link(const std::string& file, const std::string& text);
  /// Another page of the folder shown inside this one.
  void frame(const std::string& file, int height_px);

  /// What a script fills: `otherwise` stands there until then.
  void place(const std::string& id, const std::string& otherwise);
  /// A script beside the page, run after everything before it was read.
  void script(const std::string& file);

  [[nodiscard]] Result<void> write(const std::filesystem::path& file) const;

 private:
  std::string title_;
  std::string body_;
};

/// "12.3 ms", "4.56 s": three digits that a person can compare.
[[nodiscard]] std::string seconds_text(double seconds);

/// `value` with three digits after the point and its unit.
[[nodiscard]] std::string value_text(double value, const std::string& unit);

}  // namespace biteline::report
