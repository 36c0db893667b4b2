// SPDX-License-Identifier: MIT
#pragma once
/// \file What a fuzz target is made of: bytes taken apart, a file that a reader can open, a word when a claim
/// is broken.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "common/core/error.hpp"

namespace biteline::fuzz {

/// A broken claim ends the target, as a report of a sanitizer does; the case is kept.
inline void demand(bool holds, const char* claim) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: broken: %s\n", claim);
  std::abort();
}

/// Whatever an error says must be one clean line.
inline void demand_clean(const Error& error) {
  for (const char letter : to_line(error))
    demand(static_cast<unsigned char>(letter) >= 0x20 && letter != 0x7F,
           "an error's line has no control characters");
}

/// Takes a case apart from its beginning; zeros once it is used up.
class Case {
 public:
  Case(const std::uint8_t* bytes, std::size_t size) : bytes_{bytes}, size_{size} {}

  template <class T>
  T take() {
    T value{};
    const std::size_t count = std::min(sizeof(T), size_);
    if (count > 0) std::memcpy(&value, bytes_, count);
    skip(count);
    return value;
  }
  /// Copied, so that reading one byte too many is seen.
  std::vector<std::uint8_t> take_bytes(std::size_t count) {
    count = std::min(count, size_);
    std::vector<std::uint8_t> out(bytes_, bytes_ + count);
    skip(count);
    return out;
  }
  std::vector<std::uint8_t> rest() { return take_bytes(size_); }
  [[nodiscard]] bool empty() const { return size_ == 0; }

 private:
  void skip(std::size_t count) {
    bytes_ += count;
    size_ -= count;
  }
  const std::uint8_t* bytes_;
  std::size_t size_;
};

/// A file in memory, under a name that readers can open.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* bytes, std::size_t size) : number_{::memfd_create("case", MFD_CLOEXEC)} {
    demand(number_ >= 0 && ::write(number_, bytes, size) == static_cast<ssize_t>(size),
           "the machine has memory");
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(number_); }
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(number_); }

 private:
  int number_;
};

}  // namespace biteline::fuzz
