// SPDX-License-Identifier: MIT
// Shoes of some models, eight sizes and both feet in any order, by a library of two samples for each model.
//   bench_stream [first seed] [models] [shoes] [strangers]
// Every second shoe has an order that names model, foot and size; of those every tenth names a wrong one, and
// has to be told.  Strangers are of models that nobody has taught.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "host/transfer/transfer.hpp"
#include "tests/bench/transfer/stream_shoes.hpp"
#include "tests/support/line_distance.hpp"

namespace biteline::bench {
namespace {

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

void run_one(const transfer::Library& library, const StreamShoe& shoe, std::uint64_t last, Tally& tally) {
  const transfer::SampleFiles upper = ShoeStream::upper_of(shoe, last);
  const auto begin = std::chrono::steady_clock::now();
  const auto found = transfer::identify(library, upper.cloud, shoe.order);
  const auto identified = std::chrono::steady_clock::now();
  ++tally.shoes;
  if (!found) std::exit(1);
  const bool named = !found->name.empty();
  const transfer::Match* best = found->matches.empty() ? nullptr : &found->matches.front();
  const bool sure = named && best->probability >= k_sure_model &&
                    (found->matches.size() < 2 || found->matches[1].probability <= k_most_second);
  const std::string foot = shoe.foot();
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
  ShoeStream stream{first, models};
  if (!stream.teach(library)) std::exit(1);
  Tally free, ordered, misordered, unknown;
  std::map<int, Tally> by_size;
  for (int i = 0; i < shoes; ++i) {
    const StreamShoe shoe = stream.next();
    Tally& tally = shoe.order_is_wrong ? misordered : shoe.order.model.empty() ? free : ordered;
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
    const test::MadeModel model = stream.stranger(i);
    run_one(library, {.model = model, .size = stream.any_size()},
            first + 5001 + static_cast<std::uint64_t>(i), unknown);
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
