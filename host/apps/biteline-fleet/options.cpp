// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/options.hpp"

#include "common/options/command.hpp"
#include "host/fleet/broker_command_line.hpp"
#include "host/fleet/program.hpp"

namespace biteline::fleet {
namespace {

/// What the parser cannot say: a token is made without a database, and needs none.
std::optional<options::Leave> unfit(const FleetOptions& options) {
  const bool token = !options.metrics_token.empty() || options.drop_metrics_token;
  if (!options.metrics_token.empty() && options.drop_metrics_token)
    return options::Leave{.fault = "--metrics-token excludes --drop-metrics-token"};
  if (!token && options.database.empty()) return options::Leave{.fault = "--database is required"};
  return std::nullopt;
}

}  // namespace

ParsedFleetOptions parse_fleet_options(int argc, char** argv) {
  ParsedFleetOptions parsed;
  FleetOptions& options = parsed.options;
  std::error_code fault;
  options.migrations = std::filesystem::read_symlink("/proc/self/exe", fault).parent_path().parent_path() /
                       "share/biteline/migrations";
  std::string day_begin = options.day.begin();
  options::Command app{"The factory's centre: takes the shoes of all cells from the broker into PostgreSQL.",
                       k_fleet_program};
  app.set_version_flag("--version", BITELINE_VERSION);
  app.add_option(
      "--database", options.database,
      "PostgreSQL, as libpq takes it: \"host=HOST dbname=NAME user=NAME\"; a password stands in ~/.pgpass");
  add_broker_options(app, options.broker);
  app.add_option("--migrations", options.migrations, "Folder of the tables' versions")->capture_default_str();
  auto* metrics = app.add_option(
      "--metrics", options.metrics,
      "Give Prometheus' text at http://127.0.0.1:PORT/metrics to who shows a token; 0: any free port");
  auto* control =
      app.add_option("--control", options.control,
                     "Where biteline-web comes in for the page of all cells: tcp://127.0.0.1:PORT");
  auto* accounts = app.add_option("--accounts", options.accounts,
                                  "Folder of accounts and log: of the page, and of who may read --metrics");
  control->needs(accounts);
  app.add_option("--time-zone", options.time_zone,
                 "Of the page's days, such as Asia/Shanghai; else the machine's own");
  app.add_option("--day-begin", day_begin, "When the factory's day begins: hh:mm of its first shift")
      ->capture_default_str();
  metrics->needs(accounts);
  app.add_option(
         "--metrics-token", options.metrics_token,
         "Use the token in this file, or make one there, and leave: a Prometheus that shows it may read "
         "--metrics of the centre with these --accounts; the one before ends, also while the centre runs")
      ->needs(accounts);
  app.add_flag("--drop-metrics-token", options.drop_metrics_token, "End that token, and leave")
      ->needs(accounts);
  app.add_flag("--list", options.list, "Print the cells with their health and counts, and leave");
  app.add_flag(
      "--odd", options.odd,
      "Name each cell whose lines of a model differ from the other cells', and leave; exit status 3 where "
      "there is one");
  app.add_option("--log-links", options.log_links,
                 "Print the links of this cell's log that were told, for biteline history --verify-log "
                 "--kept-links, and leave")
      ->type_name("CELL");
  add_release_options(app, options.releases);
  auto* recordings =
      app.add_option("--recordings", options.recordings,
                     "Folder for the recordings that are asked for with --fetch; without: none are fetched");
  app.add_option(
         "--keep-days", options.limits.days,
         "Remove recordings that came earlier than so many days ago, but for marked ones; their rows stay")
      ->check(options::number({.minimum = 1, .maximum = 36500}, "days"))
      ->needs(recordings);
  app.add_option(
         "--keep-gb", options.limits.gb,
         "Remove the oldest recordings beyond so many gigabytes, but for marked ones and the newest; their "
         "rows stay")
      ->check(options::number({.minimum = 0.01, .maximum = 1e6}, "GB"))
      ->needs(recordings);
  add_recording_options(app, options.fetches);
  app.add_flag("--json", options.json, "With --list, --odd, --releases or --fetches: as JSON");
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "Stop when the program that started this one ends");
  std::optional<options::Leave> leave = app.parse(argc, argv);
  if (!leave) leave = unfit(options);
  if (const auto day = memory::FactoryDay::from(day_begin); day) {
    options.day = *day;
  } else if (!leave) {
    leave = options::Leave{.fault = "--day-begin: a time of day such as 06:00 expected"};
  }
  if (leave)
    parsed.leave_with = leave->fault.empty() ? 0
                                             : log_error(k_fleet_program, leave->fault + " (see --help)",
                                                         ExitStatus::BadInput);
  return parsed;
}

}  // namespace biteline::fleet
