// SPDX-License-Identifier: MIT
#pragma once
/// \file The library by models: which samples, of which feet and sizes, each has.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/transfer/library.hpp"

namespace biteline::transfer {

struct SavedSample {
  std::string name;  ///< in the library
  ModelMade made{};
};

/// Samples of one model, by their names.
struct SavedModel {
  std::string name;
  std::vector<SavedSample> samples;
};

/// An order of a model, as far as it goes; empty: as the shape says.
struct ModelOrder {
  std::string model{};  ///< a model's name, or that of one of its samples
  std::string foot{};   ///< left or right
  std::string size{};   ///< see sizes.hpp
};

/// By name; `damaged` gets what has no readable model.json.  No other file is read.
[[nodiscard]] Result<std::vector<SavedModel>> saved_models(const Library& library,
                                                           std::vector<ModelInfo>& damaged);

/// The model of that name with all its samples, or the one sample of that name alone.
/// Fails (FileNotFound) naming it.
[[nodiscard]] Result<SavedModel> saved_model(const Library& library, const std::string& name);

/// The sample of the model that is farthest in size from `size`; null where none is of another one.
[[nodiscard]] const SavedSample* farthest_in_size(const SavedModel& model, const std::string& size);
/// Both say their foot, and they are two.
[[nodiscard]] bool of_both_feet(const ModelMade& one, const ModelMade& other);

/// The process that is saved with `sample`, else with another of the model's; empty: with none.
[[nodiscard]] std::filesystem::path process_of(const Library& library, const std::string& model,
                                               const std::string& sample);

/// left for right; empty for anything else.
[[nodiscard]] std::string other_foot(const std::string& foot);

}  // namespace biteline::transfer
