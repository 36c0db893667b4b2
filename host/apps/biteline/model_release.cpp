// SPDX-License-Identifier: MIT
#include "host/apps/biteline/model_release.hpp"

#include <algorithm>

#include "host/records/archive/archive.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/release/key_lines.hpp"
#include "host/records/release/manifest.hpp"
#include "host/robot/path/process.hpp"
#include "host/transfer/library.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

Result<void> add_model(const transfer::Library& library, const std::string& name,
                       std::vector<archive::Entry>& entries) {
  BITELINE_TRY(library.load(name));
  const fs::path own = library.path_of(name) / transfer::k_process_file;
  std::error_code error;
  if (fs::exists(own, error)) BITELINE_TRY(path::read_process(own));
  for (const fs::directory_entry& file : fs::directory_iterator{library.path_of(name)}) {
    const std::string leaf = file.path().filename().string();
    if (file.is_regular_file() && !leaf.starts_with("."))
      entries.push_back(
          {.name = std::string{release::k_models} + "/" + name + "/" + leaf, .file = file.path()});
  }
  return {};
}

}  // namespace

Result<ExitStatus> write_release(const ReleaseOrder& order, const fs::path& library_folder,
                                 const GlobalOptions& global) {
  if (!release::is_release_name(order.name))
    return fail(Errc::InvalidArgument,
                "release '%.70s': letters, digits, '.', '_', '-' expected, at most 64, no '.' in front",
                order.name.c_str());
  const transfer::Library library{library_folder};
  std::vector<std::string> models = order.models;
  if (models.empty()) {
    BITELINE_ASSIGN(models, library.names());
  }
  std::vector<archive::Entry> entries;
  for (const std::string& model : models) BITELINE_TRY(add_model(library, model, entries));
  for (const fs::path& process : order.processes) {
    BITELINE_TRY(path::read_process(process));
    entries.push_back({.name = std::string{release::k_processes} + "/" + process.stem().string() + ".yaml",
                       .file = process});
  }
  if (entries.empty())
    return fail(Errc::InvalidArgument, "%.200s has no model, and no --process is given",
                library_folder.c_str());
  std::ranges::sort(entries, {}, &archive::Entry::name);
  if (const auto twice = std::ranges::adjacent_find(entries, {}, &archive::Entry::name);
      twice != entries.end())
    return fail(Errc::InvalidArgument, "%.100s is given twice", twice->name.c_str());
  // No time in it: the same models and processes are the same release.
  BITELINE_TRY(archive::write(order.out,
                              {.kind = release::k_archive_kind,
                               .program = BITELINE_VERSION,
                               .time = {},
                               .more = {{"name", order.name}}},
                              entries));
  release::Manifest manifest{.name = order.name, .sha256 = {}, .bytes = fs::file_size(order.out)};
  if (manifest.bytes > release::k_most_bytes)
    return fail(Errc::InvalidArgument, "%.200s has %llu bytes, at most %llu; leave models out",
                order.out.c_str(), static_cast<unsigned long long>(manifest.bytes),
                static_cast<unsigned long long>(release::k_most_bytes));
  BITELINE_ASSIGN(manifest.sha256, digest_of_file(order.out));
  const std::string beside = order.out.string() + release::k_manifest_suffix;
  BITELINE_TRY(report::write_file_atomically(beside, release::to_text(manifest)));
  report::Report report;
  report.fields["name"] = order.name;
  report.fields["file"] = order.out.string();
  report.fields["sha256"] = manifest.sha256;
  report.fields["bytes"] = manifest.bytes;
  report.fields["models"] = models;
  const std::string words = std::to_string(models.size()) + " models, " +
                            std::to_string(order.processes.size()) + " processes in " + order.out.string() +
                            "; sign it:\nopenssl pkeyutl -sign -rawin -inkey KEY -in " + beside + " -out " +
                            order.out.string() + release::k_signature_suffix;
  return tell(report, global, words);
}

}  // namespace biteline::app
