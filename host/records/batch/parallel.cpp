// SPDX-License-Identifier: MIT
#include "host/records/batch/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace biteline::batch {

Result<void> for_each_index(std::size_t count, int jobs,
                            const std::function<Result<void>(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::optional<Error> first;  // guarded by mutex until the threads are joined
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      if (const Result<void> done = work(i); !done) {
        const std::lock_guard lock{mutex};
        if (!first) first = done.error();
        next = count;
      }
    }
  };
  std::vector<std::jthread> threads;
  const auto most = std::min(count, static_cast<std::size_t>(std::max(jobs, 1)));
  for (std::size_t i = 0; i < most; ++i) threads.emplace_back(run);
  threads.clear();
  if (first) return tl::unexpected<Error>(*first);
  return {};
}

}  // namespace biteline::batch
