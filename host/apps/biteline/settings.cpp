// SPDX-License-Identifier: MIT
// biteline settings: sets of settings by name; which one a sensor starts with.
#include "common/settings/settings.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/settings_live.hpp"
#include "host/intake/child_process.hpp"
#include "host/intake/sensor_process.hpp"
#include "host/report/json_text.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using settings::Key;
using settings::SettingsSet;

constexpr const char* k_former_file = "start-up.former.yaml";

struct SettingsOptions {
  fs::path store{"/etc/biteline/settings"};
  std::string name, other, note;
  fs::path board, sensor;
  bool back{false};
  SensorAddress running;
};

bool is_name(const std::string& text) {
  const auto usual = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !text.empty() && text.size() <= 64 && std::ranges::all_of(text, usual);
}

/// A file by its path, or a set of the store by its name.
fs::path file_of(const SettingsOptions& options, const std::string& text) {
  return is_name(text) ? options.store / (text + ".yaml") : fs::path{text};
}

nlohmann::ordered_json json_of(const SettingsSet& set) {
  nlohmann::ordered_json json;
  json["file"] = set.file;
  json["note"] = set.note;
  for (std::size_t i = 0; i < settings::k_key_count; ++i) {
    const auto key = static_cast<Key>(i);
    const settings::KeyRow& row = settings::row_of(key);
    const auto& value = set.at(key);
    nlohmann::ordered_json one{{"key", settings::path_of(key)},
                               {"value", value ? settings::value_text(key, *value) : row.usual},
                               {"changed", value.has_value()},
                               {"what", row.what}};
    json["settings"].push_back(std::move(one));
  }
  return json;
}

Result<ExitStatus> show_set(const SettingsOptions& options, const GlobalOptions& global) {
  const fs::path file =
      options.name.empty() ? options.store / settings::k_start_file : file_of(options, options.name);
  BITELINE_ASSIGN(const SettingsSet set, settings::read_settings(file));
  if (global.json) {
    std::printf("%s\n", report::to_text(json_of(set)).c_str());
    return ExitStatus::Done;
  }
  if (!set.note.empty()) std::printf("%s\n", set.note.c_str());
  for (std::size_t i = 0; i < settings::k_key_count; ++i) {
    const auto key = static_cast<Key>(i);
    const auto& value = set.at(key);
    const settings::KeyRow& row = settings::row_of(key);
    std::printf("%c %-26s %-22s %s\n", value ? '*' : ' ', settings::path_of(key).c_str(),
                value ? settings::value_text(key, *value).c_str() : row.usual, row.what);
  }
  std::printf("* set here; all others are as usual\n");
  return ExitStatus::Done;
}

Result<ExitStatus> list_sets(const SettingsOptions& options, const GlobalOptions& global) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator it{options.store, error}, end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == ".yaml" && is_name(it->path().stem().string())) files.push_back(it->path());
  }
  if (error) return fail_errno(Errc::FileNotFound, error.value(), "%s", options.store.c_str());
  std::sort(files.begin(), files.end());
  std::string start;
  if (const auto set = settings::read_settings(options.store / settings::k_start_file))
    start = settings::settings_text(*set);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const fs::path& file : files) {
    const Result<SettingsSet> set = settings::read_settings(file);
    const bool starts = set && settings::settings_text(*set) == start;
    const std::string words = set ? set->note : to_line(set.error());
    rows.push_back(
        {{"name", file.stem().string()}, {"good", set.has_value()}, {"start_up", starts}, {"note", words}});
    if (!global.json) std::printf("%c %-24s %s\n", starts ? '*' : ' ', file.stem().c_str(), words.c_str());
  }
  if (global.json) std::printf("%s\n", report::to_text(rows).c_str());
  return ExitStatus::Done;
}

Result<ExitStatus> compare(const SettingsOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const SettingsSet left, settings::read_settings(file_of(options, options.name)));
  BITELINE_ASSIGN(const SettingsSet right, settings::read_settings(file_of(options, options.other)));
  const std::vector<settings::Difference> differences = settings::compare(left, right);
  if (global.json) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const settings::Difference& one : differences)
      rows.push_back({{"key", settings::path_of(one.key)}, {"left", one.left}, {"right", one.right}});
    std::printf("%s\n", report::to_text(rows).c_str());
    return ExitStatus::Done;
  }
  for (const settings::Difference& one : differences)
    std::printf("%-26s %-24s %s\n", settings::path_of(one.key).c_str(), one.left.c_str(), one.right.c_str());
  if (differences.empty() && !global.quiet) std::printf("no difference\n");
  return ExitStatus::Done;
}

/// The sensor program tells its camera the set and reads it back; what it says of the set.
Result<void> try_on_camera(const SettingsOptions& options, const fs::path& file) {
  constexpr std::chrono::seconds k_patience{30};
  BITELINE_ASSIGN(const fs::path program, intake::find_sensor_program());
  BITELINE_ASSIGN(intake::ChildProcess sensor,
                  intake::ChildProcess::start(
                      {.program = program,
                       .arguments = {"--check", "--source", "board:" + options.board.string(), "--sensor",
                                     options.sensor.string(), "--settings", file.string()}}));
  std::optional<std::string> verdict;
  bool ready = false;
  while (const Result<std::string> line = sensor.next_line(k_patience)) {
    std::istringstream row{*line};
    std::string state, what, seen;
    std::getline(row, state, '\t');
    std::getline(row, what, '\t');
    std::getline(row, seen, '\t');
    if (!what.starts_with("settings (")) continue;
    ready = state == "ready";
    verdict = seen;
  }
  BITELINE_TRY(sensor.wait(k_patience));
  if (!verdict) return fail(Errc::DeviceError, "%s", sensor.last_words().c_str());
  if (!ready) return fail(Errc::BadValue, "%s", verdict->c_str());
  return {};
}

Result<ExitStatus> check(const SettingsOptions& options, const GlobalOptions& global) {
  const fs::path file = file_of(options, options.name);
  BITELINE_TRY(settings::read_settings(file));
  if (!options.board.empty()) BITELINE_TRY(try_on_camera(options, file));
  if (!global.quiet)
    std::printf("%s: %s\n", file.c_str(),
                options.board.empty() ? "good; --board and --sensor try it on the camera"
                                      : "good; the camera took it");
  return ExitStatus::Done;
}

Result<ExitStatus> save_set(const SettingsOptions& options, const GlobalOptions& global) {
  if (!is_name(options.name) || options.name == "start-up")
    return fail(Errc::InvalidArgument, "%.64s: a name of letters, digits, - and _ expected, not start-up",
                options.name.c_str());
  BITELINE_ASSIGN(SettingsSet set, settings::read_settings(options.other));
  if (!options.note.empty()) set.note = options.note;
  BITELINE_TRY(report::prepare_folder(options.store));
  const fs::path file = file_of(options, options.name);
  BITELINE_TRY(report::write_file_atomically(file, settings::settings_text(set)));
  if (!global.quiet) std::printf("%s\n", file.c_str());
  return ExitStatus::Done;
}

/// The start-up set changes by one rename; the one before stays beside it.
Result<ExitStatus> use(const SettingsOptions& options, const GlobalOptions& global) {
  if (options.back == !options.name.empty())
    return fail(Errc::InvalidArgument, "settings use: a set's name, or --back");
  const fs::path start = options.store / settings::k_start_file, former = options.store / k_former_file;
  const fs::path file = options.back ? former : file_of(options, options.name);
  BITELINE_ASSIGN(const SettingsSet set, settings::read_settings(file));
  if (!options.board.empty()) BITELINE_TRY(try_on_camera(options, file));
  BITELINE_TRY(report::prepare_folder(options.store));
  const Result<SettingsSet> present = settings::read_settings(start);
  // Back: both files change places in one step, so that a kill loses neither.
  const bool swapped = options.back && present &&
                       ::renameat2(AT_FDCWD, start.c_str(), AT_FDCWD, former.c_str(), RENAME_EXCHANGE) == 0;
  if (!swapped) {
    const std::string text = settings::settings_text(set);
    // The same set once more leaves the way back as it is.
    if (present && settings::settings_text(*present) != text)
      BITELINE_TRY(report::write_file_atomically(former, settings::settings_text(*present)));
    BITELINE_TRY(report::write_file_atomically(start, text));
  }
  if (!global.quiet)
    std::printf("%s is %s from the sensor's next start on\n", start.c_str(),
                options.back ? "as it was before" : options.name.c_str());
  return ExitStatus::Done;
}

Result<ExitStatus> send(const SettingsOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const SettingsSet set, settings::read_settings(file_of(options, options.name)));
  BITELINE_TRY(send_settings(options.running, set));
  if (!global.quiet)
    std::printf("%s: the sensor took it, and runs with it until it stops\n", options.name.c_str());
  return ExitStatus::Done;
}

Result<ExitStatus> fetch(const SettingsOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const std::string text, fetch_settings(options.running));
  if (!global.json) {
    std::printf("%s", text.c_str());
    return ExitStatus::Done;
  }
  BITELINE_ASSIGN(const SettingsSet set, settings::parse_settings(text, options.running.endpoint));
  std::printf("%s\n", report::to_text(json_of(set)).c_str());
  return ExitStatus::Done;
}

void add_running_options(options::Command* command, SettingsOptions& options) {
  command->add_option("--at", options.running.endpoint, "The sensor that runs: tcp://HOST:PORT")->required();
  command->add_option("--keys", options.running.keys, "Folder of keys; compulsory beyond loopback");
}

void add_camera_options(options::Command* command, SettingsOptions& options) {
  options::Option* board =
      command->add_option("--board", options.board, "Try it on this board's camera; the sensor must be off");
  options::Option* sensor =
      command->add_option("--sensor", options.sensor, "The head's sensor.yaml, beside --board");
  board->needs(sensor);
  sensor->needs(board);
}

}  // namespace

void add_settings(options::Command& app, Context& context) {
  auto options = std::make_shared<SettingsOptions>();
  options::Command* command =
      app.add_subcommand("settings", "Sets of settings by name, and the one that a sensor starts with");
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, auto&& run) {
    options::Command* sub = command->add_subcommand(name, what);
    sub->add_option("--store", options->store, "Where named sets are kept")->capture_default_str();
    sub->callback([options, &context, run] {
      context.run = [options, &context, run] { return run(*options, context.options); };
    });
    return sub;
  };
  const char* which = "A set's name, or a settings file";
  add("list", "The named sets; * is the start-up set", list_sets);
  add("show", "Every setting of a set with its unit and what it does; * is set here", show_set)
      ->add_option("SET", options->name, std::string{which} + "; without it the start-up set");
  options::Command* compare_command = add("compare", "What two sets differ in", compare);
  compare_command->add_option("LEFT", options->name, which)->required();
  compare_command->add_option("RIGHT", options->other, which)->required();
  options::Command* check_command = add("check", "Is a set good, and does the camera take it?", check);
  check_command->add_option("SET", options->name, which)->required();
  add_camera_options(check_command, *options);
  options::Command* save_command = add("save", "Keep a settings file under a name", save_set);
  save_command->add_option("NAME", options->name, "Letters, digits, - and _")->required();
  save_command->add_option("FILE", options->other, "A settings file; settings.yaml of a recording, for one")
      ->required();
  save_command->add_option("--note", options->note, "One line for people");
  options::Command* use_command = add("use", "Make a set the one that the sensor starts with", use);
  use_command->add_option("SET", options->name, which);
  use_command->add_flag("--back", options->back, "The start-up set before the last change again");
  add_camera_options(use_command, *options);
  options::Command* send_command = add(
      "send", "Let a sensor that runs take a set, all of it or nothing; only the host in control may", send);
  send_command->add_option("SET", options->name, which)->required();
  add_running_options(send_command, *options);
  add_running_options(add("fetch", "The whole set that a sensor runs with, as a settings file", fetch),
                      *options);
}

}  // namespace biteline::app
