// SPDX-License-Identifier: MIT
#pragma once
/// \file EdgeIn on the kernel's GPIO character device: stamps taken in the interrupt, edges counted by the
/// kernel.

#include <atomic>
#include <memory>
#include <optional>

#include "hal/api/edge_in.hpp"
#include "hal/linux/gpiod/edge_request.hpp"

namespace biteline::hal {

class GpiodEdgeIn final : public EdgeIn {
 public:
  [[nodiscard]] static Result<std::unique_ptr<GpiodEdgeIn>> open(const GpioLineAddress& address);

  [[nodiscard]] Result<Edge> next_edge(Nanoseconds timeout) override;
  [[nodiscard]] Result<bool> level() noexcept override;
  [[nodiscard]] EdgeHealth health() const noexcept override;

 private:
  GpiodEdgeIn(Descriptor request, const std::string& name) : request_{std::move(request)}, name_{name} {}

  Descriptor request_;
  std::string name_;
  std::uint32_t last_sequence_{0};
  std::optional<bool> last_rising_;
  std::uint64_t sequence_{0};
  std::atomic<std::uint64_t> edges_{0};
  std::atomic<std::uint64_t> edges_lost_{0};
};

}  // namespace biteline::hal
