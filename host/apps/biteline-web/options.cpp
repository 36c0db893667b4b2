// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/options.hpp"

#include <cstdio>

#include "common/options/command.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::web {
namespace {

int log_error(const std::string& line) {
  std::fprintf(stderr, "biteline-web: %s\n", line.c_str());
  return static_cast<int>(ExitStatus::BadInput);
}

/// `share/biteline` beside the program's own folder: build/bin and build/share, /usr/bin and /usr/share.
std::filesystem::path share_folder() {
  std::error_code fault;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", fault);
  return program.parent_path().parent_path() / "share" / "biteline";
}

constexpr std::uint16_t k_modbus_port = 1502;  // 502 needs rights that this program does without
constexpr std::uint16_t k_text_port = 7119;

/// ADDRESS, ADDRESS:PORT or [IPv6]:PORT.
Result<LineListener> read_address(const std::string& text, std::uint16_t default_port) {
  const std::string with_port = text.find(':') == std::string::npos || text.ends_with(']')
                                    ? text + ":" + std::to_string(default_port)
                                    : text;
  BITELINE_ASSIGN(const wire::Endpoint endpoint, wire::parse_endpoint("tcp://" + with_port));
  LineListener at{.address = endpoint.host == "localhost" ? "127.0.0.1" : endpoint.host,
                  .port = endpoint.port};
  if (at.address.starts_with('[')) at.address = at.address.substr(1, at.address.size() - 2);
  return at;
}

/// The doors of the line's control; a fault is told in words.
std::optional<std::string> read_line_doors(const std::string& modbus, const std::string& text,
                                           LineDoorsConfig& line) {
  struct Listener {
    const char* option;
    const std::string& told;
    std::uint16_t default_port;
    std::optional<LineListener>& at;
  };
  for (const Listener& one : {Listener{"--modbus", modbus, k_modbus_port, line.modbus},
                              Listener{"--text", text, k_text_port, line.text}}) {
    if (one.told.empty()) continue;
    const Result<LineListener> at = read_address(one.told, one.default_port);
    if (!at) return std::string{one.option} + ": " + to_line(at.error());
    one.at = *at;
  }
  if (!line.peers.empty() && !line.modbus && !line.text)
    return "--line-peer needs --modbus or --text (see --help)";
  return std::nullopt;
}

}  // namespace

ParsedWebOptions parse_web_options(int argc, char** argv) {
  ParsedWebOptions parsed;
  WebOptions& options = parsed.options;
  WebConfig& server = options.server;
  server.page = share_folder() / "web";
  server.openapi = share_folder() / "openapi.yaml";
  std::string listen{"127.0.0.1:8080"};
  std::string control;
  std::string sensor;
  TlsFiles tls;
  AddUserRequest account;
  options::Command app{"Biteline's page and API: shows and steers a cell's service over HTTP and WebSocket.",
                       "biteline-web"};
  app.set_version_flag("--version", BITELINE_VERSION);
  app.add_option("--listen", listen,
                 "ADDRESS or ADDRESS:PORT of one interface; beyond loopback TLS is compulsory")
      ->capture_default_str();
  app.add_option("--control", control, "Where biteline-host's control end listens: tcp://HOST:PORT");
  app.add_option("--control-keys", options.control_keys,
                 "Folder of keys for the control end; compulsory beyond loopback");
  app.add_option("--sensor", sensor,
                 "The sensor whose live data are shown; without: the one that biteline-host names");
  app.add_option("--keys", options.sensor_keys, "Folder of keys for the sensor; compulsory beyond loopback");
  auto* certificate =
      app.add_option("--certificate", tls.certificate, "PEM certificate with its chain: serve HTTPS");
  auto* key = app.add_option("--key", tls.key, "The certificate's PEM key")->needs(certificate);
  certificate->needs(key);
  app.add_option(
      "--name", server.names,
      "A name under which browsers may call this server, besides its address; may be given several times");
  app.add_option("--page", server.page, "Folder of the page")->capture_default_str();
  app.add_flag("--behind-proxy", server.behind_proxy,
               "A proxy stands before this server: nobody counts as on the cell's own machine");
  std::string modbus;
  std::string text;
  app.add_option(
      "--modbus", modbus,
      "ADDRESS or ADDRESS:PORT (1502) of one interface: a Modbus TCP door for the line's control. It "
      "has no login: a peer may choose a job, ask for a start and read, no more");
  app.add_option("--text", text, "The same (7119) with lines of plain text, for robots and PLCs");
  app.add_option(
      "--line-peer", options.line.peers,
      "An address that may connect to --modbus and --text; compulsory beyond loopback; may be given "
      "several times");
  auto* add =
      app.add_option("--add-user", account.name,
                     "Make an account and leave; the password comes from the terminal or stdin. With --out: "
                     "while no biteline-host runs; with --control: the first account of one that runs");
  auto* role =
      app.add_option("--role", account.role, "viewer, operator, engineer or administrator")->needs(add);
  add->needs(role);
  app.add_option("--out", account.out, "biteline-host's folder of results");
  app.add_option(
      "--metrics-token", options.metrics_token,
      "Use the token in this file, or make one there, and leave: a Prometheus that shows it may read "
      "/metrics of --out's service, and nothing else; the one before ends, also while the service runs");
  app.add_flag("--drop-metrics-token", options.drop_metrics_token, "End that token, and leave");
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "Stop when the program that started this one ends");
  if (const std::optional<options::Leave> leave = app.parse(argc, argv)) {
    parsed.leave_with = leave->fault.empty() ? 0 : log_error(leave->fault + " (see --help)");
    return parsed;
  }
  if (!tls.certificate.empty()) server.tls = tls;
  const Result<LineListener> at = read_address(listen, server.port);
  if (!at) {
    parsed.leave_with = log_error("--listen: " + to_line(at.error()));
    return parsed;
  }
  server.address = at->address;
  server.port = at->port;
  if (const std::optional<std::string> fault = read_line_doors(modbus, text, options.line)) {
    parsed.leave_with = log_error(*fault);
    return parsed;
  }
  struct EndpointOption {
    const std::string& text;
    std::optional<wire::Endpoint>& endpoint;
    const char* name;
  };
  for (const EndpointOption& option : {EndpointOption{control, options.control, "--control"},
                                       EndpointOption{sensor, options.sensor, "--sensor"}}) {
    if (option.text.empty()) continue;
    const Result<wire::Endpoint> endpoint = wire::parse_endpoint(option.text);
    if (!endpoint) {
      parsed.leave_with = log_error(std::string{option.name} + ": " + to_line(endpoint.error()));
      return parsed;
    }
    option.endpoint = *endpoint;
  }
  if (!options.metrics_token.empty() || options.drop_metrics_token) {
    if (account.out.empty() || !account.name.empty() ||
        (options.drop_metrics_token && !options.metrics_token.empty()))
      parsed.leave_with =
          log_error("one of --metrics-token FILE and --drop-metrics-token, with --out DIR (see --help)");
    options.accounts = account.out / memory::k_memory_file;
    return parsed;
  }
  if (!account.out.empty() && account.name.empty()) {
    parsed.leave_with = log_error("--out needs --add-user or --metrics-token (see --help)");
    return parsed;
  }
  if (!account.name.empty()) {
    if (account.out.empty() == !options.control) {
      parsed.leave_with =
          log_error("--add-user needs either --out DIR or --control tcp://HOST:PORT (see --help)");
      return parsed;
    }
    account.control = options.control;
    account.control_keys = options.control_keys;
    options.add_user = account;
    return parsed;
  }
  if ((options.line.modbus || options.line.text) && !options.control) {
    parsed.leave_with = log_error("--modbus and --text need --control tcp://HOST:PORT (see --help)");
    return parsed;
  }
  if (!options.control && !options.sensor) {
    parsed.leave_with = log_error("--control tcp://HOST:PORT expected (see --help)");
  }
  return parsed;
}

}  // namespace biteline::web
