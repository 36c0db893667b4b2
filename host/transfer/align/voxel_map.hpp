// SPDX-License-Identifier: MIT
#pragma once
/// \file Points to voxels: a hash map with open addressing, made for points that come in scan order.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

namespace biteline::transfer {

using VoxelKey = std::uint64_t;

/// 21 bits per axis: at 0.1 mm pitch that is 200 m around the origin.
class VoxelGrid {
 public:
  explicit VoxelGrid(float pitch_mm) : per_mm_{1.0F / pitch_mm} {}

  [[nodiscard]] VoxelKey key(const Eigen::Vector3f& point) const {
    return pack(cell(point.x()), cell(point.y()), cell(point.z()));
  }

  /// Pre: each step is -1, 0 or 1, and the voxel is not at the edge of the range.
  [[nodiscard]] static VoxelKey neighbour(VoxelKey key, int dx, int dy, int dz) {
    return key + static_cast<VoxelKey>(dx) + (static_cast<VoxelKey>(dy) << k_bits) +
           (static_cast<VoxelKey>(dz) << (2 * k_bits));
  }

 private:
  static constexpr int k_bits = 21;
  static constexpr std::int64_t k_offset = 1 << (k_bits - 1);

  [[nodiscard]] std::int64_t cell(float coordinate_mm) const {
    return static_cast<std::int64_t>(std::floor(coordinate_mm * per_mm_));
  }
  [[nodiscard]] static VoxelKey pack(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<VoxelKey>(x + k_offset) + (static_cast<VoxelKey>(y + k_offset) << k_bits) +
           (static_cast<VoxelKey>(z + k_offset) << (2 * k_bits));
  }

  float per_mm_;
};

/// Numbers the occupied voxels 0, 1, 2, ... in order of first use.
class VoxelMap {
 public:
  VoxelMap() : slots_(k_first_capacity) {}

  [[nodiscard]] std::size_t size() const { return keys_.size(); }
  [[nodiscard]] const std::vector<VoxelKey>& keys() const { return keys_; }

  /// The voxel's number; a new one when it was empty.
  std::uint32_t number(VoxelKey key) {
    if (!keys_.empty() && key == last_key_) return last_number_;
    if (2 * keys_.size() >= slots_.size()) grow();
    std::uint32_t& slot = slots_[slot_of(key)];
    if (slot == 0) {
      keys_.push_back(key);
      slot = static_cast<std::uint32_t>(keys_.size());
    }
    last_key_ = key;
    last_number_ = slot - 1;
    return last_number_;
  }

  /// The voxel's number, or -1.
  [[nodiscard]] std::int64_t find(VoxelKey key) const {
    return static_cast<std::int64_t>(slots_[slot_of(key)]) - 1;
  }

 private:
  static constexpr std::size_t k_first_capacity = 1U << 14;

  [[nodiscard]] std::size_t slot_of(VoxelKey key) const {
    // Fibonacci hashing: the high bits of the product are well mixed.
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 32) & mask;
    while (slots_[at] != 0 && keys_[slots_[at] - 1] != key) at = (at + 1) & mask;
    return at;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), 0);
    for (std::size_t i = 0; i < keys_.size(); ++i)
      slots_[slot_of(keys_[i])] = static_cast<std::uint32_t>(i + 1);
  }

  std::vector<std::uint32_t> slots_;  ///< number + 1; 0: free
  std::vector<VoxelKey> keys_;
  VoxelKey last_key_{0};
  std::uint32_t last_number_{0};
};

}  // namespace biteline::transfer
