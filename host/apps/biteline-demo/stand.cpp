// SPDX-License-Identifier: MIT
#include "host/apps/biteline-demo/stand.hpp"

#include <chrono>
#include <sstream>

#include "host/cloud/uncertainty/uncertainty_file.hpp"
#include "host/report/report.hpp"

namespace biteline::demo {
namespace {

namespace fs = std::filesystem;
using intake::ChildProcess;
using nlohmann::ordered_json;
using namespace std::chrono_literals;

Result<Server> start_server(const std::string& name, std::vector<std::string> arguments,
                            bool pass_stderr = true) {
  arguments.emplace_back("--exit-with-parent");
  // Making a shoe and its search tree takes the cell some seconds, more on a busy machine.
  constexpr auto k_patience = 60s;
  BITELINE_ASSIGN(ChildProcess child, ChildProcess::start({.program = intake::program_folder() / name,
                                                           .arguments = std::move(arguments),
                                                           .pass_stderr = pass_stderr}));
  BITELINE_ASSIGN(const std::string line, child.next_line(k_patience));
  ordered_json endpoints = ordered_json::parse(line, nullptr, false);
  if (!endpoints.is_object()) return fail(Errc::ProtocolError, "%s: a line of JSON expected", name.c_str());
  return Server{.child = std::move(child), .endpoints = std::move(endpoints)};
}

/// With real-time rights where there are any: then no other program on this machine holds it up.
Result<Server> start_sensor(const std::string& board, const std::string& calibration) {
  std::vector<std::string> arguments{"--source",  "board:" + board, "--sensor",
                                     calibration, "--rt",           "required"};
  if (Result<Server> urgent = start_server("biteline-sensor", arguments, false)) return urgent;
  arguments.back() = "ignore";
  return start_server("biteline-sensor", arguments);
}

Result<std::string> endpoint(const Server& server, const char* name) {
  if (!server.endpoints.contains(name) || !server.endpoints[name].is_string()) {
    return fail(Errc::ProtocolError, "no '%s' among the endpoints of a started program", name);
  }
  return server.endpoints[name].get<std::string>();
}

std::vector<std::string> cell_arguments(const CellOptions& options, const Shoe& shoe, const fs::path& out) {
  const auto number = [](double value) {
    std::ostringstream text;
    text << value;
    return text.str();
  };
  std::vector<std::string> arguments{"serve",
                                     "--seed",
                                     std::to_string(options.seed),
                                     "--shoe",
                                     options.shoe,
                                     "--arm",
                                     options.arm,
                                     "--world",
                                     options.world,
                                     "--place",
                                     std::to_string(shoe.place),
                                     "--out",
                                     out.string(),
                                     "--size",
                                     number(options.size),
                                     "--speed-mm-s",
                                     number(options.speed_mm_s),
                                     "--rate-hz",
                                     number(options.rate_hz),
                                     "--scan-begin",
                                     number(options.scan_begin_ratio),
                                     options.scan_clockwise ? "--scan-clockwise" : "--scan-anticlockwise",
                                     "--stay-at-end"};
  if (options.time_ratio) arguments.insert(arguments.end(), {"--time-ratio", number(*options.time_ratio)});
  if (shoe.sample) arguments.emplace_back("--upper");
  return arguments;
}

/// How well the cell's head is known: its sensor.yaml holds the true values, and only its poses are noisy.
Result<fs::path> write_uncertainty(const Server& cell, const fs::path& folder) {
  const uncertainty::HeadUncertainty known{.pose_sigma_mm = cell.endpoints.value("pose_sigma_mm", 0.0),
                                           .pose_sigma_rad = cell.endpoints.value("pose_sigma_rad", 0.0)};
  const fs::path file = folder / uncertainty::k_file_name;
  BITELINE_TRY(report::write_file_atomically(file, uncertainty::uncertainty_text(known)));
  return file;
}

}  // namespace

Result<Stand> start_stand(const CellOptions& options, const Shoe& shoe, const fs::path& folder) {
  const fs::path cell_folder = fs::absolute(folder) / "cell";
  BITELINE_ASSIGN(Server cell, start_server("biteline-cell", cell_arguments(options, shoe, cell_folder)));
  BITELINE_ASSIGN(const std::string board, endpoint(cell, "board"));
  BITELINE_ASSIGN(const std::string calibration, endpoint(cell, "sensor"));
  BITELINE_ASSIGN(Server sensor, start_sensor(board, calibration));
  BITELINE_ASSIGN(std::string stream, endpoint(sensor, "endpoint"));
  BITELINE_ASSIGN(fs::path known, write_uncertainty(cell, cell_folder));
  return Stand{.cell = std::move(cell),
               .sensor = std::move(sensor),
               .stream = std::move(stream),
               .known = std::move(known)};
}

std::vector<std::string> host_arguments(const CellOptions& options, const Stand& stand,
                                        const fs::path& folder) {
  const auto told = [&](const char* name) { return stand.cell.endpoints.value(name, ""); };
  // What an integrator measures in his cell.
  const auto measured = [&](const char* name) {
    return std::to_string(stand.cell.endpoints.value(name, 0.0));
  };
  return {"--sensor",
          stand.stream,
          "--out",
          folder.string(),
          "--uncertainty",
          stand.known.string(),
          "--robot",
          options.arm,
          "--process",
          options.process.string(),
          "--table-z",
          measured("table_z_mm"),
          "--fixture-z",
          measured("fixture_z_mm"),
          "--fixture-beyond",
          measured("fixture_beyond_mm"),
          "--rtde",
          told("rtde"),
          "--script",
          told("primary"),
          "--dashboard",
          told("dashboard"),
          "--send",
          "--exit-with-parent"};
}

}  // namespace biteline::demo
