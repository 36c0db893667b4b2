// SPDX-License-Identifier: MIT
#pragma once
/// \file The meaning of /api/v1: who may ask what, and what it does (host/web/openapi.yaml).

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/doors/accounts/accounts.hpp"
#include "host/doors/api/cell.hpp"
#include "host/doors/api/exchange.hpp"
#include "host/doors/api/mounted.hpp"
#include "host/doors/api/stock.hpp"
#include "host/doors/api/stop_log.hpp"
#include "host/doors/control/messages.hpp"
#include "host/records/memory/factory_day.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::api {

struct Rooms {
  memory::Memory& memory;
  accounts::Accounts& accounts;
  Cell& cell;
  std::filesystem::path results;
  ProcessStore processes;    ///< the cell's own, where what is saved goes
  transfer::Library models;  ///< likewise
  Exchange exchange;         ///< a folder below `results`
  std::string version;
  std::function<void(const std::string&, Json)> publish;  ///< an event for all doors
  std::function<std::uint64_t()> last_seq;
  std::function<Result<Stock>()> stock{};  ///< what scans are worked with now; none: the cell's own
  /// Who commands as a line's door shows it; empty: the control end's keys say who comes in.
  std::string line_token{};
  memory::FactoryDay day{};  ///< filters, trends and tables go by it
};

/// A request with the person behind it.
struct Call {
  const control::Request& request;
  accounts::Person person;           ///< empty name: nobody is logged in
  std::vector<std::string> names{};  ///< the path's parts in braces, in order
};

[[nodiscard]] inline Speaker speaker(const Call& call) {
  return {call.person.name, call.request.stops};
}

/// Thread: safe from any; of ordinary() one that is_long() and one that is not at a time.
class Api {
 public:
  explicit Api(Rooms rooms)
      : rooms_{std::move(rooms)},
        mounted_{rooms_.memory, rooms_.cell},
        stop_log_{rooms_.memory, rooms_.accounts} {}

  /// Stop, Laser off and the line's reading, at once: neither the memory nor a password is waited for.
  /// Nothing for all else; also for a stop from another machine by somebody whom only the memory may know.
  [[nodiscard]] std::optional<control::Answer> urgent(const control::Request& request);
  [[nodiscard]] control::Answer ordinary(const control::Request& request);
  /// A model's file, an arm or a sensor that is asked: seconds, for which no other request waits.
  [[nodiscard]] static bool is_long(const control::Request& request);

 private:
  struct Route;
  [[nodiscard]] static std::vector<Route> routes();
  [[nodiscard]] control::Answer dispatch(const control::Request& request);
  /// The deed first, then the words about it.  `person`: as far as it is known.
  [[nodiscard]] control::Answer stop(const control::Request& request,
                                     const std::optional<accounts::Person>& person);
  [[nodiscard]] control::Answer stop_for_line(const control::Request& request);

  [[nodiscard]] control::Answer read_state(const Call& call);
  [[nodiscard]] control::Answer log_in(const Call& call);
  [[nodiscard]] control::Answer log_out(const Call& call);
  [[nodiscard]] control::Answer read_me(const Call& call);
  [[nodiscard]] control::Answer read_control(const Call& call);
  [[nodiscard]] control::Answer change_control(const Call& call);
  [[nodiscard]] control::Answer start(const Call& call);
  [[nodiscard]] control::Answer rescan(const Call& call);
  [[nodiscard]] std::optional<control::Answer> closed_to_line(const Call& call);
  /// For commands: besides, it is a door that was opened, and no program that calls itself one.
  [[nodiscard]] std::optional<control::Answer> closed_to_commands(const Call& call);
  [[nodiscard]] control::Answer read_line(const Call& call);
  [[nodiscard]] control::Answer choose_job(const Call& call);
  [[nodiscard]] control::Answer start_for_line(const Call& call);
  [[nodiscard]] control::Answer list_scans(const Call& call);
  [[nodiscard]] control::Answer read_scan(const Call& call);
  [[nodiscard]] control::Answer accept(const Call& call);
  [[nodiscard]] control::Answer reject(const Call& call);
  [[nodiscard]] control::Answer hold(const Call& call);
  [[nodiscard]] control::Answer send(const Call& call);
  [[nodiscard]] control::Answer choose_model(const Call& call);
  [[nodiscard]] control::Answer choose_process(const Call& call);
  [[nodiscard]] control::Answer run_in_air(const Call& call);
  /// 202, and who did what in the log.
  [[nodiscard]] control::Answer begun(const Call& call, const std::string& action, const std::string& what,
                                      const std::string& words);
  [[nodiscard]] control::Answer mend(const Call& call);
  [[nodiscard]] control::Answer rerun(const Call& call);
  [[nodiscard]] control::Answer keep(const Call& call);
  [[nodiscard]] control::Answer decide(const Call& call, Decision::Kind kind, int status, bool needs_why);
  [[nodiscard]] control::Answer list_models(const Call& call);
  [[nodiscard]] control::Answer save_model(const Call& call);
  [[nodiscard]] control::Answer read_model(const Call& call);
  [[nodiscard]] control::Answer remove_model(const Call& call);
  [[nodiscard]] control::Answer export_model(const Call& call);
  [[nodiscard]] control::Answer import_model(const Call& call);
  [[nodiscard]] control::Answer drop_import(const Call& call);
  /// The scan's own process, or the one that is named.  Refused: it is another than the scan was planned
  /// with, and nobody said so.
  [[nodiscard]] std::optional<control::Answer> choose_process_of_model(const std::string& scan,
                                                                       const std::string& process, bool other,
                                                                       transfer::SaveOptions& options);
  /// 201 for a model that is new or in the place of another: in the log and told to all doors.
  [[nodiscard]] control::Answer tell_of_model(const Call& call, const transfer::ModelInfo& model,
                                              const std::string& action, const std::string& scan);
  [[nodiscard]] control::Answer list_processes(const Call& call);
  [[nodiscard]] control::Answer read_process_schema(const Call& call);
  [[nodiscard]] control::Answer read_process(const Call& call);
  [[nodiscard]] control::Answer write_process(const Call& call);
  [[nodiscard]] control::Answer check_process(const Call& call);
  [[nodiscard]] Result<std::string> newest_with_line() const;
  [[nodiscard]] Result<Stock> stock() const;
  [[nodiscard]] control::Answer read_mounted(const Call& call);
  [[nodiscard]] control::Answer touch(const Call& call);
  [[nodiscard]] control::Answer end_lesson(const Call& call);
  [[nodiscard]] control::Answer keep_mounted(const Call& call);
  [[nodiscard]] control::Answer forget_mounted(const Call& call);
  [[nodiscard]] control::Answer list_robots(const Call& call);
  [[nodiscard]] control::Answer list_sensors(const Call& call);
  [[nodiscard]] control::Answer change_settings(const Call& call);
  [[nodiscard]] control::Answer keep_recording(const Call& call);
  [[nodiscard]] control::Answer list_users(const Call& call);
  [[nodiscard]] control::Answer add_user(const Call& call);
  [[nodiscard]] control::Answer change_user(const Call& call);
  [[nodiscard]] control::Answer remove_user(const Call& call);
  [[nodiscard]] control::Answer read_log(const Call& call);
  [[nodiscard]] control::Answer read_trends(const Call& call);
  [[nodiscard]] control::Answer export_history(const Call& call);

  [[nodiscard]] Json control_json() const;

  Rooms rooms_;
  MountedRoom mounted_;
  StopLog stop_log_;
};

}  // namespace biteline::api
