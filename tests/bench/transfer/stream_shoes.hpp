// SPDX-License-Identifier: MIT
#pragma once
/// \file Shoes of some models, eight sizes and both feet in any order, and a library of two samples for each
/// model.

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "host/cloud/ply.hpp"
#include "host/transfer/identify.hpp"
#include "host/transfer/sizes.hpp"
#include "tests/support/made_sizes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::bench {

/// One that comes: which it is, and what an order says of it.
struct StreamShoe {
  const test::MadeModel& model;
  std::string name{};  ///< of the model; empty: a stranger's
  int size{0};
  bool right{false};
  transfer::ModelOrder order{};
  bool order_is_wrong{false};

  [[nodiscard]] const char* foot() const { return right ? "right" : "left"; }
};

inline std::string size_text(int size) {
  return transfer::text_of({.system = "EU", .number = static_cast<double>(size)});
}

/// Every second shoe has an order that names model, foot and size; of those every tenth names a wrong one.
class ShoeStream {
 public:
  ShoeStream(std::uint64_t seed, int models) : seed_{seed}, random_{seed} {
    for (int m = 0; m < models; ++m) models_.push_back(made(m, seed + static_cast<std::uint64_t>(m)));
  }

  /// False: the disk.
  [[nodiscard]] bool teach(const transfer::Library& library) const {
    const test::TemporaryFolder folder;
    for (std::size_t m = 0; m < models_.size(); ++m)
      for (const int size : k_taught_sizes)
        if (!teach_one(library, folder, m, size)) return false;
    return true;
  }

  [[nodiscard]] StreamShoe next() {
    const auto m = static_cast<std::size_t>(below(static_cast<int>(models_.size())));
    StreamShoe shoe{.model = models_[m],
                    .name = name_of(m),
                    .size = k_first_size + below(k_sizes),
                    .right = below(2) == 1};
    const int i = drawn_++;
    if (i % 2 == 1) shoe.order = {.model = shoe.name, .foot = shoe.foot(), .size = size_text(shoe.size)};
    shoe.order_is_wrong = i % 20 == 19;
    if (!shoe.order_is_wrong) return shoe;
    const int which = below(3);
    if (which == 0) shoe.order.model = name_of((m + 1) % models_.size());
    if (which == 1) shoe.order.foot = shoe.right ? "left" : "right";
    if (which == 2) shoe.order.size = size_text(shoe.size + 1);
    return shoe;
  }

  /// Of a model that nobody has taught.
  [[nodiscard]] test::MadeModel stranger(int i) const {
    return made(i, seed_ + 5000 + static_cast<std::uint64_t>(i));
  }
  [[nodiscard]] int any_size() { return k_first_size + below(k_sizes); }

  /// The upper of a last of its own as it stands before the head, with its true line.
  [[nodiscard]] static transfer::SampleFiles upper_of(const StreamShoe& shoe, std::uint64_t last) {
    const SE3 T_base_upper = geometry::make_se3(
        Eigen::Quaterniond{Eigen::AngleAxisd{0.3 * static_cast<double>(last % 20), Vec3::UnitZ()}},
        {430, 90, 48});
    return shoe.model.upper(change_of(shoe.size, shoe.model.length_mm()), shoe.right, last, T_base_upper);
  }

 private:
  static constexpr int k_first_size = 38, k_sizes = 8;
  static constexpr std::array k_taught_sizes{39, 44};
  static constexpr double k_middle_size = 41.5;
  static constexpr std::array k_classes{sim::ShoeClass::Deep, sim::ShoeClass::Shallow, sim::ShoeClass::Step,
                                        sim::ShoeClass::Decorated};

  static test::MadeModel made(int i, std::uint64_t seed) {
    return {k_classes[static_cast<std::size_t>(i) % k_classes.size()], seed, test::drawn_law(seed), {}};
  }
  static std::string name_of(std::size_t m) { return std::string{"model-"} + static_cast<char>('a' + m); }
  static double change_of(int size, double length_mm) { return (size - k_middle_size) * 20 / 3 / length_mm; }
  int below(int count) { return std::uniform_int_distribution<int>{0, count - 1}(random_); }

  [[nodiscard]] bool teach_one(const transfer::Library& library, const test::TemporaryFolder& folder,
                               std::size_t m, int size) const {
    const test::MadeModel& model = models_[m];
    const transfer::SampleFiles files = model.sample(change_of(size, model.length_mm()));
    const std::filesystem::path path = folder.path() / "sample";
    std::filesystem::create_directories(path);
    transfer::SaveOptions options;
    options.made.size = size_text(size);
    options.made.foot = "left";
    options.made.of = name_of(m);
    return cloud::write_cloud(path / transfer::k_cloud_file, files.cloud) &&
           cloud::write_line(path / transfer::k_line_file, files.line) &&
           library.save(name_of(m) + "-" + std::to_string(size), path, options);
  }

  std::uint64_t seed_;
  std::mt19937_64 random_;
  int drawn_{0};
  std::vector<test::MadeModel> models_;
};

}  // namespace biteline::bench
