// SPDX-License-Identifier: MIT
// A cell as Sparkplug's hosts see it: born, told of, dead, born again.
#include <CppUTest/TestHarness.h>

#include <limits>

#include "host/fleet/sparkplug/line.hpp"
#include "host/fleet/sparkplug/node.hpp"
#include "sparkplug/payload.pb.h"
#include "tests/support/temporary_folder.hpp"

namespace biteline::fleet::sparkplug {

TEST_GROUP(Sparkplug) {
  Node sut{"plant-1", "cell-7", "1.2.3"};
  CellState state;

  static Payload read(const std::string& bytes) {
    Payload payload;
    CHECK(payload.ParseFromString(bytes));
    return payload;
  }
  static const Metric* find(const Payload& payload, const std::string& name) {
    for (const Metric& metric : payload.metrics())
      if (metric.name() == name) return &metric;
    return nullptr;
  }
  static const Metric& metric_of(const Payload& payload, const std::string& name) {
    const Metric* metric = find(payload, name);
    CHECK_TEXT(metric != nullptr, name.c_str());
    return *metric;
  }
  static memory::Scan shoe(const char* name, double length_mm) {
    memory::Scan scan;
    scan.name = name;
    scan.time = 1'795'000'000'123;
    scan.verdict = "ok";
    scan.part = "A-17";
    scan.foot = "left";
    scan.size = "EU 42";
    scan.length_mm = length_mm;
    return scan;
  }
};

TEST(Sparkplug, TopicsAreTheStandards) {
  STRCMP_EQUAL("spBv1.0/plant-1/NBIRTH/cell-7", sut.topic("NBIRTH").c_str());
}

TEST(Sparkplug, BirthAndDeathOfALineHaveOneNumberAndTheNextLineTheNext) {
  for (int line = 0; line < 258; ++line) {
    sut.begin_line();
    const Payload death = read(sut.death()), birth = read(sut.birth(state, 5));
    CHECK(!death.has_seq());
    LONGS_EQUAL(line % 256, metric_of(death, "bdSeq").long_value());
    LONGS_EQUAL(line % 256, metric_of(birth, "bdSeq").long_value());
    LONGS_EQUAL(0, birth.seq());
  }
}

TEST(Sparkplug, NumbersGoOnAfterAProgramThatWasKilled) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "sparkplug.count";
  LONGS_EQUAL(255, Line::last_line(file));
  for (const auto& [text, expected] :
       {std::pair{"7\n", 7}, std::pair{"0\n", 0}, std::pair{"255\n", 255}, std::pair{"", 255},
        std::pair{"x", 255}, std::pair{"300\n", 255}, std::pair{"-1\n", 255}}) {
    folder.write("sparkplug.count", text);
    LONGS_EQUAL_TEXT(expected, Line::last_line(file), text);
  }
  Node later{"plant-1", "cell-7", "1.2.3", 7};
  later.begin_line();
  LONGS_EQUAL(8, metric_of(read(later.death()), "bdSeq").long_value());
  LONGS_EQUAL(8, metric_of(read(later.birth(state, 5)), "bdSeq").long_value());
}

TEST(Sparkplug, BirthNamesEveryMetricWithItsTypeAndWhatIsNotKnownAsNull) {
  sut.begin_line();
  const Payload birth = read(sut.birth(state, 1000));
  LONGS_EQUAL(1000, birth.timestamp());
  for (const Metric& metric : birth.metrics()) CHECK(metric.datatype() != 0);
  CHECK(metric_of(birth, "Last shoe/Length mm").is_null());
  LONGS_EQUAL(10, metric_of(birth, "Last shoe/Length mm").datatype());
  CHECK(!metric_of(birth, "Node Control/Rebirth").boolean_value());
  STRCMP_EQUAL("1.2.3", metric_of(birth, "Cell/Version").string_value().c_str());
}

TEST(Sparkplug, DataTellsWhatChangedAndNothingElse) {
  sut.begin_line();
  CHECK(!sut.birth(state, 1).empty());
  CHECK(!sut.data(state, 2).has_value());
  state.last = shoe("scan-0001", 801.25);
  const Payload first = read(*sut.data(state, 3));
  LONGS_EQUAL(1, first.seq());
  DOUBLES_EQUAL(801.25, metric_of(first, "Last shoe/Length mm").double_value(), 0);
  STRCMP_EQUAL("A-17", metric_of(first, "Last shoe/Part").string_value().c_str());
  STRCMP_EQUAL("left", metric_of(first, "Last shoe/Foot").string_value().c_str());
  STRCMP_EQUAL("EU 42", metric_of(first, "Last shoe/Size").string_value().c_str());
  CHECK_EQUAL(1'795'000'000'123U, metric_of(first, "Last shoe/Time").long_value());
  LONGS_EQUAL(13, metric_of(first, "Last shoe/Time").datatype());
  CHECK(find(first, "Cell/Version") == nullptr);
  state.last = shoe("scan-0002", 801.25);
  const Payload second = read(*sut.data(state, 4));
  LONGS_EQUAL(1, second.metrics_size());
  STRCMP_EQUAL("scan-0002", metric_of(second, "Last shoe/Scan").string_value().c_str());
}

TEST(Sparkplug, CountOfPayloadsGoesRoundAt255AndBeginsAgainWithABirth) {
  sut.begin_line();
  CHECK(!sut.birth(state, 1).empty());
  for (int i = 1; i <= 300; ++i) {
    state.waiting = i;
    LONGS_EQUAL(i % 256, read(*sut.data(state, 2)).seq());
  }
  LONGS_EQUAL(0, read(sut.birth(state, 3)).seq());
}

TEST(Sparkplug, OnlyARebirthIsTakenFromACommand) {
  Payload command;
  Metric& metric = *command.add_metrics();
  metric.set_name("Node Control/Rebirth");
  metric.set_boolean_value(true);
  CHECK(Node::asks_rebirth(command.SerializeAsString()));
  metric.set_boolean_value(false);
  CHECK(!Node::asks_rebirth(command.SerializeAsString()));
  metric.set_name("Node Control/Reboot");
  metric.set_boolean_value(true);
  CHECK(!Node::asks_rebirth(command.SerializeAsString()));
  CHECK(!Node::asks_rebirth("\xff\xff no payload"));
  CHECK(!Node::asks_rebirth(""));
}

TEST(Sparkplug, NumberThatIsNoneIsNull) {
  sut.begin_line();
  state.last = shoe("scan-0001", std::numeric_limits<double>::quiet_NaN());
  CHECK(metric_of(read(sut.birth(state, 1)), "Last shoe/Length mm").is_null());
}

}  // namespace biteline::fleet::sparkplug
