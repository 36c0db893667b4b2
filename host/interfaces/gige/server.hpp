// SPDX-License-Identifier: MIT
#pragma once
/// \file The face on the network: its sockets, and the thread that answers clients.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/profile/profile.hpp"
#include "host/interfaces/gige/frame.hpp"
#include "host/interfaces/gige/network.hpp"
#include "host/interfaces/gige/picture_frame.hpp"
#include "host/interfaces/gige/stream_channel.hpp"

namespace biteline::gige {

struct ServerConfig {
  Interface interface;
  /// Who may talk to it, host's byte order; compulsory beyond loopback, empty there: everybody.
  std::vector<std::uint32_t> clients;
  std::string version, serial, name;
  /// For tests: true throws a packet of the stream away instead of sending it for the first time.
  std::function<bool()> lose{};
};

struct ServerCounts {
  StreamCounts stream;
  std::uint64_t lost{0};               ///< thrown away as `lose` said
  std::uint64_t unsent{0};             ///< the network did not take them
  std::uint64_t unsent_again{0};       ///< were to be sent again, and the network did not take them at once
  std::uint64_t strangers{0};          ///< commands of others than `clients`
  std::uint64_t pictures_left_out{0};  ///< not raw, or of another step than the device's
};

/// GVCP's port is fixed (3956), so there is one for each address.  Packets of the stream are not fragmented.
///
/// Thread: "bl-gige" is its own and answers clients; offer(), set_head() and end_scan() send on the caller's,
/// and hold up no command while they wait for the network.
class Server {
 public:
  /// Errc::ConnectFailed: another device has the port, or the interface is gone.
  [[nodiscard]] static Result<std::unique_ptr<Server>> open(const ServerConfig& config);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// As Device has them.
  void set_head(std::size_t columns, const Depth& depth, const PictureShape& pictures = {});
  void set_exposure(Nanoseconds exposure);
  void offer(std::uint64_t scan, const wire::Picture& picture);
  void offer(std::uint64_t scan, const profile::Profile& profile);
  void end_scan();
  [[nodiscard]] bool acquiring() const;
  [[nodiscard]] bool wants_pictures() const;
  [[nodiscard]] std::uint64_t starts() const;  ///< how often a client has started
  [[nodiscard]] ServerCounts counts() const;

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::gige
