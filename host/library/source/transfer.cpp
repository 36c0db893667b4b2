// SPDX-License-Identifier: MIT
#include "biteline/transfer.hpp"

#include "host/library/source/inside.hpp"
#include "host/transfer/transfer.hpp"

namespace biteline::sdk {

struct Sample::State {
  transfer::ReadySample sample;
};

Sample::Sample(const Cloud& cloud, const Line& line)
    : state_{std::make_shared<const State>(State{transfer::ReadySample{
          transfer::SampleFiles{.cloud = cloud.state().cloud, .line = to_inside(line)}}})} {}

Sample read_sample(const std::filesystem::path& folder) {
  transfer::SampleFiles files = or_throw(transfer::read_sample(folder));
  return Sample{make_cloud(std::move(files.cloud)), from_inside(files.line)};
}

CarriedLine transfer_line(const Sample& sample, const Cloud& upper, const TransferOptions& options) {
  transfer::TransferOptions inside;
  inside.align.mirror = options.mirror;
  inside.align.grade = options.grade;
  const transfer::Transfer carried =
      transfer::transfer_line(sample.state().sample, upper.state().cloud, inside);
  if (!carried.found) throw_refusal(*carried.told());
  return {.line = from_inside(carried.carried.line),
          .confidence = carried.confidence,
          .bound_mm = carried.bound_mm,
          .shape_rms_mm = carried.alignment.shape_rms_mm,
          .bridged_mm = carried.carried.bridged_mm};
}

}  // namespace biteline::sdk
