// SPDX-License-Identifier: MIT
#pragma once
/// \file The same points as the programs of other people write them: each habit a writer of its own.

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace biteline::cloud {

/// A file, and what must be read of it.
struct WrittenCloud {
  std::string writer;  ///< for messages
  std::string ending;
  std::string bytes;
  std::vector<Eigen::Vector3d> points;  ///< mm, in order; of a mesh: its corners
  std::size_t without_number{0};        ///< points, or triangles, to be left out
  bool mesh{false};
  bool counted{false};  ///< the file says how many points it has: none can be missing unnoticed
};

/// Habits that write_cloud_as() knows: numbers below it.
[[nodiscard]] int writer_habits();

/// A cloud of 40 to 120 points, some without numbers, as the program `habit` writes it, with its choices
/// (digits, line ends, further columns, unit in the head) by `seed`.
[[nodiscard]] WrittenCloud write_cloud_as(int habit, std::uint32_t seed);

}  // namespace biteline::cloud
