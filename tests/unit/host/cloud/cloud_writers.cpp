// SPDX-License-Identifier: MIT
#include "tests/unit/host/cloud/cloud_writers.hpp"

#include <array>

#include "tests/unit/host/cloud/cloud_author.hpp"

namespace biteline::cloud {
namespace {

struct Habit {
  const char* name;
  void (*write)(writers::Author&);
};
constexpr std::array k_habits{Habit{"CloudCompare", writers::cloud_compare},
                              Habit{"Excel", writers::excel},
                              Habit{"pandas", writers::pandas},
                              Habit{"ParaView", writers::paraview},
                              Habit{"Matlab", writers::matlab},
                              Habit{"Fortran", writers::fortran},
                              Habit{"old Windows", writers::old_windows},
                              Habit{"metrology", writers::metrology},
                              Habit{"mixed units", writers::mixed_units},
                              Habit{"PTS", writers::pts},
                              Habit{"R", writers::r_table},
                              Habit{"PLY", writers::ply},
                              Habit{"PCD", writers::pcd},
                              Habit{"STL", writers::stl},
                              Habit{"OBJ", writers::obj}};

}  // namespace

int writer_habits() {
  return static_cast<int>(k_habits.size());
}

WrittenCloud write_cloud_as(int habit, std::uint32_t seed) {
  WrittenCloud out;
  writers::Author author{out, seed};
  const Habit& as = k_habits.at(static_cast<std::size_t>(habit));
  out.writer = std::string{as.name} + ", seed " + std::to_string(seed);
  as.write(author);
  return out;
}

}  // namespace biteline::cloud
