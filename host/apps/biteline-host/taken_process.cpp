// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/taken_process.hpp"

#include <utility>

#include "common/system/file.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::service {

Result<TakenProcess> take_process(const std::filesystem::path& file) {
  BITELINE_ASSIGN(std::string text, read_regular_file(file, k_most_settings_bytes));
  BITELINE_ASSIGN(path::ProcessText parsed, path::parse_process(text, file.string()));
  std::string sha256 = Digest{}.add(text).hex();
  return TakenProcess{.process = std::move(parsed.process),
                      .text = std::move(text),
                      .sha256 = std::move(sha256),
                      .file = file};
}

}  // namespace biteline::service
