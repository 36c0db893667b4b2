// SPDX-License-Identifier: MIT
#pragma once
/// \file Keys for the encrypted and mutually authenticated link (CurveZMQ), and the folder that holds them.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::wire {

/// Z85 text of 40 characters each (32 bytes), as libzmq takes them.
struct KeyPair {
  std::string public_key;
  std::string secret_key;
};

/// What a sensor needs: its own pair, and the public keys of the hosts it lets in.
struct SensorKeys {
  KeyPair own;
  std::vector<std::string> allowed_hosts;
  std::filesystem::path folder{};  ///< where the list is looked at again
};

/// What a host needs: its own pair, and the sensor's public key.
struct HostKeys {
  KeyPair own;
  std::string sensor_public_key;
};

/// Each side makes its own pair where it lives, so that no secret travels: sensor.public, sensor.secret and
/// an empty hosts.allowed on the sensor; host.public and host.secret on the host.  Only the public files are
/// copied over. Secrets are 0600, a folder that is made is 0700.  Existing keys are never overwritten:
/// Errc::WrongState.
[[nodiscard]] Result<void> make_sensor_keys(const std::filesystem::path& folder);
[[nodiscard]] Result<void> make_host_keys(const std::filesystem::path& folder);

enum class KeyOwner { Sensor, Host };
/// A new pair in the place of the old one.  The other side needs the new public key.
[[nodiscard]] Result<void> rotate_keys(const std::filesystem::path& folder, KeyOwner owner);

/// hosts.allowed of a sensor's folder: a host's key under a name, in the place of that name's older one; and
/// out again, by name or key.  A running sensor reads the list again within a second.
[[nodiscard]] Result<void> allow_host(const std::filesystem::path& folder, const std::string& name,
                                      const std::filesystem::path& public_key_file);
[[nodiscard]] Result<void> revoke_host(const std::filesystem::path& folder, const std::string& name_or_key);
[[nodiscard]] Result<std::vector<std::string>> read_allowed_hosts(const std::filesystem::path& folder);

/// Errc::AuthenticationFailed: a secret that others may read, halves of two sets, a list without hosts.
[[nodiscard]] Result<SensorKeys> read_sensor_keys(const std::filesystem::path& folder);
[[nodiscard]] Result<HostKeys> read_host_keys(const std::filesystem::path& folder);

}  // namespace biteline::wire
