// SPDX-License-Identifier: MIT
#include "host/calibration/head/pose_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "common/system/file.hpp"

namespace biteline::calibration {
namespace {

constexpr std::uint64_t k_most_bytes = 1U << 20U;
constexpr const char* k_expected = "view,p_x [mm],p_y [mm],p_z [mm],q_w,q_x,q_y,q_z expected";

bool is_word(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0;
}

/// As a word, or a part of a name as actual_TCP_pose.
bool speaks_of_the_tip(std::string_view line) {
  std::string low{line};
  std::ranges::transform(low, low.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  for (const std::string_view word : {"tcp", "tool", "tip"}) {
    for (std::size_t at = low.find(word); at != std::string::npos; at = low.find(word, at + 1)) {
      const std::size_t end = at + word.size();
      if ((at == 0 || !is_word(low[at - 1])) && (end == low.size() || !is_word(low[end]))) return true;
    }
  }
  return false;
}

bool is_head(std::string_view line) {
  return line.front() == '#' || std::isalpha(static_cast<unsigned char>(line.front())) != 0;
}

Result<void> check_row(const std::filesystem::path& file, std::string_view line) {
  const auto commas = std::ranges::count(line, ','), semicolons = std::ranges::count(line, ';');
  if (semicolons > 0) {
    return fail(Errc::BadFormat,
                "%s: fields parted by semicolons, as a spreadsheet does: %s, with commas and "
                "decimal points",
                file.c_str(), k_expected);
  }
  if (commas == 0 && line.find_first_of(" \t") != std::string_view::npos)
    return fail(Errc::BadFormat, "%s: fields parted by blanks: %s", file.c_str(), k_expected);
  if (commas == 6 || commas == 5) {
    return fail(Errc::BadFormat,
                "%s: x, y, z and a rotation of three numbers, as a UR's pendant shows them?  %s: "
                "millimetres, and the rotation as a quaternion (biteline capture hand-eye writes it)",
                file.c_str(), k_expected);
  }
  return {};
}

}  // namespace

Result<std::vector<session::StampedPose>> read_hand_eye_poses(const std::filesystem::path& file) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_bytes));
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = std::string_view{text}.substr(begin, end - begin);
    begin = end + 1;
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.front())) != 0)
      line.remove_prefix(1);
    if (line.empty()) continue;
    if (!is_head(line)) {
      BITELINE_TRY(check_row(file, line));
      break;
    }
    if (speaks_of_the_tip(line)) {
      return fail(Errc::BadValue,
                  "%s: its head '%.60s' speaks of the tool's tip; poses of the flange expected: "
                  "set the controller's TCP to zero and record them again, or take its offset off",
                  file.c_str(), std::string(line).c_str());
    }
  }
  return session::read_pose_table(file, session::RowOrder::Any);
}

}  // namespace biteline::calibration
