// SPDX-License-Identifier: MIT
#pragma once
/// \file Memory of the closing steps' large arrays.

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace biteline::bite_line {

/// Memory that was given back before, or fresh one.  Any thread; throws std::bad_alloc.
[[nodiscard]] void* take_block(std::size_t bytes);
/// `bytes`: as many as were taken.
void give_block(void* memory, std::size_t bytes) noexcept;

/// Keeps what was freed for the next array and the next scan, up to 64 MB: a fresh page costs more than the
/// work that is done in it (2 us for 4 kB on a virtual machine).  resize() leaves trivial values as they are.
template <class T>
struct PooledAllocator {
  using value_type = T;
  using is_always_equal = std::true_type;
  PooledAllocator() = default;
  template <class U>
  PooledAllocator(const PooledAllocator<U>&) noexcept {}

  [[nodiscard]] T* allocate(std::size_t count) { return static_cast<T*>(take_block(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) noexcept { give_block(memory, count * sizeof(T)); }

  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    std::construct_at(place, std::forward<Arguments>(arguments)...);
  }
  friend bool operator==(const PooledAllocator&, const PooledAllocator&) { return true; }
};

template <class T>
using PooledVector = std::vector<T, PooledAllocator<T>>;

}  // namespace biteline::bite_line
