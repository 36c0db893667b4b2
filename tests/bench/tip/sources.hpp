// SPDX-License-Identifier: MIT
#pragma once
/// \file What may be off between a shoe's true bite line and a tool's true tip, each to be left out.

#include <array>

namespace biteline::bench {

/// What is as in life; the rest is exact.
struct Sources {
  bool light{true};      ///< speckle; the camera's noise always is
  bool head{true};       ///< camera and laser plane are known as a calibration knows them
  bool hand_eye{true};   ///< noise of the poses and ring centres that the mounting was calibrated from
  bool clock{true};      ///< the pose clock's offset is known as its calibration knows it
  bool links{true};      ///< the arm's are not quite as its maker measured them
  bool give{true};       ///< the arm is elastic, and its poses are noisy
  bool tip{true};        ///< taught by touching, by a hand that repeats to a tenth of a millimetre
  bool following{true};  ///< drives behind their target
};

[[nodiscard]] constexpr Sources no_sources() {
  return {.light = false,
          .head = false,
          .hand_eye = false,
          .clock = false,
          .links = false,
          .give = false,
          .tip = false,
          .following = false};
}

struct NamedSource {
  const char* name;
  bool Sources::*is_on;
};
inline constexpr std::array<NamedSource, 8> k_sources{{{"light", &Sources::light},
                                                       {"head", &Sources::head},
                                                       {"hand-eye", &Sources::hand_eye},
                                                       {"clock", &Sources::clock},
                                                       {"arm's links", &Sources::links},
                                                       {"arm's give", &Sources::give},
                                                       {"tip", &Sources::tip},
                                                       {"following", &Sources::following}}};

/// By whose kinematics is reckoned.
enum class Reckoning {
  Own,          ///< controller and host have the arm's own
  NominalHost,  ///< the host plans with the nominal arm
  Nominal,      ///< the controller, too: an arm that nobody measured
};

}  // namespace biteline::bench
