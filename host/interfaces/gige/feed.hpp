// SPDX-License-Identifier: MIT
#pragma once
/// \file From the sensor to the face: as an observer, or as the host that owns the scan.

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/wire/endpoint.hpp"
#include "common/wire/keys.hpp"
#include "host/interfaces/gige/server.hpp"

namespace biteline::gige {

struct FeedConfig {
  wire::Endpoint sensor;
  std::optional<wire::HostKeys> keys;  ///< compulsory beyond loopback
  /// A client that acquires asks for scans: the sensor's laser guard lights its laser for them.
  bool allow_control{false};
};

/// An observer, but with `allow_control` and while a client acquires: then a host, which takes every profile
/// in order, keeps the scan's laser alive by its acknowledgements, and ends the scan with the acquisition.
/// Connects again for ever.  Thread: the caller's, until `stop`.
class Feed {
 public:
  /// `say`: a line for the operator.
  Feed(FeedConfig config, Server& server, std::function<void(const std::string&)> say);
  void run(const std::atomic<bool>& stop);

 private:
  /// Until the link is over, or the other kind of link is wanted.
  [[nodiscard]] Result<void> observe(const std::atomic<bool>& stop);
  [[nodiscard]] Result<void> own_scan(const std::atomic<bool>& stop);
  void tell(const Error& error);

  FeedConfig config_;
  Server& server_;
  std::function<void(const std::string&)> say_;
  std::string told_;
};

}  // namespace biteline::gige
