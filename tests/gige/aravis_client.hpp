// SPDX-License-Identifier: MIT
#pragma once
/// \file Aravis as the client of a GigE Vision device: what other people's software does with the face.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::test {

struct ArrivedFrame {
  bool complete{false};
  int status{0};  ///< Aravis' own number for why it is not
  std::uint64_t stamp{0};
  std::uint32_t pixel_format{0};
  int width{0}, height{0};
  std::vector<std::uint8_t> payload;
  std::vector<std::uint8_t> lines_chunk;  ///< with chunks only
  /// ChunkProfileSequence, ChunkFlangePose, ChunkExposureTime, ChunkCameraFrame and ChunkEncoderValue as the
  /// description has them: Aravis' parser of chunks has no selectors, so they are the first line's and the
  /// first number.
  std::uint64_t sequence{0};
  double flange{0};
  double exposure_us{0};
  std::uint64_t camera_frame{0};
  bool encoder_valid{false};  ///< ChunkEncoderValid, which says whether the value is available
  std::int64_t encoder_ticks{0};
};

struct StreamStatistics {
  std::uint64_t complete{0}, failed{0}, missing_packets{0}, resent_packets{0};
};

/// Thread: one owner; Aravis has a receiving thread of its own.
class AravisClient {
 public:
  [[nodiscard]] static Result<std::unique_ptr<AravisClient>> open(const std::string& address);
  ~AravisClient();
  AravisClient(const AravisClient&) = delete;
  AravisClient& operator=(const AravisClient&) = delete;

  [[nodiscard]] Result<void> set(const char* feature, std::int64_t value);
  [[nodiscard]] Result<void> choose(const char* feature, const char* value);
  [[nodiscard]] Result<double> real(const char* feature);
  [[nodiscard]] Result<std::string> text(const char* feature);
  /// Every feature that the description lists can be read.
  [[nodiscard]] Result<int> read_all_features();

  [[nodiscard]] Result<void> start(int buffers);
  [[nodiscard]] std::optional<ArrivedFrame> next_frame(Nanoseconds timeout);
  [[nodiscard]] Result<void> stop();
  [[nodiscard]] StreamStatistics statistics() const;

 private:
  struct State;
  explicit AravisClient(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::test
