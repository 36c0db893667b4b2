// SPDX-License-Identifier: MIT
#include "host/transfer/models.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "host/transfer/sizes.hpp"

namespace biteline::transfer {

Result<std::vector<SavedModel>> saved_models(const Library& library, std::vector<ModelInfo>& damaged) {
  BITELINE_ASSIGN(const std::vector<std::string> names, library.names());
  std::map<std::string, SavedModel> models;
  for (const std::string& name : names) {
    const Result<ModelMade> made = library.made(name);
    if (!made) {
      damaged.push_back({.name = name, .damage = made.error()});
      continue;
    }
    SavedModel& model = models[made->of.empty() ? name : made->of];
    model.samples.push_back({.name = name, .made = *made});
  }
  std::vector<SavedModel> out;
  for (auto& [name, model] : models) {
    model.name = name;
    out.push_back(std::move(model));
  }
  return out;
}

Result<SavedModel> saved_model(const Library& library, const std::string& name) {
  std::vector<ModelInfo> damaged;
  BITELINE_ASSIGN(std::vector<SavedModel> models, saved_models(library, damaged));
  const auto model = std::ranges::find(models, name, &SavedModel::name);
  if (model != models.end()) return std::move(*model);
  for (SavedModel& other : models) {
    const auto sample = std::ranges::find(other.samples, name, &SavedSample::name);
    if (sample != other.samples.end()) return SavedModel{.name = other.name, .samples = {*sample}};
  }
  const auto broken = std::ranges::find(damaged, name, &ModelInfo::name);
  if (broken != damaged.end()) return tl::unexpected<Error>{*broken->damage};
  return fail(Errc::FileNotFound, "no model %s in %s", name.c_str(), library.folder().c_str());
}

const SavedSample* farthest_in_size(const SavedModel& model, const std::string& size) {
  const std::optional<SizeLabel> own = size_label(size);
  if (!own) return nullptr;
  const SavedSample* farthest = nullptr;
  double most = 0;
  for (const SavedSample& other : model.samples) {
    const std::optional<SizeLabel> label = size_label(other.made.size);
    if (!label || label->system != own->system) continue;
    const double apart = std::abs(label->number - own->number);
    if (apart > most) {
      most = apart;
      farthest = &other;
    }
  }
  return farthest;
}

bool of_both_feet(const ModelMade& one, const ModelMade& other) {
  return !one.foot.empty() && !other.foot.empty() && one.foot != other.foot;
}

std::filesystem::path process_of(const Library& library, const std::string& model,
                                 const std::string& sample) {
  std::error_code error;
  const auto in = [&](const std::string& name) {
    std::filesystem::path file = library.path_of(name) / k_process_file;
    return std::filesystem::exists(file, error) ? file : std::filesystem::path{};
  };
  if (!sample.empty())
    if (std::filesystem::path own = in(sample); !own.empty()) return own;
  const Result<SavedModel> saved = saved_model(library, model);
  if (!saved) return {};
  for (const SavedSample& other : saved->samples)
    if (std::filesystem::path file = in(other.name); !file.empty()) return file;
  return {};
}

std::string other_foot(const std::string& foot) {
  if (foot == "left") return "right";
  if (foot == "right") return "left";
  return {};
}

}  // namespace biteline::transfer
