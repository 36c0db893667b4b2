// SPDX-License-Identifier: MIT
// biteline demo: starts biteline-demo beside this program, which takes this one's place.
#include <unistd.h>

#include <cerrno>
#include <vector>

#include "host/apps/biteline/command.hpp"
#include "host/intake/child_process.hpp"

namespace biteline::app {
namespace {

Result<ExitStatus> become_demo(std::vector<std::string> arguments, const GlobalOptions& global) {
  const std::string program = intake::program_folder() / "biteline-demo";
  arguments.insert(arguments.begin(), program);
  if (global.quiet) arguments.emplace_back("--quiet");
  if (global.json) arguments.emplace_back("--json");
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  ::execv(program.c_str(), words.data());
  return fail_errno(Errc::FileNotFound, errno, "%s: build or install it beside biteline", program.c_str());
}

}  // namespace

void add_demo(options::Command& app, Context& context) {
  options::Command* command =
      app.add_subcommand("demo",
                         "The main job without hardware: a sample and the uppers after it; "
                         "simulated cell, real sensor program and host service");
  // Its options are those of biteline-demo, --help among them.
  command->take_the_rest();
  command->callback([command, &context] {
    context.run = [command, &context] { return become_demo(command->remaining(), context.options); };
  });
}

}  // namespace biteline::app
