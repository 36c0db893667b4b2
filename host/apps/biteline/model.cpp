// SPDX-License-Identifier: MIT
// biteline model: the library of models that transfer takes its samples from.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/apps/biteline/command.hpp"
#include "host/report/json_text.hpp"
#include "host/transfer/library.hpp"

namespace biteline::app {
namespace {

struct Options {
  std::string name;
  std::filesystem::path sample, process, library{transfer::Library::default_folder()};
};

nlohmann::ordered_json json_of(const transfer::ModelInfo& model) {
  nlohmann::ordered_json json{{"name", model.name}, {"sound", !model.damage.has_value()}};
  if (model.damage) {
    json["damage"] = to_line(*model.damage);
  } else {
    json["points"] = model.points;
    json["line_length_mm"] = model.line_length_mm;
    json["process"] = model.has_process;
  }
  return json;
}

void say(const transfer::ModelInfo& model) {
  if (model.damage) {
    std::printf("%-20s damaged: %s\n", model.name.c_str(), to_line(*model.damage).c_str());
  } else {
    std::printf("%-20s line %.1f mm, %zu points%s\n", model.name.c_str(), model.line_length_mm, model.points,
                model.has_process ? ", with process" : "");
  }
}

Result<ExitStatus> save(const Options& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const transfer::ModelInfo model,
                  transfer::Library{options.library}.save(options.name, options.sample, options.process));
  if (global.json) {
    std::printf("%s\n", report::to_text(json_of(model)).c_str());
  } else if (!global.quiet) {
    say(model);
  }
  return ExitStatus::Done;
}

Result<ExitStatus> list(const Options& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const std::vector<transfer::ModelInfo> models, transfer::Library{options.library}.list());
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const transfer::ModelInfo& model : models) {
    all.push_back(json_of(model));
    if (!global.json) say(model);
  }
  if (global.json) std::printf("%s\n", report::to_text(all).c_str());
  return ExitStatus::Done;
}

Result<ExitStatus> remove(const Options& options) {
  BITELINE_TRY(transfer::Library{options.library}.remove(options.name));
  return ExitStatus::Done;
}

}  // namespace

void add_model(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("model", "The library of saved samples");
  command->require_subcommand(1);
  command->add_option("--library", options->library, "Folder of the saved models")->capture_default_str();

  CLI::App* save_command = command->add_subcommand(
      "save", "Save a finished sample under a name; an older one of that name is replaced");
  save_command->add_option("name", options->name, "The model's name")->required();
  save_command->add_option("sample", options->sample, "Folder with cloud.ply and line.csv")->required();
  save_command->add_option("--process", options->process, "YAML of the process, kept with the model");
  save_command->callback(
      [options, &context] { context.run = [options, &context] { return save(*options, context.options); }; });

  CLI::App* list_command = command->add_subcommand("list", "What is saved, and whether it is sound");
  list_command->callback(
      [options, &context] { context.run = [options, &context] { return list(*options, context.options); }; });

  CLI::App* remove_command = command->add_subcommand("remove", "Forget a model");
  remove_command->add_option("name", options->name, "The model's name")->required();
  remove_command->callback([options, &context] { context.run = [options] { return remove(*options); }; });
}

}  // namespace biteline::app
