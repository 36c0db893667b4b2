// SPDX-License-Identifier: MIT
#pragma once
/// \file The page's program beside the cell, and one who looks at it all the time.

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "host/intake/child_process.hpp"

namespace biteline::soak {

/// Live data that the viewer got, by their kinds of /api/v1/live.
struct Seen {
  std::uint64_t pictures{0}, profiles{0}, answers{0};
  std::map<std::string, int> losses{};  ///< of the connection, by what ended it
};

/// biteline-web, and a viewer who is logged in, reads all live data and asks for the state each second.  The
/// viewer comes back by himself whatever ends.  Thread: one owner.
class Page {
 public:
  /// Makes the viewer's account in `results` while no service runs: an administrator's, as the first one must
  /// be.
  [[nodiscard]] static Result<void> make_viewer(const std::filesystem::path& programs,
                                                const std::filesystem::path& results);
  Page(std::filesystem::path programs, std::string control, std::string sensor);
  ~Page();
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  /// Also in the place of one that has ended.
  [[nodiscard]] Result<void> start();
  [[nodiscard]] intake::ChildProcess& program() { return *program_; }
  /// A slow browser: it takes nothing more until told so.
  void stop_reading(bool stop) { still_ = stop; }
  /// The viewer says start, until it is taken.
  void say_start() { starts_ = true; }
  [[nodiscard]] Seen seen() const;

 private:
  void look(const std::stop_token& stop);
  [[nodiscard]] std::string visit(std::uint16_t port, const std::stop_token& stop);

  std::filesystem::path programs_;
  std::string control_, sensor_;
  std::uint16_t port_wanted_{0};  ///< the same again, as a browser expects
  std::atomic<std::uint16_t> port_{0};
  std::atomic<bool> still_{false};
  std::atomic<bool> starts_{false};
  std::atomic<std::uint64_t> pictures_{0}, profiles_{0}, answers_{0};
  mutable std::mutex mutex_;
  std::map<std::string, int> losses_;
  std::string token_;  ///< of the viewer's thread
  std::optional<intake::ChildProcess> program_;
  std::jthread viewer_;
};

}  // namespace biteline::soak
