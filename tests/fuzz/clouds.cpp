// SPDX-License-Identifier: MIT
// Text clouds, PCD, STL, OBJ and PLY of anybody: corners are vertices, arrays are as long as the places, and
// what stands for nothing is never more than there is.
#include "common/core/numbers.hpp"
#include "host/cloud/mesh_file.hpp"
#include "host/cloud/nothing_values.hpp"
#include "host/cloud/pcd.hpp"
#include "host/cloud/ply_file.hpp"
#include "host/cloud/text_cloud.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

namespace {

Result<cloud::FileContent> read(std::uint8_t kind, const std::string& bytes) {
  switch (kind % 5) {
    case 0:
      return cloud::read_text_cloud(bytes, "case");
    case 1:
      return cloud::read_pcd(bytes, "case");
    case 2:
      return cloud::read_stl(bytes, "case");
    case 3:
      return cloud::read_obj(bytes, "case");
    default:
      return cloud::read_ply(bytes, "case");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // The kind stands in front as a digit.
  auto content = read(data[0], std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
  if (!content) {
    fuzz::demand_clean(content.error());
    return 0;
  }
  const std::size_t count = content->places.size();
  for (const auto& face : content->faces) {
    for (const std::uint32_t corner : face) fuzz::demand(corner < count, "corners are vertices");
  }
  fuzz::demand(content->beside.normals.empty() || content->beside.normals.size() == count,
               "a normal a place");
  std::vector<std::uint8_t> keep(count);
  for (std::size_t i = 0; i < count; ++i) keep[i] = content->places[i].allFinite() ? 1 : 0;
  std::size_t left_out = 0;
  for (const cloud::NothingValue& nothing : cloud::leave_out_nothing(content->places, keep))
    left_out += nothing.points;
  fuzz::demand(left_out <= count, "no more is left out than there is");
  return 0;
}
