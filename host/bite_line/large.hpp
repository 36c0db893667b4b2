// SPDX-License-Identifier: MIT
#pragma once
/// \file Memory of the closing steps' large arrays.

#include <memory>
#include <utility>
#include <vector>

#include <tbb/scalable_allocator.h>

namespace biteline::bite_line {

/// Keeps what was freed for the next array and the next scan: a fresh page costs more than the work that is
/// done in it (2 us for 4 kB on a virtual machine).  resize() leaves trivial values as they are.
template <class T>
struct LargeAllocator : tbb::scalable_allocator<T> {
  template <class U>
  struct rebind {
    using other = LargeAllocator<U>;
  };
  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) noexcept {}

  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    std::construct_at(place, std::forward<Arguments>(arguments)...);
  }
};

template <class T>
using Large = std::vector<T, LargeAllocator<T>>;

}  // namespace biteline::bite_line
