// SPDX-License-Identifier: MIT
#include "host/bite_line/pooled_vector.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <mutex>
#include <new>
#include <vector>

#include <tbb/scalable_allocator.h>

namespace biteline::bite_line {

namespace {

constexpr std::size_t k_least_kept = std::size_t{1} << 15;  // smaller blocks the allocator itself keeps
constexpr std::size_t k_most_kept = std::size_t{1} << 26;   // together: those of a scan of a million points
constexpr std::size_t k_most_blocks = 1024;

/// The same for sizes that differ by less than a quarter, so that the next scan's array fits.
std::size_t rounded(std::size_t bytes) {
  const std::size_t quarter = std::bit_floor(bytes) / 4;
  return (bytes + quarter - 1) / quarter * quarter;
}

struct Block {
  void* memory;
  std::size_t bytes;
};

/// Freed blocks, the latest last.
struct Kept {
  Kept() { blocks.reserve(k_most_blocks); }
  void drop_oldest() {
    scalable_free(blocks.front().memory);
    bytes -= blocks.front().bytes;
    blocks.erase(blocks.begin());
  }

  std::mutex mutex;
  std::vector<Block> blocks;
  std::size_t bytes{0};
};
Kept& kept() {
  static Kept* const all = new Kept;  // arrays may outlive every static object
  return *all;
}

void* fresh(std::size_t bytes) {
  void* const memory = scalable_malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc{};
  return memory;
}

}  // namespace

void* take_block(std::size_t bytes) {
  if (bytes < k_least_kept) return fresh(bytes);
  const std::size_t size = rounded(bytes);
  {
    Kept& all = kept();
    const std::lock_guard lock{all.mutex};
    const auto found = std::find_if(all.blocks.rbegin(), all.blocks.rend(),
                                    [&](const Block& block) { return block.bytes == size; });
    if (found != all.blocks.rend()) {
      void* const memory = found->memory;
      all.blocks.erase(std::next(found).base());
      all.bytes -= size;
      return memory;
    }
  }
  return fresh(size);
}

void give_block(void* memory, std::size_t bytes) noexcept {
  if (bytes < k_least_kept) return scalable_free(memory);
  const std::size_t size = rounded(bytes);
  Kept& all = kept();
  const std::lock_guard lock{all.mutex};
  // Those that nobody asked for longest go first.
  if (size > k_most_kept) return scalable_free(memory);
  while (all.bytes + size > k_most_kept || all.blocks.size() == k_most_blocks) all.drop_oldest();
  all.blocks.push_back({memory, size});
  all.bytes += size;
}

}  // namespace biteline::bite_line
