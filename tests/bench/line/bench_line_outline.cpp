// SPDX-License-Identifier: MIT
// What an outline is measured by, on the sweep's made shoes and things and on shapes of public origin:
// tests/bench/line/fit_outline.py fits ShoeOutlines (host/bite_line/shoe/plan_shape.hpp) to it.
//
// Of the made shoes only every second one is scanned.  A slide's and a bare upper's outlines are shoes'.
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>

#include <tbb/global_control.h>
#include <tbb/parallel_for_each.h>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/shoe/plan_shape.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "host/bite_line/workings.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/support/line_sweep.hpp"
#include "tests/support/shape_truth.hpp"

namespace biteline::bench {
namespace {

/// `kind`: made, shape or thing.
void write_row(const char* kind, const std::string& name, const cloud::PointCloud& cloud) {
  std::optional<bite_line::Workings> workings;
  const bite_line::Extraction found = bite_line::find_bite_line(cloud, {}, &workings);
  if (!workings) return;
  const bite_line::PlanShape shape = bite_line::plan_shape(bite_line::side_reach(workings->side));
  static std::mutex mutex;
  const std::scoped_lock lock{mutex};
  std::printf("%s,%s,%.4f,%.4f,%.4f,%.5f,%d\n", kind, name.c_str(), shape.broadest_at, shape.end_breadth,
              shape.heel_breadth, bite_line::shoe_chance(shape), found.found ? 1 : 0);
}

int run(int argc, char** argv) {
  SweepOptions asked;
  std::size_t threads = 2;
  options::Command command{"What outlines are measured by", "bench_line_outline"};
  asked.add_to(command);
  command.add_option("--threads", threads, "so many at once");
  if (const std::optional<int> status = read_options(command, argc, argv)) return *status;
  std::printf("kind,class,fault,seed,broadest_at,end_breadth,heel_breadth,chance,found\n");
  const tbb::global_control limit{tbb::global_control::max_allowed_parallelism, threads};
  tbb::parallel_for_each(asked.indices(), [&](std::uint64_t index) {
    const test::SweepCell cell = test::sweep_cell(asked.seed, index);
    if (!asked.asks_for(cell)) return;
    const bool thing = sim::is_thing(cell.shoe.shoe_class) && cell.shoe.shoe_class != sim::ShoeClass::Slide;
    if (!thing && index % 2 == 1) return;
    write_row(thing ? "thing" : "made",
              std::string{sim::name_of(cell.shoe.shoe_class)} + "," + std::string{test::name_of(cell.fault)} +
                  "," + std::to_string(index),
              test::scan_of(cell).cloud);
  });
  for (const test::Shape& shape : test::k_shapes) {
    const auto cloud = test::cloud_of(shape);
    if (!cloud) continue;
    const std::string name = shape.name;
    const bool thing = name.starts_with("n0");
    write_row(thing ? "thing" : "shape", name + ",none,0", *cloud);
  }
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  return biteline::bench::run(argc, argv);
}
