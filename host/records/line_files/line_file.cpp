// SPDX-License-Identifier: MIT
#include "host/records/line_files/line_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "host/records/line_files/writers.hpp"
#include "host/report/report.hpp"

namespace biteline::line_files {

Result<void> write_line_file(const std::filesystem::path& file, const cloud::ClosedLine& line) {
  struct Format {
    std::string_view ending;
    std::string (*text)(const cloud::ClosedLine&);
  };
  static constexpr std::array k_formats{Format{".ply", ply_text}, Format{".dxf", dxf_text},
                                        Format{".step", step_text}, Format{".stp", step_text},
                                        Format{".json", json_text}};
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".csv") return cloud::write_line(file, line);
  const auto format = std::ranges::find(k_formats, ending, &Format::ending);
  if (format == k_formats.end()) {
    return fail(Errc::InvalidArgument, "%s: a name that ends in .csv .ply .dxf .step .stp or .json expected",
                file.c_str());
  }
  return report::write_file_atomically(file, format->text(line));
}

}  // namespace biteline::line_files
