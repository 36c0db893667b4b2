// SPDX-License-Identifier: MIT
// biteline keys: who may talk to a sensor.
#include <cstdio>

#include "common/wire/keys.hpp"
#include "host/apps/biteline/command.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct KeysOptions {
  fs::path folder, public_key;
  std::string name;
  bool of_sensor{false};
};

/// What the other side needs, and where it goes: a public key is no secret.
void say_next(const KeysOptions& options, const GlobalOptions& global) {
  if (global.quiet) return;
  if (options.of_sensor) {
    std::printf("copy %s to the key folder of each host\n", (options.folder / "sensor.public").c_str());
  } else {
    std::printf(
        "copy %s to the sensor, then there: one line in hosts.allowed, or biteline keys allow NAME FILE\n",
        (options.folder / "host.public").c_str());
  }
}

Result<ExitStatus> make(const KeysOptions& options, const GlobalOptions& global) {
  BITELINE_TRY(options.of_sensor ? wire::make_sensor_keys(options.folder)
                                 : wire::make_host_keys(options.folder));
  say_next(options, global);
  return ExitStatus::Done;
}

Result<ExitStatus> rotate(const KeysOptions& options, const GlobalOptions& global) {
  BITELINE_TRY(
      wire::rotate_keys(options.folder, options.of_sensor ? wire::KeyOwner::Sensor : wire::KeyOwner::Host));
  say_next(options, global);
  return ExitStatus::Done;
}

Result<ExitStatus> done(const Result<void>& result) {
  BITELINE_TRY(result);
  return ExitStatus::Done;
}

}  // namespace

void add_keys(options::Command& app, Context& context) {
  auto options = std::make_shared<KeysOptions>();
  options::Command* command = app.add_subcommand("keys", "Keys for the link between sensor and host");
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, auto&& run) {
    options::Command* sub = command->add_subcommand(name, what);
    sub->add_option("--keys", options->folder, "The key folder")->required();
    sub->callback([options, &context, run] {
      context.run = [options, &context, run] { return run(*options, context.options); };
    });
    return sub;
  };
  options::Command* make_command =
      add("make", "Make a host's own pair where it lives (a sensor: biteline-sensor --make-keys)", make);
  make_command->add_flag("--sensor", options->of_sensor, "The pair of a sensor instead");
  options::Command* rotate_command = add("rotate", "A new pair in the place of the old one", rotate);
  rotate_command->add_flag("--sensor", options->of_sensor, "The folder is a sensor's");
  options::Command* allow_command =
      add("allow", "Let a host in: its key in a sensor's hosts.allowed, an older one of that name out",
          [](const KeysOptions& o, const GlobalOptions&) {
            return done(wire::allow_host(o.folder, o.name, o.public_key));
          });
  allow_command->add_option("name", options->name, "What the host is called")->required();
  allow_command->add_option("key", options->public_key, "Its host.public")->required();
  options::Command* revoke_command = add(
      "revoke", "Put a host out of a sensor's hosts.allowed; a running sensor cuts it off",
      [](const KeysOptions& o, const GlobalOptions&) { return done(wire::revoke_host(o.folder, o.name)); });
  revoke_command->add_option("name", options->name, "Its name, or its key")->required();
}

}  // namespace biteline::app
