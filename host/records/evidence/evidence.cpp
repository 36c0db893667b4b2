// SPDX-License-Identifier: MIT
#include "host/records/evidence/evidence.hpp"

#include "host/bite_line/edit/versions.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::evidence {
namespace {

namespace fs = std::filesystem;

struct File {
  const char* name;
  std::string memory::Evidence::*sha256;
  const char* next;
};

// The line first: it is what people edit.
constexpr const char* k_mend = "mend it in the page or by `biteline line edit`, or scan again";
constexpr File k_files[] = {
    {"line.csv", &memory::Evidence::line, k_mend},
    {"cloud.ply", &memory::Evidence::cloud, "scan the shoe again"},
    {"process.yaml", &memory::Evidence::process, "choose the process again, or scan again"},
    {"report.json", &memory::Evidence::report, "scan the shoe again"},
};

bool changed(const File& file, const memory::Evidence& written, const memory::Evidence& now) {
  return !(written.*file.sha256).empty() && now.*file.sha256 != written.*file.sha256;
}

}  // namespace

Result<memory::Evidence> of_folder(const fs::path& scan) {
  memory::Evidence now;
  for (const File& file : k_files) {
    std::error_code error;
    if (!fs::exists(scan / file.name, error)) continue;
    BITELINE_ASSIGN(now.*file.sha256, digest_of_file(scan / file.name));
  }
  return now;
}

std::optional<std::string> change(const memory::Evidence& written, const memory::Evidence& now) {
  for (const File& file : k_files) {
    if (!changed(file, written, now)) continue;
    const bool gone = (now.*file.sha256).empty();
    return std::string{file.name} + (gone ? " is gone" : " was changed") + " since the service wrote it; " +
           file.next;
  }
  return std::nullopt;
}

std::optional<std::string> mended_since(const fs::path& scan, const memory::Evidence& written,
                                        const memory::Evidence& now, int known) {
  // A mend writes line and report anew, and nothing else of these; the line may come out as it was.
  if (now.line.empty() || now.cloud != written.cloud || now.process != written.process) return std::nullopt;
  const Result<std::vector<edit::Version>> versions = edit::read_versions(scan);
  if (!versions || versions->back().version <= known || versions->back().sha256 != now.line)
    return std::nullopt;
  const edit::Version& newest = versions->back();
  return "version " + std::to_string(newest.version) + " of the line, by " + newest.who;
}

}  // namespace biteline::evidence
