// SPDX-License-Identifier: MIT
#include "host/records/results/view/view_data.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <sstream>

#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::results {

TEST_GROUP(ViewData) {
  test::TemporaryFolder folder;

  std::string text(const char* name) const {
    std::ifstream stream(folder.path() / name);
    std::stringstream out;
    out << stream.rdbuf();
    return out.str();
  }
  /// The value that the script gives to a name.
  nlohmann::json script(const char* name) const {
    const std::string all = text(name);
    const std::size_t begin = all.find(" = ") + 3;
    return test::read_json(all.substr(begin, all.rfind(';') - begin));
  }
};

TEST(ViewData, LargeCloudIsThinnedAndSaysSo) {
  cloud::PointCloud cloud;
  for (int i = 0; i < 450'000; ++i) cloud.points.emplace_back(static_cast<float>(i) * 0.001F, 7, -3);
  SUCCEEDS(write_view(folder.path(), {.title = "t",
                                      .summary = "s",
                                      .found = false,
                                      .report = {},
                                      .cloud = &cloud,
                                      .line = nullptr,
                                      .T_base_shoe = std::nullopt,
                                      .path_mm = {}}));
  const auto view = script("view_data.js");
  LONGS_EQUAL(3, view["cloud"]["every"].get<int>());
  LONGS_EQUAL(450'000, view["cloud"]["of"].get<int>());
  // 150 000 points of 6 bytes.
  LONGS_EQUAL(150'000 * 6 / 3 * 4, view["cloud"]["xyz_u16"].get<std::string>().size());
  CHECK(!view.contains("line"));
}

TEST(ViewData, ScriptCannotBeEndedByAText) {
  SUCCEEDS(write_view(folder.path(), {.title = "</script><script>",
                                      .summary = "s",
                                      .found = false,
                                      .report = {},
                                      .cloud = nullptr,
                                      .line = nullptr,
                                      .T_base_shoe = std::nullopt,
                                      .path_mm = {}}));
  CHECK(text("view_data.js").find("</") == std::string::npos);
  STRCMP_EQUAL("</script><script>", script("view_data.js")["title"].get<std::string>().c_str());
}

TEST(ViewData, FileListNamesWhatIsThere) {
  std::ofstream(folder.path() / "line.csv") << "12345";
  SUCCEEDS(write_file_list(folder.path()));
  LONGS_EQUAL(1, script("files.js").size());
  std::filesystem::create_directory(folder.path() / "path");
  std::ofstream(folder.path() / "path/path.csv") << "1";
  SUCCEEDS(write_file_list(folder.path()));
  const auto files = script("files.js");
  LONGS_EQUAL(2, files.size());
  STRCMP_EQUAL("line.csv", files[0]["file"].get<std::string>().c_str());
  LONGS_EQUAL(5, files[0]["bytes"].get<int>());
}

}  // namespace biteline::results
