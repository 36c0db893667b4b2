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
};

/// What a host needs: its own pair, and the sensor's public key.
struct HostKeys {
  KeyPair own;
  std::string sensor_public_key;
};

/// Makes a pair for the sensor and one for a host in `folder`: sensor.public, sensor.secret, host.public,
/// host.secret, and hosts.allowed with the host's public key.  Secret files are 0600.  Existing keys are
/// never overwritten: Errc::WrongState. The host needs sensor.public, host.public and host.secret; the sensor
/// the others; neither needs the other's secret.
[[nodiscard]] Result<void> make_keys(const std::filesystem::path& folder);

/// A secret file that others may read is refused: Errc::AuthenticationFailed.
[[nodiscard]] Result<SensorKeys> read_sensor_keys(const std::filesystem::path& folder);
[[nodiscard]] Result<HostKeys> read_host_keys(const std::filesystem::path& folder);

}  // namespace biteline::wire
