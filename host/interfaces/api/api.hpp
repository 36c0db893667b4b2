// SPDX-License-Identifier: MIT
#pragma once
/// \file The meaning of /api/v1: who may ask what, and what it does (host/web/openapi.yaml).

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/interfaces/accounts/accounts.hpp"
#include "host/interfaces/api/catalogue.hpp"
#include "host/interfaces/api/cell.hpp"
#include "host/interfaces/api/exchange.hpp"
#include "host/interfaces/api/mounted.hpp"
#include "host/interfaces/api/routes.hpp"
#include "host/interfaces/api/stop_log.hpp"
#include "host/interfaces/api/teach.hpp"
#include "host/interfaces/control/messages.hpp"
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
  std::function<Result<Catalogue>()> catalogue{};  ///< what scans are worked with now; none: the cell's own
  /// Who commands as a line's door shows it; empty: the control end's keys say who comes in.
  std::string line_token{};
  memory::FactoryDay day{};  ///< filters, trends and tables go by it
};

/// A request with the person behind it.
struct Call {
  const control::Request& request;
  accounts::Person person;           ///< empty name: nobody is logged in
  std::vector<std::string> names{};  ///< what stands in the path's braces, in order
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
        stop_log_{rooms_.memory, rooms_.accounts},
        teach_{rooms_.memory, rooms_.cell, rooms_.results, rooms_.publish} {}

  /// Stop, Laser off and the line's reading, at once: neither the memory nor a password is waited for.
  /// Nothing for all else; also for a stop from another machine by somebody whom only the memory may know.
  [[nodiscard]] std::optional<control::Answer> urgent(const control::Request& request);
  [[nodiscard]] control::Answer ordinary(const control::Request& request);
  /// A model's file, an arm or a sensor that is asked: seconds, for which no other request waits.
  [[nodiscard]] static bool is_long(const control::Request& request);
  /// `teaching` of the state; null: nobody teaches.
  [[nodiscard]] Json teaching_json();

 private:
  // `Answer operationId(const Call&)` for each operation that the API's documents give to the service.
#include "host/interfaces/api/service_handlers.inc"

  struct Row;
  [[nodiscard]] static std::span<const Row> rows();
  [[nodiscard]] static Match<Row> find(const control::Request& request);
  [[nodiscard]] control::Answer dispatch(const control::Request& request, const Match<Row>& match);
  /// Scan and arm, or the laser.  The deed first, then the words about it.  `person`: as far as it is known.
  [[nodiscard]] control::Answer halt(const control::Request& request,
                                     const std::optional<accounts::Person>& person);
  [[nodiscard]] std::optional<control::Answer> closed_to_line(const Call& call);
  /// For commands: besides, it is a door that was opened, and no program that calls itself one.
  [[nodiscard]] std::optional<control::Answer> closed_to_commands(const Call& call);
  /// 202, and who did what in the log.
  [[nodiscard]] control::Answer begun(const Call& call, const std::string& action, const std::string& what,
                                      const std::string& words);
  [[nodiscard]] control::Answer decide(const Call& call, Decision::Kind kind, int status, bool needs_why);
  /// The scan's own process, or the one that is named.  Refused: it is another than the scan was planned
  /// with, and nobody said so.
  [[nodiscard]] std::optional<control::Answer> choose_process_of_model(const std::string& scan,
                                                                       const std::string& process, bool other,
                                                                       transfer::SaveOptions& options);
  /// Why the model would not be what was run in the air; empty: it would, or nobody teaches the scan.
  [[nodiscard]] Result<std::string> not_run_in_air(const std::string& scan,
                                                   const transfer::SaveOptions& options);
  /// 201 for a model that is new or in the place of another: in the log and told to all doors.
  [[nodiscard]] control::Answer tell_of_model(const Call& call, const transfer::ModelInfo& model,
                                              const std::string& action, const std::string& after);
  [[nodiscard]] Result<std::string> newest_with_line() const;
  [[nodiscard]] Result<Catalogue> catalogue() const;
  [[nodiscard]] Json control_json() const;

  Rooms rooms_;
  MountedRoom mounted_;
  StopLog stop_log_;
  TeachRoom teach_;
};

}  // namespace biteline::api
