// SPDX-License-Identifier: MIT
#pragma once
/// \file What nobody waits for: done beside an arm that moves.

#include <functional>
#include <future>
#include <utility>

#include "common/core/result.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::service {

/// Pictures and page of a result: the path does not wait for them.  Thread: any, one at a time.
class LatePages {
 public:
  using Write = std::function<Result<void>(const cloud::PointCloud& cloud)>;
  LatePages() = default;
  explicit LatePages(Write write) : write_{std::move(write)} {}
  /// Once: nothing the second time.  `cloud`: the scan's.
  [[nodiscard]] Result<void> write(const cloud::PointCloud& cloud) {
    const Write write = std::exchange(write_, nullptr);
    return write ? write(cloud) : Result<void>{};
  }

 private:
  Write write_;
};

/// The calling thread's name; with `gives_way` everything else goes before it, such as the watch over an arm.
void name_thread(const char* name, bool gives_way);

/// On a thread of its own, `bl-pages`, which gives way.  Exceptions of `work` become an Error.
[[nodiscard]] std::future<Result<void>> begin_beside_arm(std::function<Result<void>()> work);

}  // namespace biteline::service
