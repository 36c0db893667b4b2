// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/arm_lock.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

#include "host/apps/biteline-host/scan_pipeline.hpp"

namespace biteline::service {
namespace {

/// The same text for every name of one machine.
Result<std::string> numeric_address(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(host.c_str(), nullptr, &hints, &found); code != 0)
    return fail(Errc::ConnectFailed, "robot %.100s: %s", host.c_str(), gai_strerror(code));
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses{found, &freeaddrinfo};
  char text[NI_MAXHOST];
  if (const int code =
          getnameinfo(found->ai_addr, found->ai_addrlen, text, sizeof text, nullptr, 0, NI_NUMERICHOST);
      code != 0)
    return fail(Errc::ConnectFailed, "robot %.100s: %s", host.c_str(), gai_strerror(code));
  return std::string{text};
}

constexpr const char* k_lock_folder = "/run/lock";

bool is_loopback(const std::string& address) {
  return address.starts_with("127.") || address == "::1";
}

std::string network_namespace() {
  struct stat status {};
  return ::stat("/proc/self/ns/net", &status) == 0 ? std::to_string(status.st_ino) : "0";
}

}  // namespace

Result<report::FileLock> hold_arm(const std::string& host, std::uint16_t script_port,
                                  const std::string& holder) {
  BITELINE_ASSIGN(std::string name, numeric_address(host));
  if (is_loopback(name)) name = "loopback-" + network_namespace() + "-" + std::to_string(script_port);
  for (char& c : name) c = c == ':' || c == '%' ? '-' : c;
  // Where every user of the machine, and every unit, holds its locks.  No other folder stands in for it: in a
  // unit /tmp is its own, and a lock that nobody else sees holds nothing.
  if (::access(k_lock_folder, W_OK) != 0)
    return fail_errno(
        Errc::WriteFailed, errno,
        "%s: no arm is held there, so no path is sent: a unit needs ReadWritePaths=%s, a machine "
        "the folder (mkdir -m 1777 %s)",
        k_lock_folder, k_lock_folder, k_lock_folder);
  return report::FileLock::take(std::string{k_lock_folder} + "/biteline-arm-" + name, holder);
}

Result<std::unique_ptr<robot::ur::ArmClaim>> claim_arm(const RobotOptions& robot) {
  using robot::ur::ArmClaim;
  if (robot.hold_register < 0) return std::unique_ptr<ArmClaim>{};
  BITELINE_ASSIGN(const HostPort rtde, parse_host_port(robot.rtde));
  BITELINE_ASSIGN(
      std::unique_ptr<ArmClaim> claim,
      ArmClaim::take({.host = rtde.host, .rtde_port = rtde.port, .input_register = robot.hold_register}));
  if (claim->state() == ArmClaim::State::Held) log_step("holds the arm at %s", rtde.host.c_str());
  if (claim->state() == ArmClaim::State::Lacking)
    log_step("the arm at %s cannot be held against services on other machines", rtde.host.c_str());
  return claim;
}

Result<std::shared_ptr<robot::other::ArmLink>> connect_arm(const HostPort& at) {
  BITELINE_ASSIGN(std::shared_ptr<robot::other::ArmLink> link,
                  robot::other::ArmLink::open({.host = at.host, .port = at.port, .may_be_away = true}));
  if (link->robot()) log_step("holds the arm at %s", link->address().c_str());
  return link;
}

}  // namespace biteline::service
