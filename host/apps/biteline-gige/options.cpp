// SPDX-License-Identifier: MIT
#include "host/apps/biteline-gige/options.hpp"

#include <cstdio>
#include "common/options/command.hpp"

namespace biteline::gige {
namespace {

int log_error(const std::string& line, ExitStatus status = ExitStatus::BadInput) {
  std::fprintf(stderr, "biteline-gige: %s\n", line.c_str());
  return static_cast<int>(status);
}

struct Texts {
  std::string sensor, interface, camera, keys;
  std::vector<std::string> clients;
};

Result<std::uint32_t> address_of(const char* option, const std::string& text) {
  const std::optional<std::uint32_t> address = read_address(text);
  if (!address) return fail(Errc::InvalidArgument, "%s: '%s' is no IPv4 address", option, text.c_str());
  return *address;
}

Result<void> read(const Texts& texts, Options& options) {
  BITELINE_ASSIGN(options.feed.sensor, wire::parse_endpoint(texts.sensor));
  if (!texts.keys.empty()) {
    BITELINE_ASSIGN(options.feed.keys, wire::read_host_keys(texts.keys));
  }
  BITELINE_ASSIGN(const std::vector<Interface> all, interfaces());
  BITELINE_ASSIGN(options.server.interface, choose_interface(all, texts.interface));
  for (const std::string& client : texts.clients) {
    BITELINE_ASSIGN(const std::uint32_t address, address_of("--client", client));
    options.server.clients.push_back(address);
  }
  options.ask_for_cameras = texts.camera.empty() && !options.server.interface.loopback;
  if (texts.camera.empty()) return {};
  BITELINE_ASSIGN(const std::uint32_t camera, address_of("--camera", texts.camera));
  // An interface may have several addresses, and reach the camera by any of them.
  for (const Interface& one : all)
    if (one.name == options.server.interface.name) BITELINE_TRY(keep_off_camera(one, camera));
  return keep_off_camera(options.server.interface, camera);
}

}  // namespace

ParsedOptions parse_options(int argc, char** argv) {
  ParsedOptions parsed;
  Options& options = parsed.options;
  options.server.version = BITELINE_VERSION;
  options.server.serial = "biteline";
  Texts texts;
  options::Command app{"Shows a sensor's profiles as a GigE Vision device, for software that speaks GenICam.",
                       "biteline-gige"};
  app.set_version_flag("--version", BITELINE_VERSION);
  app.add_option("--sensor", texts.sensor, "The sensor: tcp://HOST:PORT")->required();
  app.add_option("--keys", texts.keys, "Folder of keys for the sensor; compulsory beyond loopback");
  app.add_option("--interface", texts.interface,
                 "Name or IPv4 address of the one interface on which the device is seen")
      ->required();
  app.add_option("--camera", texts.camera,
                 "The camera's own IPv4 address: an interface that reaches it is refused. Without: an "
                 "interface on which any GigE Vision device answers is refused");
  app.add_option("--client", texts.clients,
                 "An IPv4 address that may connect; compulsory beyond loopback, since GigE Vision has no "
                 "login; may be given several times");
  app.add_flag("--allow-control", options.feed.allow_control,
               "AcquisitionStart asks the sensor for a scan, and its laser guard lights the laser. Without: "
               "a client only looks on");
  app.add_option("--serial", options.server.serial, "DeviceSerialNumber, at most 15 letters")
      ->capture_default_str();
  app.add_option("--name", options.server.name, "The device's name, at most 15 letters");
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "Stop when the program that started this one ends");
  if (const std::optional<options::Leave> leave = app.parse(argc, argv)) {
    parsed.leave_with = leave->fault.empty() ? 0 : log_error(leave->fault + " (see --help)");
    return parsed;
  }
  if (const Result<void> done = read(texts, options); !done)
    parsed.leave_with = log_error(to_line(done.error()), error_row(done.error().code).exit_status);
  return parsed;
}

}  // namespace biteline::gige
