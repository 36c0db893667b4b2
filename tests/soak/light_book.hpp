// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether somebody asked for each lighting of the laser.

#include <cstdint>

namespace biteline::soak {

/// Each lighting of the laser has an asking of the service of its own.  An asking without a light is over
/// with the next one.
class LightBook {
 public:
  /// `lit`: the laser, so often until now; `asked`: the service, at least what it had said by then.  How many
  /// lightings since the last look nobody asked for.
  [[nodiscard]] std::uint64_t unasked(std::uint64_t lit, std::uint64_t asked);

 private:
  std::uint64_t lit_{0}, asked_{0};
  bool open_{false};  ///< the newest asking may still come to its light
};

}  // namespace biteline::soak
