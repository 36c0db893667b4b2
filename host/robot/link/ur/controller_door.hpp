// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a controller is asked about itself and told to stop, whichever language it has for that.

#include <memory>
#include <string>

#include "host/robot/link/ur/controller_words.hpp"
#include "host/robot/link/ur/delivery.hpp"
#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {

inline constexpr std::uint16_t k_dashboard_port = 29999, k_robot_api_port = 80, k_primary_port = 30001;

/// Port 0: not asked there.
struct DoorPlaces {
  Endpoint dashboard{};  ///< of a CB3 or an e-Series
  Endpoint robot_api{};  ///< of a PolyScope X, which has no dashboard
  Endpoint script{};     ///< tells the version of a PolyScope X
};

/// The dashboard (dashboard.hpp) or the Robot API (robot_api.hpp).  Not thread-safe.
class ControllerDoor {
 public:
  virtual ~ControllerDoor() = default;

  /// That of the two which answers: the dashboard is called first.  An Error: neither; of both it is the
  /// dashboard's, with the Robot API's words.
  [[nodiscard]] static Result<std::unique_ptr<ControllerDoor>> open(const DoorPlaces& places,
                                                                    Nanoseconds patience);
  /// That which is called first, and nobody has called it: good for stop_word().
  [[nodiscard]] static std::unique_ptr<ControllerDoor> closed(const DoorPlaces& places);

  /// All that is asked; `patience`: for each answer.
  [[nodiscard]] virtual Result<ControllerWords> words(Nanoseconds patience) = 0;
  /// Whether it is in remote control: on its way when this returns; the answer is not waited for.
  [[nodiscard]] virtual Result<void> ask_remote() = 0;
  /// "true", "false", or other words of a controller that does not tell.  Errc::Timeout.  Without patience:
  /// what has arrived already.
  [[nodiscard]] virtual Result<std::string> hear_remote(Nanoseconds patience) = 0;
  /// Ends the program that runs; nothing else waits for it or keeps it waiting.
  [[nodiscard]] virtual Delivery stop_word() = 0;
};

/// One door, all questions.  An Error when nobody answers.
[[nodiscard]] Result<ControllerWords> ask_controller(const DoorPlaces& places, Nanoseconds patience);

}  // namespace biteline::robot::ur
