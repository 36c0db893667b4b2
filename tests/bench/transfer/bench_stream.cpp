// SPDX-License-Identifier: MIT
// Shoes of some models, eight sizes and both feet in any order, by a library of two samples for each model.
//   bench_stream [first seed] [models] [shoes] [strangers]
// Every second shoe has an order that names model, foot and size; of those every tenth names a wrong one, and
// has to be told.  Strangers are of models that nobody has taught.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "host/cloud/ply.hpp"
#include "host/transfer/identify.hpp"
#include "host/transfer/sizes.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/made_sizes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::bench {
namespace {

constexpr int k_first_size = 38, k_sizes = 8;
constexpr std::array k_taught_sizes{39, 44};
constexpr double k_middle_size = 41.5;
constexpr std::array k_classes{sim::ShoeClass::Deep, sim::ShoeClass::Shallow, sim::ShoeClass::Step,
                               sim::ShoeClass::Decorated};
// As host/apps/biteline-host/recognise.hpp takes a model without a person.
constexpr double k_sure_model = 0.95, k_most_second = 0.05;

struct Tally {
  int shoes{0}, unsure{0}, no_line{0}, wrong{0}, bound_broken{0}, lines{0};
  double error_mm{0}, worst_mm{0}, bound_mm{0}, seconds{0};

  void print(const std::string& what) const {
    const double count = std::max(1, lines);
    std::printf(
        "{\"bench\":\"transfer.stream\",\"what\":\"%s\",\"shoes\":%d,\"wrong\":%d,\"a_person_asked\":%d,"
        "\"no_line\":%d,\"mean_mm\":%.3f,\"worst_mean_mm\":%.3f,\"bound_mm\":%.3f,\"bound_broken\":%d,"
        "\"s_per_shoe\":%.2f}\n",
        what.c_str(), shoes, wrong, unsure, no_line, error_mm / count, worst_mm, bound_mm / count,
        bound_broken, seconds / std::max(1, shoes));
    std::fflush(stdout);
  }
};

double change_of(int size, double length_mm) {
  return (size - k_middle_size) * 20 / 3 / length_mm;
}

std::string size_text(int size) {
  return transfer::text_of({.system = "EU", .number = static_cast<double>(size)});
}

void teach(const transfer::Library& library, const test::TemporaryFolder& folder,
           const test::MadeModel& model, const std::string& name, int size) {
  const transfer::SampleFiles files = model.sample(change_of(size, model.length_mm()));
  const std::filesystem::path path = folder.path() / "sample";
  std::filesystem::create_directories(path);
  transfer::SaveOptions options;
  options.made.size = size_text(size);
  options.made.foot = "left";
  options.made.of = name;
  const bool saved = cloud::write_cloud(path / transfer::k_cloud_file, files.cloud) &&
                     cloud::write_line(path / transfer::k_line_file, files.line) &&
                     library.save(name + "-" + std::to_string(size), path, options);
  if (!saved) std::exit(1);
}

struct Shoe {
  const test::MadeModel& model;
  std::string name;  ///< of the model; empty: a stranger's
  int size{0};
  bool right{false};
  transfer::ModelOrder order{};
  bool order_is_wrong{false};
};

void add_line(Tally& tally, const transfer::Transfer& carried, const cloud::ClosedLine& truth) {
  double sum_mm = 0, within = 0;
  for (const cloud::LinePoint& point : carried.carried.line.points) {
    const double off_mm = test::distance_mm(point.position, truth);
    sum_mm += off_mm;
    within += off_mm <= carried.bound_mm ? 1 : 0;
  }
  const auto count = static_cast<double>(carried.carried.line.points.size());
  ++tally.lines;
  tally.error_mm += sum_mm / count;
  tally.worst_mm = std::max(tally.worst_mm, sum_mm / count);
  tally.bound_mm += carried.bound_mm;
  if (within < 0.95 * count) ++tally.bound_broken;
  const transfer::Grade& grade = carried.alignment.placement.grade;
  std::fprintf(stderr,
               " mean %.3f bound %.3f within %.2f rim %d doubt %.3f sigma %.3f length %.4f height %.4f",
               sum_mm / count, carried.bound_mm, within / count, static_cast<int>(carried.alignment.rim_used),
               carried.alignment.rim_doubt_mm, carried.alignment.line_sigma_mm, grade.length, grade.height);
}

void run_one(const transfer::Library& library, const Shoe& shoe, std::uint64_t last, Tally& tally) {
  const SE3 T_base_upper = geometry::make_se3(
      Eigen::Quaterniond{Eigen::AngleAxisd{0.3 * static_cast<double>(last % 20), Vec3::UnitZ()}},
      {430, 90, 48});
  const transfer::SampleFiles upper =
      shoe.model.upper(change_of(shoe.size, shoe.model.length_mm()), shoe.right, last, T_base_upper);
  const auto begin = std::chrono::steady_clock::now();
  const auto found = transfer::identify(library, upper.cloud, shoe.order);
  const auto identified = std::chrono::steady_clock::now();
  ++tally.shoes;
  if (!found) std::exit(1);
  const bool named = !found->name.empty();
  const transfer::Match* best = found->matches.empty() ? nullptr : &found->matches.front();
  const bool sure = named && best->probability >= k_sure_model &&
                    (found->matches.size() < 2 || found->matches[1].probability <= k_most_second);
  const std::string foot = shoe.right ? "right" : "left";
  const bool right = named && best->model == shoe.name && best->foot == foot &&
                     best->size == size_text(shoe.size) && !shoe.order_is_wrong;
  std::fprintf(stderr, "%s %s %d%s:", shoe.name.empty() ? "stranger" : shoe.name.c_str(), foot.c_str(),
               shoe.size,
               shoe.order.model.empty() ? ""
               : shoe.order_is_wrong    ? " wrong order"
                                        : " ordered");
  for (const transfer::Match& match : found->matches) {
    if (!match.compared) continue;
    std::fprintf(stderr, " [%s %s %s %d%d p %.3f rough %.2f rms %.3f law %.1f rim %d %.3f]",
                 match.name.c_str(), match.foot.c_str(), match.size.c_str(),
                 static_cast<int>(match.align.mirror), static_cast<int>(match.align.grade), match.probability,
                 match.rough_fit_mm, match.alignment.shape_rms_mm,
                 match.align.law.misfit(match.alignment.placement.grade),
                 static_cast<int>(match.alignment.rim_used), match.alignment.rim_mm);
  }
  if (found->refusal) std::fprintf(stderr, " refused: %s", found->refusal->reason.c_str());
  if (!sure) ++tally.unsure;
  if (sure && !right) {
    ++tally.wrong;
    std::fprintf(stderr, " WRONG");
  }
  if (sure && right) {
    const auto sample = library.load(found->name);
    if (!sample) std::exit(1);
    const transfer::Transfer carried = transfer::transfer_line(*sample, upper.cloud, {.align = best->align});
    if (carried.found)
      add_line(tally, carried, upper.line);
    else
      ++tally.no_line;
    if (!carried.found) std::fprintf(stderr, " NO LINE: %s", carried.reason().c_str());
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const std::chrono::duration<double> looked = identified - begin;
  tally.seconds += took.count();
  std::fprintf(stderr, " %.2f s, %.2f s\n", looked.count(), took.count());
}

void run(std::uint64_t first, int models, int shoes, int strangers) {
  const test::TemporaryFolder folder;
  const transfer::Library library{folder.path() / "models"};
  std::vector<test::MadeModel> made;
  const auto name_of = [](std::size_t m) { return std::string{"model-"} + static_cast<char>('a' + m); };
  for (int m = 0; m < models; ++m) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(m);
    made.emplace_back(k_classes[static_cast<std::size_t>(m) % k_classes.size()], seed, test::drawn_law(seed),
                      sim::ScanSettings{});
    for (const int size : k_taught_sizes)
      teach(library, folder, made.back(), name_of(static_cast<std::size_t>(m)), size);
  }
  std::mt19937_64 random{first};
  const auto below = [&](int count) { return std::uniform_int_distribution<int>{0, count - 1}(random); };
  Tally free, ordered, misordered, unknown;
  std::map<int, Tally> by_size;
  for (int i = 0; i < shoes; ++i) {
    const auto m = static_cast<std::size_t>(below(models));
    Shoe shoe{
        .model = made[m], .name = name_of(m), .size = k_first_size + below(k_sizes), .right = below(2) == 1};
    if (i % 2 == 1)
      shoe.order = {.model = shoe.name, .foot = shoe.right ? "right" : "left", .size = size_text(shoe.size)};
    shoe.order_is_wrong = i % 20 == 19;
    if (shoe.order_is_wrong) {
      const int which = below(3);
      if (which == 0) shoe.order.model = name_of((m + 1) % static_cast<std::size_t>(models));
      if (which == 1) shoe.order.foot = shoe.right ? "left" : "right";
      if (which == 2) shoe.order.size = size_text(shoe.size + 1);
    }
    Tally& tally = shoe.order_is_wrong ? misordered : i % 2 == 1 ? ordered : free;
    const Tally before = tally;
    run_one(library, shoe, first + 1000 + static_cast<std::uint64_t>(i), tally);
    Tally& size = by_size[shoe.size];
    size.shoes += 1;
    size.lines += tally.lines - before.lines;
    size.error_mm += tally.error_mm - before.error_mm;
    size.bound_mm += tally.bound_mm - before.bound_mm;
    size.bound_broken += tally.bound_broken - before.bound_broken;
    size.seconds += tally.seconds - before.seconds;
  }
  for (int i = 0; i < strangers; ++i) {
    const std::uint64_t seed = first + 5000 + static_cast<std::uint64_t>(i);
    const test::MadeModel stranger{k_classes[static_cast<std::size_t>(i) % k_classes.size()], seed,
                                   test::drawn_law(seed), sim::ScanSettings{}};
    run_one(library, {.model = stranger, .name = {}, .size = k_first_size + below(k_sizes)}, seed + 1,
            unknown);
  }
  free.print("without an order");
  ordered.print("ordered");
  misordered.print("another one ordered");
  unknown.print("strangers");
  for (const auto& [size, tally] : by_size) tally.print(size_text(size));
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  biteline::bench::run(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 8001,
                       argc > 2 ? std::atoi(argv[2]) : 5, argc > 3 ? std::atoi(argv[3]) : 200,
                       argc > 4 ? std::atoi(argv[4]) : 40);
}
