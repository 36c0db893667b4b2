// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/confirm.hpp"

#include "common/core/fixed_text.hpp"
#include "common/system/user_name.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/intake/scan_intake.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/robot/link/gate/gate_file.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

std::string key_of(std::uint64_t scan_id) {
  return std::string{
      FixedText<40>::format("confirmed %016llx", static_cast<unsigned long long>(scan_id)).view()};
}

tl::unexpected<Error> used_up(const std::string& name, const std::string& when) {
  return fail(
      Errc::InvalidArgument,
      "--confirm %s: that word was used up (%.100s); take it out of the command, and scan the shoe again",
      name.c_str(), when.c_str());
}

}  // namespace

Result<Confirm> read_confirm(const fs::path& results, const std::string& name, const memory::Memory& memory) {
  if (!api::is_scan_id(name)) {
    return fail(Errc::InvalidArgument, "--confirm '%.80s': a scan's name alone expected, as scan-0007",
                name.c_str());
  }
  const fs::path folder = results / name;
  std::error_code error;
  // A link would be a second name of the same scan.
  if (!fs::is_directory(fs::symlink_status(folder, error))) {
    return fail(Errc::FileNotFound,
                "--confirm %s: no such scan in %.150s; the word is for one that lies there when the service "
                "starts, and for no later one",
                name.c_str(), results.c_str());
  }
  if (!intake::ScanIntake::is_in(folder)) {
    return fail(Errc::InvalidArgument,
                "--confirm %s: its recording is gone, so it cannot be worked again; scan the shoe again",
                name.c_str());
  }
  Confirm confirm{.name = name};
  {
    const Result<intake::ScanIntake> intake = intake::ScanIntake::recover(folder);
    if (!intake) return tl::unexpected<Error>{intake.error()};
    confirm.scan_id = intake->scan_id();
  }
  if (confirm.scan_id == 0) {
    return fail(Errc::InvalidArgument, "--confirm %s: it has no number of its own; scan the shoe again",
                name.c_str());
  }
  BITELINE_ASSIGN(const std::optional<std::string> before, memory.setting(key_of(confirm.scan_id)));
  if (before) return used_up(name, *before);
  // A memory that was made anew knows nothing of it: what stands beside the scan does.
  for (const char* file : {"gate.json", "air/gate.json"}) {
    if (!fs::exists(folder / file, error)) continue;
    const Result<robot::GateFile> gate = robot::read_gate(folder / file);
    if (!gate) return used_up(name, "its gate.json cannot be read");
    if (const auto& word = gate->inputs.scan.confirmed)
      return used_up(name, "by " + word->by + ", " + word->at);
    if (gate->permitted && std::string{file} == "gate.json") return used_up(name, "its path was sent");
  }
  return confirm;
}

Result<robot::Word> use_up(const Confirm& confirm, memory::Memory& memory) {
  robot::Word word{.by = user_name(), .at = utc_now()};
  BITELINE_TRY(memory.put_setting(key_of(confirm.scan_id), "by " + word.by + ", " + word.at,
                                  {.id = 0,
                                   .time = memory::now_ms(),
                                   .who = word.by,
                                   .door = {},
                                   .action = "confirm",
                                   .subject = confirm.name,
                                   .before = {},
                                   .after = {}}));
  return word;
}

}  // namespace biteline::service
