// SPDX-License-Identifier: MIT
#pragma once
/// \file The fleet in Prometheus' text form (exposition format 0.0.4), and the port that gives it.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "common/core/result.hpp"
#include "host/fleet/centre.hpp"
#include "host/fleet/odd_cell.hpp"

namespace biteline::fleet {

struct OddOfModel {
  std::string model;
  OddCell odd;
};

struct FleetNews {
  bool broker{false};      ///< there is a line
  bool database{false};    ///< it answers
  std::uint64_t taken{0};  ///< shoes that came from the broker, also those that come again
  std::vector<CellRow> cells{};
  std::vector<OddOfModel> odd{};
};

[[nodiscard]] std::string metrics_text(const FleetNews& news);

/// GET /metrics on loopback for who shows a token (Authorization: Bearer TOKEN), one client at a time, each
/// for 2 s at most. Thread: one of its own ("bl-metrics"); the methods are safe from any.
class MetricsPort {
 public:
  /// Whether this token may read; on the port's thread.
  using MayRead = std::function<bool(const std::string& token)>;

  /// 0: any free port.  Errc::PeerRefused: the port is taken.
  [[nodiscard]] static Result<std::unique_ptr<MetricsPort>> open(std::uint16_t port, MayRead may_read);
  ~MetricsPort();

  [[nodiscard]] std::uint16_t port() const;
  void show(std::string text);

 private:
  struct State;
  explicit MetricsPort(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::fleet
