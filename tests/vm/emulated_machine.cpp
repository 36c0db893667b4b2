// SPDX-License-Identifier: MIT
#include "tests/vm/emulated_machine.hpp"

#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdio>
#include <cstdlib>

#include "hal/linux/posix/descriptor.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// What boot.sh ends with where it lacks something.
constexpr int k_lacks_something = 77;

}  // namespace

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

bool nothing_to_boot() {
  const std::string build = environment("BITELINE_ARM64_BUILD");
  if (build.empty()) {
    note_skipped("started by ctest, which names kernel and build");
    return true;
  }
  if (std::filesystem::exists(build + "/bin/biteline-sensor")) return false;
  note_skipped("no arm64 build");
  return true;
}

int EmulatedMachine::free_port() {
  const hal::Descriptor socket{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  CHECK_EQUAL(0, ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), size));
  CHECK_EQUAL(0, ::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&address), &size));
  return ntohs(address.sin_port);
}

void EmulatedMachine::boot(const MachineNeeds& needs) {
  const auto quoted = [](const std::string& words) { return " '" + words + "'"; };
  const std::string network =
      "-netdev user,id=net,restrict=on,hostfwd=tcp:127.0.0.1:" + std::to_string(port_) +
      "-:5555 -device virtio-net-pci,netdev=net,romfile= " + needs.devices;
  std::string command =
      "BITELINE_VM_MODULES='" + needs.modules + "' BITELINE_VM_QEMU='" + network + "' exec" +
      quoted(environment("BITELINE_VM_BOOT")) + quoted(environment("BITELINE_VM_KERNEL")) +
      quoted(environment("BITELINE_ARM64_BUILD")) + quoted(needs.guest) + " bin/biteline-sensor " +
      needs.program + " --" + quoted(environment("BITELINE_VM_BOARD"));
  for (const std::filesystem::path& file : needs.files) command += quoted(file.string());
  auto started = intake::ChildProcess::start(
      {.program = "/bin/bash", .arguments = {"-c", command}, .pass_stderr = true});
  SUCCEEDS(started);
  process_.emplace(std::move(*started));
}

bool EmulatedMachine::says(std::string_view word) {
  const auto deadline = std::chrono::steady_clock::now() + k_boot_patience;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto line = process_->next_line(seconds{5});
    if (!line && line.error().code != Errc::Timeout) return false;
    if (!line) continue;
    std::printf("%s\n", line->c_str());
    if (line->find(word) != std::string::npos) return true;
  }
  return false;
}

bool EmulatedMachine::cannot_run_here() {
  if (process_->wait(seconds{5}) != k_lacks_something) return false;
  note_skipped("boot.sh lacks something here, see above");
  return true;
}

void EmulatedMachine::tell_the_rest(milliseconds patience) {
  while (const auto line = process_->next_line(patience)) std::printf("%s\n", line->c_str());
}

void EmulatedMachine::ends_well(seconds patience) {
  const auto status = process_->wait(patience);
  SUCCEEDS(status);
  LONGS_EQUAL(0, *status);
}

}  // namespace biteline::test
