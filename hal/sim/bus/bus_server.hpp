// SPDX-License-Identifier: MIT
#pragma once
/// \file The cell's end of the wires.

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hal/linux/posix/descriptor.hpp"
#include "hal/sim/bus/message.hpp"

namespace biteline::sim {

/// A local stream socket in the abstract namespace (no file, gone with its process), all messages of one
/// size.  It notices the death of a client: what that client drove falls back, as a kernel lets go of a dead
/// process's lines.  A slow client loses messages (counted), and never holds up the others.
///
/// Thread: every method from any thread; the callbacks are called on the server's own thread or on the
/// caller's of drive(), one at a time for each line.
class BusServer {
 public:
  struct Callbacks {
    std::function<void(Line, bool active, SensorClock::time_point)> on_line;
    std::function<void(Nanoseconds period, Nanoseconds pulse)> on_trigger;
    std::function<void(const hal::CanFrame&)> on_can;
  };
  /// `name`: how clients find it, for example "biteline-cell-1234".
  [[nodiscard]] static Result<std::unique_ptr<BusServer>> open(const std::string& name, Callbacks callbacks);
  ~BusServer();
  BusServer(const BusServer&) = delete;
  BusServer& operator=(const BusServer&) = delete;

  /// Drives a line from the cell's side.
  void drive(Line line, bool active, SensorClock::time_point stamp);
  [[nodiscard]] bool level(Line line) const { return levels_[static_cast<std::size_t>(line)].load(); }
  /// One frame to everybody on the pose bus.
  void send(const hal::CanFrame& frame);

  /// Hears nobody any more; drive() and send() then reach nobody.
  void close();

  [[nodiscard]] std::uint64_t messages_dropped() const { return dropped_.load(); }

 private:
  struct Client {
    hal::Descriptor socket;
    std::uint32_t lines{0};
    std::uint32_t driven{0};
    bool wants_can{false};
    bool drives_trigger{false};
  };

  BusServer(hal::Descriptor listener, hal::Descriptor wake, Callbacks callbacks);
  void serve();
  void accept_client();
  /// false: the client is gone.
  bool read_from(Client& client);
  void let_go(const Client& client);
  void change(Line line, bool active, SensorClock::time_point stamp);
  void post(const Client& client, const BusMessage& message);

  hal::Descriptor listener_, wake_;
  Callbacks callbacks_;
  std::array<std::atomic<bool>, static_cast<std::size_t>(Line::Count)> levels_{};
  std::array<std::uint64_t, static_cast<std::size_t>(Line::Count)> edges_{};
  std::mutex change_mutex_;  ///< one line changes at a time
  std::mutex clients_mutex_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace biteline::sim
