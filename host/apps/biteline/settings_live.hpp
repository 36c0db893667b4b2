// SPDX-License-Identifier: MIT
#pragma once
/// \file The settings of a sensor that runs, over the network.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "common/settings/settings.hpp"

namespace biteline::app {

struct SensorAddress {
  std::string endpoint;        ///< "tcp://HOST:PORT"
  std::filesystem::path keys;  ///< empty: none; compulsory beyond loopback
};

/// The sensor checks the whole set, tells its camera, reads it back and takes it, or refuses it by name and
/// goes on with what it had.  Errc::PeerRefused: its words.  Errc::NotSupported: older than protocol 1.2.
[[nodiscard]] Result<void> send_settings(const SensorAddress& address, const settings::SettingsSet& set);

/// What it runs with now, whole, as a settings file.
[[nodiscard]] Result<std::string> fetch_settings(const SensorAddress& address);

}  // namespace biteline::app
