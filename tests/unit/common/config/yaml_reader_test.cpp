// SPDX-License-Identifier: MIT
#include "common/config/yaml_reader.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"

namespace biteline::config {

TEST_GROUP(YamlReader){
    static YamlReader reading(const std::string& text){auto reader = YamlReader::parse(text, "settings.yaml");
CHECK(reader.has_value());
return std::move(*reader);
}  // namespace biteline::config
}
;

TEST(YamlReader, TypedValuesAreRead) {
  YamlReader sut = reading("a: 1.5\nb: true\nc: word\nd: [1, 2]\ne: [[1, 2], [3, 4]]\nf: {g: 7}\n");
  DOUBLES_EQUAL(1.5, sut.number("a", {}), 0);
  CHECK(sut.boolean("b"));
  STRCMP_EQUAL("word", sut.text("c").c_str());
  DOUBLES_EQUAL(2, sut.numbers("d", 2)[1], 0);
  DOUBLES_EQUAL(3, sut.matrix("e", 2, 2)[2], 0);
  { LONGS_EQUAL(7, sut.child("f", true).integer("g", {})); }
  DOUBLES_EQUAL(9, sut.number_or("absent", 9, {}), 0);
  SUCCEEDS(sut.finish());
}

TEST(YamlReader, UnknownKeyIsAFaultWithItsLine) {
  YamlReader sut = reading("a: 1\nsurprise: 2\n");
  sut.number("a", {});
  FAILS_NAMING(Errc::UnknownKey, "settings.yaml line 2, surprise", sut.finish());
}

TEST(YamlReader, UnknownKeyOfAChildIsAFaultToo) {
  YamlReader sut = reading("f:\n  g: 7\n  h: 8\n");
  { sut.child("f", true).integer("g", {}); }
  FAILS_NAMING(Errc::UnknownKey, "f.h", sut.finish());
}

TEST(YamlReader, FaultsAreCollectedTheFirstIsTold) {
  YamlReader sut = reading("a: x\nb: 12\n");
  sut.number("a", {});
  sut.number("b", {.minimum = 0, .maximum = 10});
  sut.number("c", {});
  const auto outcome = sut.finish();
  FAILS_NAMING(Errc::BadValue, "line 1, a: a finite number from -1e+09 to 1e+09 expected", outcome);
  LONGS_EQUAL(2, outcome.error().more_faults);
}

TEST(YamlReader, NanAndWrongCountAreFaults) {
  YamlReader sut = reading("a: .nan\nb: [1, 2, 3]\n");
  sut.number("a", {});
  sut.numbers("b", 4);
  LONGS_EQUAL(1, sut.finish().error().more_faults);
}

TEST(YamlReader, NumbersThatNoIntegerHoldsAreFaults) {
  for (const char* huge : {"a: 1e111\n", "a: -1e300\n", "a: .inf\n", "a: 1e16\n"}) {
    YamlReader sut = reading(huge);
    LONGS_EQUAL(0, sut.integer("a", {.minimum = -1e300, .maximum = 1e300}));
    FAILS_NAMING(Errc::BadValue, "settings.yaml line 1, a", sut.finish());
  }
}

TEST(YamlReader, FarNumbersOfListsAreFaults) {
  YamlReader sut = reading("a: [1, 1e12]\nb: [[1e6]]\n");
  sut.numbers("a", 2);
  sut.matrix("b", 1, 1, k_plausible_mm);
  LONGS_EQUAL(1, sut.finish().error().more_faults);
}

TEST(YamlReader, KeysReachTheTerminalAsOneShortLine) {
  YamlReader sut = reading("\"\\e[31m\\n\\x9b" + std::string(400, 'k') + "\": 1\n");
  const auto outcome = sut.finish();
  FAILS_NAMING(Errc::UnknownKey, "settings.yaml line 1, ?[31m??kk", outcome);
  STRCMP_CONTAINS("not a key of this file", to_line(outcome.error()).c_str());
}

TEST(YamlReader, PipesAndDevicesAreNoSettings) {
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", YamlReader::open("/dev/zero"));
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", YamlReader::open("/"));
}

TEST(YamlReader, BrokenSyntaxNamesTheLine) {
  FAILS_NAMING(Errc::BadFormat, "settings.yaml line 3",
               YamlReader::parse("a: 1\nb: [1, 2\n", "settings.yaml"));
  FAILS_NAMING(Errc::BadFormat, "a mapping of keys expected",
               YamlReader::parse("just words", "settings.yaml"));
}

TEST(YamlReader, KeyThatStandsTwiceIsAFault) {
  YamlReader sut = reading("a: 1\na: 2\n");
  sut.number("a", {});
  FAILS_NAMING(Errc::BadFormat, "stands twice", sut.finish());
}

}  // namespace biteline::config
