// SPDX-License-Identifier: MIT
#include "common/options/command.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::options {
namespace {

enum class Unit { Millimetre, Inch };

/// A program with two commands, as biteline has many.
struct Program {
  Command app{"Measures.", "measure"};
  bool quiet{false};
  std::optional<Unit> unit;
  std::filesystem::path cloud;
  std::vector<std::string> rest;
  bool chosen{false};

  Program() {
    app.require_subcommand(1);
    app.fallthrough();
    app.add_flag("--quiet", quiet, "No words");
    Command* line = app.add_subcommand("line", "Finds it");
    line->add_option("cloud", cloud, "The cloud")->required();
    line->add_choice("--unit", unit,
                     std::map<std::string, Unit>{{"mm", Unit::Millimetre}, {"in", Unit::Inch}},
                     "Of the cloud");
    line->callback([this] {
      if (cloud == "unfit") throw Unfit{"the cloud does not fit"};
      chosen = true;
    });
    Command* other = app.add_subcommand("other", "Another program");
    other->take_the_rest();
    other->callback([this, other] { rest = other->remaining(); });
  }
  std::string fault(std::vector<std::string> words) {
    const std::optional<Leave> leave = app.parse(std::move(words));
    return leave ? leave->fault : "none";
  }
};

}  // namespace

TEST_GROUP(Command){};

TEST(Command, ValuesArriveInTheirTypes) {
  Program program;
  STRCMP_EQUAL("none", program.fault({"line", "cloud.ply", "--unit", "in", "--quiet"}).c_str());
  CHECK(program.chosen && program.quiet && program.unit == Unit::Inch && program.cloud == "cloud.ply");
}

TEST(Command, AFaultIsOneSentence) {
  STRCMP_EQUAL("A subcommand is required", Program{}.fault({}).c_str());
  STRCMP_EQUAL("cloud is required", Program{}.fault({"line"}).c_str());
  STRCMP_CONTAINS("--unit", Program{}.fault({"line", "cloud.ply", "--unit", "ell"}).c_str());
  STRCMP_EQUAL("the cloud does not fit", Program{}.fault({"line", "unfit"}).c_str());
}

TEST(Command, TheRestIsForAnotherProgram) {
  Program program;
  STRCMP_EQUAL("none", program.fault({"other", "--help", "--quiet"}).c_str());
  CHECK((program.rest == std::vector<std::string>{"--help", "--quiet"}));
  CHECK(!program.quiet);
}

TEST(Command, NamesAreTold) {
  const Program program;
  STRCMP_EQUAL("line", program.app.commands().front().name().c_str());
  CHECK((program.app.commands().front().long_names() == std::vector<std::string>{"help", "unit"}));
}

TEST(Command, OptionsThatExcludeEachOtherAreRefused) {
  Command app{"", "test"};
  bool one = false, other = false;
  const Option* first = app.add_flag("--one", one, "");
  app.add_flag("--other", other, "")->excludes(app.get_option("--one"));
  CHECK(app.parse({"--one", "--other"}).has_value());
  LONGS_EQUAL(1, first->count());
  CHECK(!app.parse({"--other"}).has_value());
}

}  // namespace biteline::options
