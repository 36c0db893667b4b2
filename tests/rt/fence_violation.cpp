// SPDX-License-Identifier: MIT
// A library that does what the hot path must not: proof that the fence looks.
#include <mutex>
#include <vector>

namespace biteline::test {

std::mutex g_mutex;

int rt_breaks_the_fence(int count) {
  const std::lock_guard lock{g_mutex};
  std::vector<int> numbers(static_cast<std::size_t>(count));
  return numbers.at(1);
}

}  // namespace biteline::test
