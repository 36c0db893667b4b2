// SPDX-License-Identifier: MIT
#include "hal/linux/pwm/sysfs_pwm.hpp"

#include <dirent.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {
namespace {

/// The last part of what `<chip>/device` points at.
std::string device_name(const std::string& chip_folder) {
  std::array<char, PATH_MAX> target{};
  if (::realpath((chip_folder + "/device").c_str(), target.data()) == nullptr) return {};
  const std::string_view path{target.data()};
  return std::string{path.substr(path.rfind('/') + 1)};
}

Result<std::string> find_chip(const SysfsPwm::Config& config) {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder{::opendir(config.root.c_str()), &::closedir};
  while (folder) {
    const dirent* entry = ::readdir(folder.get());
    if (entry == nullptr) break;
    const std::string path = config.root + "/" + entry->d_name;
    if (config.chip == entry->d_name || config.chip == device_name(path)) return path;
  }
  return fail(Errc::DeviceNotFound, "PWM %.60s in %.100s", config.chip.c_str(), config.root.c_str());
}

}  // namespace

Result<std::unique_ptr<SysfsPwm>> SysfsPwm::open(const Config& config) {
  BITELINE_ASSIGN(const std::string chip, find_chip(config));
  const std::string folder = chip + "/pwm" + std::to_string(config.channel);
  if (::access(folder.c_str(), F_OK) != 0) {
    Result<void> exported = write_text((chip + "/export").c_str(), std::to_string(config.channel));
    if (!exported) return tl::unexpected<Error>{exported.error()};
  }
  std::unique_ptr<SysfsPwm> pwm{new SysfsPwm{folder}};
  BITELINE_TRY(pwm->stop());
  return pwm;
}

SysfsPwm::~SysfsPwm() {
  static_cast<void>(stop());
}

Result<PwmSettings> SysfsPwm::configure(const PwmSettings& wanted) {
  if (wanted.period <= Nanoseconds{0} || wanted.pulse < Nanoseconds{0} || wanted.pulse > wanted.period) {
    return fail(Errc::BadValue, "PWM period %lld ns, pulse %lld ns",
                static_cast<long long>(wanted.period.count()), static_cast<long long>(wanted.pulse.count()));
  }
  // The kernel refuses a pulse longer than the period at every single write: shorten first, lengthen last.
  BITELINE_ASSIGN(const std::int64_t pulse_now_ns, read("duty_cycle"));
  if (pulse_now_ns > wanted.period.count()) BITELINE_TRY(write("duty_cycle", wanted.pulse.count()));
  BITELINE_TRY(write("period", wanted.period.count()));
  BITELINE_TRY(write("duty_cycle", wanted.pulse.count()));
  configured_ = true;
  return wanted;
}

Result<void> SysfsPwm::start() {
  if (!configured_) return fail(Errc::WrongState, "PWM started before it was configured");
  BITELINE_TRY(write("enable", 1));
  running_ = true;
  return {};
}

Result<void> SysfsPwm::stop() noexcept {
  // A channel that never had a period refuses even to be told off.
  BITELINE_ASSIGN(const std::int64_t enabled, read("enable"));
  if (enabled != 0) BITELINE_TRY(write("enable", 0));
  running_ = false;
  return {};
}

Result<void> SysfsPwm::write(const char* attribute, std::int64_t value) const {
  return write_text((folder_ + "/" + attribute).c_str(), std::to_string(value));
}

Result<std::int64_t> SysfsPwm::read(const char* attribute) const {
  return read_integer((folder_ + "/" + attribute).c_str());
}

}  // namespace biteline::hal
