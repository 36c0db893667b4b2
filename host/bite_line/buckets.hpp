// SPDX-License-Identifier: MIT
#pragma once
/// \file Points sorted by where they fall, so that threads can go on with what is theirs alone.

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "host/bite_line/pooled_vector.hpp"

namespace biteline::bite_line {

/// The indices of items by bucket, in rising order within each: a counting sort on all threads.
class Buckets {
 public:
  /// `bucket_of(item)`: less than `buckets`, or negative for what is left out.
  template <class BucketOf>
  Buckets(std::size_t items, std::size_t buckets, BucketOf&& bucket_of) : start_(buckets + 1, 0) {
    constexpr std::size_t k_chunk = 16384;
    const std::size_t chunks = (items + k_chunk - 1) / k_chunk;
    PooledVector<int> bucket(items);
    std::vector<std::vector<std::uint32_t>> next(chunks);
    const auto for_chunks = [&](auto&& use) {
      tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
        for (std::size_t i = chunk * k_chunk; i < std::min(items, (chunk + 1) * k_chunk); ++i)
          use(i, next[chunk]);
      });
    };
    for (std::vector<std::uint32_t>& counts : next) counts.assign(buckets, 0);
    for_chunks([&](std::size_t i, std::vector<std::uint32_t>& counts) {
      bucket[i] = bucket_of(i);
      if (bucket[i] >= 0) ++counts[static_cast<std::size_t>(bucket[i])];
    });
    std::uint32_t placed = 0;
    for (std::size_t k = 0; k < buckets; ++k) {
      for (std::vector<std::uint32_t>& counts : next) placed += std::exchange(counts[k], placed);
      start_[k + 1] = placed;
    }
    items_.resize(placed);
    for_chunks([&](std::size_t i, std::vector<std::uint32_t>& places) {
      if (bucket[i] >= 0)
        items_[places[static_cast<std::size_t>(bucket[i])]++] = static_cast<std::uint32_t>(i);
    });
  }

  [[nodiscard]] std::size_t size() const { return start_.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t bucket) const {
    return {items_.data() + start_[bucket], start_[bucket + 1] - start_[bucket]};
  }

 private:
  std::vector<std::uint32_t> start_;
  PooledVector<std::uint32_t> items_;
};

/// The items for which `wanted(item)` holds, in rising order.
template <class Wanted>
[[nodiscard]] PooledVector<std::uint32_t> items_where(std::size_t items, Wanted&& wanted) {
  constexpr std::size_t k_chunk = 16384;
  const std::size_t chunks = (items + k_chunk - 1) / k_chunk;
  PooledVector<std::uint32_t> found(items);
  std::vector<std::size_t> first(chunks + 1, 0);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    std::uint32_t* const begin = found.data() + chunk * k_chunk;
    std::uint32_t* next = begin;
    for (std::size_t i = chunk * k_chunk; i < std::min(items, (chunk + 1) * k_chunk); ++i) {
      *next = static_cast<std::uint32_t>(i);
      next += wanted(i) ? 1 : 0;
    }
    first[chunk + 1] = static_cast<std::size_t>(next - begin);
  });
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) first[chunk + 1] += first[chunk];
  PooledVector<std::uint32_t> kept;
  kept.resize(first.back());
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    std::copy_n(found.data() + chunk * k_chunk, first[chunk + 1] - first[chunk], kept.data() + first[chunk]);
  });
  return kept;
}

}  // namespace biteline::bite_line
