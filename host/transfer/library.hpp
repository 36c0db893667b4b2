// SPDX-License-Identifier: MIT
#pragma once
/// \file The models that were taught: finished samples under a name.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/transfer/sample_folder.hpp"

namespace biteline::transfer {

/// When, of what and by what a model was made; texts are empty where nobody said.
struct ModelMade {
  std::string time;  ///< UTC, ISO 8601
  std::string scan, process, size, foot, program;
  std::string of;  ///< the model that this is a sample of; empty: the one of its own name
  int version{1};  ///< goes up when a model is replaced
};

struct SaveOptions {
  std::filesystem::path process_file{};  ///< else the sample folder's own process.yaml
  bool replace{false};
  ModelMade made{};
};

struct ModelInfo {
  std::string name;
  std::size_t points{0};
  double line_length_mm{0};
  bool has_process{false};
  ModelMade made{};
  std::optional<Error> damage{};  ///< why it cannot be used
};

/// One folder per model: the sample's files and model.json with the size and CRC-32C of each.  A model is
/// written beside and put in place in one step, so that another process sees the old one, the new one or
/// none, and never half of one; what a reader takes in is checked against model.json. Thread: no state but
/// the folder's name; several processes may work on one library.
class Library {
 public:
  explicit Library(std::filesystem::path folder) : folder_{std::move(folder)} {}

  /// $XDG_DATA_HOME/biteline/models, or ~/.local/share/biteline/models.
  [[nodiscard]] static std::filesystem::path default_folder();

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path path_of(const std::string& name) const { return folder_ / name; }

  /// Copies cloud, line and, where they exist, process and picture (stages/6_sequence.png).  The sample must
  /// be readable.  One of the same name is replaced only when told: Errc::InvalidArgument; it is kept for
  /// undo(). Names: letters, digits, '.', '_', '-', 64 at most, no '.' in front.
  [[nodiscard]] Result<ModelInfo> save(const std::string& name, const std::filesystem::path& sample_folder,
                                       const SaveOptions& options = {}) const;
  [[nodiscard]] bool has(const std::string& name) const;
  [[nodiscard]] Result<ModelInfo> info(const std::string& name) const;
  /// Of its model.json alone: the other files may be damaged.
  [[nodiscard]] Result<ModelMade> made(const std::string& name) const;
  /// What was replaced or removed last under this name comes back; what stood there takes its place.
  [[nodiscard]] Result<ModelInfo> undo(const std::string& name) const;

  /// Of all models, sorted; nothing is read.
  [[nodiscard]] Result<std::vector<std::string>> names() const;
  /// By name; a damaged one is listed with its damage.  A library that does not exist yet is empty.
  [[nodiscard]] Result<std::vector<ModelInfo>> list() const;

  /// Fails with the model's name when there is none or when it is damaged.
  [[nodiscard]] Result<SampleFiles> load(const std::string& name) const;

  [[nodiscard]] Result<void> remove(const std::string& name) const;
  /// One step; nothing of the new name may exist: Errc::InvalidArgument.  Jobs, tables and undo() keep the
  /// old name.
  [[nodiscard]] Result<ModelInfo> rename(const std::string& name, const std::string& new_name) const;

  /// The model as one file (host/records/archive, kind "model"), with process, picture and where it came
  /// from.
  [[nodiscard]] Result<void> export_to(const std::string& name, const std::filesystem::path& target) const;
  /// Back from that file; under `name`, or under its own when that is empty.  One of the same name is
  /// replaced only when told, and kept for undo().  A file that is not whole changes nothing.
  [[nodiscard]] Result<ModelInfo> import_from(const std::filesystem::path& file, const std::string& name,
                                              bool replace) const;

 private:
  std::filesystem::path folder_;
};

/// `sample` is the folder of a finished sample, else the name of a saved model.
[[nodiscard]] Result<SampleFiles> find_sample(const std::string& sample, const Library& library);

}  // namespace biteline::transfer
