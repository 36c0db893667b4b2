// SPDX-License-Identifier: MIT
#pragma once
/// \file A UR controller that does nothing but answer: RTDE at about 100 Hz, a script port that keeps what it
/// gets, a dashboard.

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace biteline::robot::test {

class FakeController {
 public:
  FakeController();
  ~FakeController();
  FakeController(const FakeController&) = delete;
  FakeController& operator=(const FakeController&) = delete;

  [[nodiscard]] std::uint16_t rtde_port() const { return rtde_port_; }
  [[nodiscard]] std::uint16_t script_port() const { return script_port_; }
  [[nodiscard]] std::uint16_t dashboard_port() const { return dashboard_port_; }

  std::atomic<std::int32_t> robot_mode{7};
  std::atomic<std::int32_t> safety_mode{1};
  std::atomic<std::uint32_t> runtime_state{1};
  std::atomic<bool> silent{false};  ///< keeps connections but sends no data
  std::atomic<bool> not_a_number{false};
  std::atomic<bool> turning{false};  ///< its first joint, by 0.01 rad each state
  std::atomic<bool> drop{false};     ///< set to drop the RTDE connection once; cleared when done
  std::atomic<int> rtde_connections{0};

  [[nodiscard]] std::string script() const;
  [[nodiscard]] std::string dashboard() const;

 private:
  void serve();

  int rtde_listener_{-1}, script_listener_{-1}, dashboard_listener_{-1};
  std::uint16_t rtde_port_{0}, script_port_{0}, dashboard_port_{0};
  mutable std::mutex mutex_;
  std::string script_, dashboard_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace biteline::robot::test
