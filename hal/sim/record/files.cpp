// SPDX-License-Identifier: MIT
#include "hal/sim/record/files.hpp"

#include <cerrno>
#include <fstream>

namespace biteline::sim {

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", folder.c_str());
  return {};
}

Result<void> write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  return {};
}

}  // namespace biteline::sim
