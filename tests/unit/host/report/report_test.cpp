// SPDX-License-Identifier: MIT
#include "host/report/report.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <sstream>

#include "host/report/page.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::report {

TEST_GROUP(Report) {
  test::TemporaryFolder folder;

  std::string content(const std::string& name) const {
    std::ifstream file(folder.path() / name);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
  nlohmann::json written(Report & report) const {
    SUCCEEDS(report.write(folder.path()));
    return test::read_json(content("report.json"));
  }
};

TEST(Report, BytesThatAreNoTextAreWrittenAllTheSame) {
  Report sut;
  sut.fields["file"] = "se\xffss";
  sut.fields["cut"] = std::string{"ab\xC3"};
  sut.refuse("no line in \xE9\x9E");
  const auto json = written(sut);
  STRCMP_EQUAL("se\xEF\xBF\xBDss", json["file"].get<std::string>().c_str());
  STRCMP_EQUAL("refused", json["status"].get<std::string>().c_str());
}

TEST(Report, StagesAndFieldsAreWritten) {
  Report sut;
  LONGS_EQUAL(7, sut.timed("read", [] { return 7; }));
  sut.timed("read", [] {});
  sut.fields["points"] = 3;
  const auto json = written(sut);
  STRCMP_EQUAL("ok", json["status"].get<std::string>().c_str());
  LONGS_EQUAL(3, json["points"].get<int>());
  LONGS_EQUAL(1, json["stages"].size());
  CHECK(json["stages"]["read"].get<double>() >= 0);
  CHECK(json["total_s"].get<double>() >= json["stages"]["read"].get<double>());
  CHECK(!json.contains("reason"));
}

TEST(Report, ThreeVerdicts) {
  const ToldRefusal why{.reason_code = "rivalled", .reason = "two creases", .next_step = "settle it"};
  Report sut;
  CHECK(sut.status() == ExitStatus::Done);
  sut.review(why);
  CHECK(sut.status() == ExitStatus::Review);
  CHECK_FALSE(sut.refused());
  const auto json = written(sut);
  STRCMP_EQUAL("review", json["status"].get<std::string>().c_str());
  STRCMP_EQUAL("rivalled", json["reason_code"].get<std::string>().c_str());
  STRCMP_EQUAL("settle it", json["next_step"].get<std::string>().c_str());
  sut.refuse(why);
  CHECK(sut.status() == ExitStatus::Refused);
  CHECK(sut.refused());
}

TEST(Report, TimeForPicturesStaysOutOfTheTotal) {
  Report sut;
  volatile double work = 0;
  sut.timed_aside("pictures", [&] {
    for (int i = 0; i < 3'000'000; ++i) work = work + 1;
  });
  const auto json = written(sut);
  CHECK(json["stages"]["pictures"].get<double>() > json["total_s"].get<double>());
}

namespace {
enum class Refused { NoShoe, TwoShoes };
std::span<const RefusalRow<Refused>> refusal_table(Refused) {
  static constexpr std::array k_rows{
      RefusalRow<Refused>{Refused::NoShoe, "no_shoe", "put a shoe on the table"},
      RefusalRow<Refused>{Refused::TwoShoes, "two_shoes", "take one shoe away"},
  };
  return k_rows;
}
}  // namespace

TEST(Report, RefusalHasItsCodeItsReasonAndTheNextStep) {
  test::check_refusal_table(Refused::TwoShoes);
  Report sut;
  CHECK_FALSE(sut.refused());
  sut.refuse(Refusal<Refused>{.code = Refused::TwoShoes, .reason = "shoes at 40 mm and at 300 mm"});
  CHECK_TRUE(sut.refused());
  const auto json = written(sut);
  STRCMP_EQUAL("refused", json["status"].get<std::string>().c_str());
  STRCMP_EQUAL("two_shoes", json["reason_code"].get<std::string>().c_str());
  STRCMP_EQUAL("shoes at 40 mm and at 300 mm", json["reason"].get<std::string>().c_str());
  STRCMP_EQUAL("take one shoe away", json["next_step"].get<std::string>().c_str());
}

TEST(Report, TextIsWhatTheFileHas) {
  Report sut;
  sut.fields["input"] = "not \xff UTF-8";
  written(sut);
  const std::string text = sut.text();
  STRCMP_EQUAL(content("report.json").c_str(), text.c_str());
  LONGS_EQUAL(k_schema_version, test::read_json(text)["schema_version"].get<int>());
}

TEST(Report, FileThatCannotBeWrittenLeavesTheOldOne) {
  folder.write("sub/report.json", "old");
  Report sut;
  FAILS_NAMING(Errc::WriteFailed, "report.json", sut.write(folder.path() / "absent"));
  STRCMP_EQUAL("old", content("sub/report.json").c_str());
}

TEST(Report, PageEscapesWhatItShows) {
  Page sut{"<script>", "a & b", Page::Mood::Good};
  sut.figures({{"\"x\"", "1 < 2"}});
  sut.table({"", "<left>"}, {{"mean", "2 > 1"}});
  SUCCEEDS(sut.write(folder.path() / "index.html"));
  const std::string html = content("index.html");
  STRCMP_CONTAINS("&lt;script&gt;", html.c_str());
  STRCMP_CONTAINS("a &amp; b", html.c_str());
  STRCMP_CONTAINS("1 &lt; 2", html.c_str());
  STRCMP_CONTAINS("<th scope=\"col\">&lt;left&gt;</th></tr>\n<tr><td>mean</td><td>2 &gt; 1</td></tr>",
                  html.c_str());
  CHECK(html.find("<script>") == std::string::npos);
}

}  // namespace biteline::report
