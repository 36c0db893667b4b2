// SPDX-License-Identifier: MIT
// biteline model: the library of models that transfer takes its samples from.
#include <ctime>
#include <nlohmann/json.hpp>

#include "common/core/fixed_text.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/model_release.hpp"
#include "host/report/json_text.hpp"
#include "host/transfer/library.hpp"
#include "host/transfer/models.hpp"
#include "host/transfer/shape_store.hpp"

namespace biteline::app {
namespace {

struct ModelOptions {
  std::string name, new_name;
  bool replace{false};
  transfer::ModelMade made;
  ReleaseOrder release;
  std::filesystem::path sample, process, file, library{transfer::Library::default_folder()};
};

nlohmann::ordered_json json_of(const transfer::ModelInfo& model) {
  nlohmann::ordered_json json{{"name", model.name}, {"sound", !model.damage.has_value()}};
  if (model.damage) {
    json["damage"] = to_line(*model.damage);
  } else {
    json["points"] = model.points;
    json["line_length_mm"] = model.line_length_mm;
    json["process"] = model.has_process;
    json["version"] = model.made.version;
    for (const auto& [key, text] : {std::pair{"time", &model.made.time}, std::pair{"size", &model.made.size},
                                    std::pair{"foot", &model.made.foot}, std::pair{"of", &model.made.of},
                                    std::pair{"scan", &model.made.scan}}) {
      if (!text->empty()) json[key] = *text;
    }
  }
  return json;
}

std::string utc_now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm parts{};
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&seconds, &parts));
  return text;
}

std::string words_of(const transfer::ModelInfo& model) {
  using Text = FixedText<400>;
  if (model.damage)
    return Text::format("%-20s damaged: %s", model.name.c_str(), to_line(*model.damage).c_str()).c_str();
  std::string what = model.made.of.empty() ? "" : ", of " + model.made.of;
  for (const std::string& said : {model.made.size, model.made.foot})
    if (!said.empty()) what += ", " + said;
  return Text::format("%-20s line %.1f mm, %zu points%s%s", model.name.c_str(), model.line_length_mm,
                      model.points, model.has_process ? ", with process" : "", what.c_str())
      .c_str();
}

/// What the sample and the others of its model say of sizes.
Result<std::string> grading_words(const ModelOptions& options, report::Report& report) {
  const transfer::Library library{options.library};
  BITELINE_ASSIGN(const transfer::SavedModel model,
                  transfer::saved_model(library, options.made.of.empty() ? options.name : options.made.of));
  const transfer::SavedSample* other = transfer::farthest_in_size(model, options.made.size);
  if (other == nullptr) return std::string{};
  BITELINE_ASSIGN(const std::optional<transfer::TaughtGrading> taught,
                  transfer::ShapeStore{library}.grading_of(
                      options.name, other->name, transfer::of_both_feet(options.made, other->made)));
  report.fields["graded_with"] = other->name;
  report.fields["teaches_grading"] = taught.has_value();
  if (!taught)
    return FixedText<300>::format("\n%s and %s teach no grading: they are of one size, or not of one model",
                                  options.name.c_str(), other->name.c_str())
        .c_str();
  return FixedText<300>::format(
             "\nwith %s it teaches how sizes are graded: for 1 %% of length %.2f %% of width, %.2f %% of "
             "height",
             other->name.c_str(), taught->law.width.mean, taught->law.height.mean)
      .c_str();
}

Result<ExitStatus> save(const ModelOptions& options, const GlobalOptions& global) {
  transfer::ModelMade made = options.made;
  made.time = utc_now();
  made.scan = options.sample.filename().string();
  BITELINE_ASSIGN(const transfer::ModelInfo model,
                  transfer::Library{options.library}.save(
                      options.name, options.sample,
                      {.process_file = options.process, .replace = options.replace, .made = made}));
  report::Report report;
  report.fields = json_of(model);
  BITELINE_ASSIGN(const std::string grading, grading_words(options, report));
  return tell(report, global, words_of(model) + grading);
}

Result<ExitStatus> undo(const ModelOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const transfer::ModelInfo model, transfer::Library{options.library}.undo(options.name));
  report::Report report;
  report.fields = json_of(model);
  return tell(report, global, words_of(model));
}

Result<ExitStatus> list(const ModelOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const std::vector<transfer::ModelInfo> models, transfer::Library{options.library}.list());
  report::Report report;
  report.fields["models"] = nlohmann::ordered_json::array();
  std::string words;
  for (const transfer::ModelInfo& model : models) {
    report.fields["models"].push_back(json_of(model));
    words += (words.empty() ? "" : "\n") + words_of(model);
  }
  // The list is the result: --quiet leaves it.
  return tell(report, {.quiet = false, .json = global.json}, words);
}

Result<ExitStatus> remove(const ModelOptions& options, const GlobalOptions& global) {
  BITELINE_TRY(transfer::Library{options.library}.remove(options.name));
  report::Report report;
  report.fields["removed"] = options.name;
  return tell(report, global, "");
}

Result<ExitStatus> rename(const ModelOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const transfer::ModelInfo model,
                  transfer::Library{options.library}.rename(options.name, options.new_name));
  report::Report report;
  report.fields["name"] = model.name;
  report.fields["was"] = options.name;
  return tell(report, global, "model " + options.name + " is " + model.name + " now");
}

Result<ExitStatus> export_one(const ModelOptions& options, const GlobalOptions& global) {
  BITELINE_TRY(transfer::Library{options.library}.export_to(options.name, options.file));
  report::Report report;
  report.fields["name"] = options.name;
  report.fields["file"] = options.file.string();
  return tell(report, global, "wrote " + options.file.string());
}

Result<ExitStatus> import_one(const ModelOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const transfer::ModelInfo model, transfer::Library{options.library}.import_from(
                                                       options.file, options.name, options.replace));
  report::Report report;
  report.fields = json_of(model);
  return tell(report, global, words_of(model));
}

}  // namespace

void add_model(options::Command& app, Context& context) {
  auto options = std::make_shared<ModelOptions>();
  options::Command* command = app.add_subcommand("model", "The library of saved samples");
  command->require_subcommand(1);
  command->add_option("--library", options->library, "Folder of the saved models")->capture_default_str();

  options::Command* save_command = command->add_subcommand(
      "save", "Save a finished sample under a name; one of that name is replaced with --replace alone");
  save_command->add_option("name", options->name, "The model's name")->required();
  save_command->add_option("sample", options->sample, "Folder with cloud.ply and line.csv")->required();
  save_command->add_option("--process", options->process, "YAML of the process, kept with the model");
  save_command->add_flag("--replace", options->replace, "Put it in the place of the model of this name");
  save_command->add_option("--of", options->made.of,
                           "The model that it is a sample of, where that has several; without: its own name");
  save_command->add_option(
      "--size", options->made.size,
      "As printed in the shoe, e.g. 'EU 42'; with it the sample serves other sizes, too");
  save_command->add_option("--foot", options->made.foot, "left or right; with it the sample serves both feet")
      ->check(options::one_of({"left", "right"}));
  save_command->callback(
      [options, &context] { context.run = [options, &context] { return save(*options, context.options); }; });

  options::Command* list_command = command->add_subcommand("list", "What is saved, and whether it is sound");
  list_command->callback(
      [options, &context] { context.run = [options, &context] { return list(*options, context.options); }; });

  options::Command* undo_command =
      command->add_subcommand("undo", "Bring back what was replaced or removed last under a name");
  undo_command->add_option("name", options->name, "The model's name")->required();
  undo_command->callback(
      [options, &context] { context.run = [options, &context] { return undo(*options, context.options); }; });

  options::Command* export_command = command->add_subcommand("export", "Write a model into one file");
  export_command->add_option("name", options->name, "The model's name")->required();
  export_command->add_option("--out", options->file, "The file, e.g. runner-42.tar")->required();
  export_command->callback([options, &context] {
    context.run = [options, &context] { return export_one(*options, context.options); };
  });

  options::Command* import_command = command->add_subcommand(
      "import", "Take in a model's file; one of its name is replaced with --replace alone");
  import_command->add_option("file", options->file, "A file of `model export`")->required();
  import_command->add_option("--name", options->name, "The model's name here; without: its own");
  import_command->add_flag("--replace", options->replace, "Put it in the place of the model of this name");
  import_command->callback([options, &context] {
    context.run = [options, &context] { return import_one(*options, context.options); };
  });

  options::Command* release_command = command->add_subcommand(
      "release", "Write models and processes into one file that a factory's centre hands to its cells");
  release_command->add_option("name", options->release.name, "The release's name, e.g. autumn-3")->required();
  release_command->add_option("--out", options->release.out, "The file, e.g. autumn-3.tar")->required();
  release_command->add_option("--model", options->release.models, "A model; without: all of the library");
  release_command->add_option("--process", options->release.processes, "YAML of a process; may be repeated");
  release_command->callback([options, &context] {
    context.run = [options, &context] {
      return write_release(options->release, options->library, context.options);
    };
  });

  options::Command* rename_command = command->add_subcommand("rename", "Give a model another name");
  rename_command->add_option("name", options->name, "The model's name")->required();
  rename_command->add_option("new_name", options->new_name, "Its new name; no model may have it")->required();
  rename_command->callback([options, &context] {
    context.run = [options, &context] { return rename(*options, context.options); };
  });

  options::Command* remove_command = command->add_subcommand("remove", "Forget a model");
  remove_command->add_option("name", options->name, "The model's name")->required();
  remove_command->callback([options, &context] {
    context.run = [options, &context] { return remove(*options, context.options); };
  });
}

}  // namespace biteline::app
