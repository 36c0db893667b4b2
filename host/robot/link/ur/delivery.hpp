// SPDX-License-Identifier: MIT
#pragma once
/// \file Words that stop an arm, each on its own way: none waits for another's connection or answer.

#include <optional>
#include <span>
#include <string>

#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {

/// One text to one door of the controller: over the connection that is kept, where that lives and takes the
/// whole text at once, and else over a fresh one, as often as it takes.
class Delivery {
 public:
  /// `kept` is replaced by the fresh connection; it outlives this.
  Delivery(TcpStream& kept, Endpoint at, std::string text)
      : stream_{kept}, at_{std::move(at)}, text_{std::move(text)} {}

  /// Leaves the kept connection alone: a word that went over it came to nothing.
  void use_fresh() { stream_.close(); }
  /// As far as it goes at once.
  void push();
  [[nodiscard]] bool gone() const { return gone_; }
  [[nodiscard]] int socket() const { return stream_.number(); }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  TcpStream& stream_;
  Endpoint at_;
  std::string text_;
  std::size_t sent_{0};
  bool looked_{false}, fresh_{false}, gone_{false};
  std::optional<Error> error_;
};

/// All of them, in turn, until each has left this machine; after `patience` the first that has not is told.
[[nodiscard]] Result<void> deliver(std::span<Delivery> words, Nanoseconds patience);

}  // namespace biteline::robot::ur
