// SPDX-License-Identifier: MIT
#include "hal/sim/robot/script.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::sim {

namespace {

const MoveStep& move(const Script& script, std::size_t i) {
  return std::get<MoveStep>(script.steps[i]);
}

}  // namespace

TEST_GROUP(Script){};

TEST(Script, ReadsAPathProgramInOurUnits) {
  const auto sut = parse_script(
      "def follow():\n"
      "  # a comment\n"
      "  set_tcp(p[0,0,0.1,0,0,0])\n"
      "  movej([0,-1.5,1.5,0,1.5,0], a=0.8, v=0.5)\n"
      "  movel(p[0.4,0.1,0.2,3.14,0,0], a=1.0, v=0.05, r=0)\n"
      "  set_digital_out(0, True)\n"
      "  movep(p[0.4,0.2,0.2,3.14,0,0], a=1.0, v=0.03, r=0.0005)\r\n"
      "  sleep(0.5)\n"
      "  textmsg(\"done\")\n"
      "end\n");
  CHECK(sut.has_value());
  STRCMP_EQUAL("follow", sut->name.c_str());
  LONGS_EQUAL(7, sut->steps.size());
  DOUBLES_EQUAL(100, std::get<SetTcpStep>(sut->steps[0]).T_flange_tcp.translation().z(), 1e-9);
  DOUBLES_EQUAL(-1.5, (*move(*sut, 1).q_rad)[1], 1e-12);
  DOUBLES_EQUAL(0.5, move(*sut, 1).speed, 1e-12);
  DOUBLES_EQUAL(50, move(*sut, 2).speed, 1e-9);
  DOUBLES_EQUAL(1000, move(*sut, 2).acceleration, 1e-9);
  DOUBLES_EQUAL(100, move(*sut, 2).T_base_tcp->translation().y(), 1e-9);
  CHECK(std::get<DigitalOutStep>(sut->steps[3]).active);
  CHECK(MoveStep::Kind::Process == move(*sut, 4).kind);
  DOUBLES_EQUAL(0.5, move(*sut, 4).blend_mm, 1e-9);
  DOUBLES_EQUAL(0.5, std::get<SleepStep>(sut->steps[5]).time_s, 1e-12);
}

TEST(Script, TakesArgumentsByPositionVariablesAndDefaults) {
  const auto sut =
      parse_script("goal = p[0.1,0,0,0,0,0]\nlocal v1 = 0.2\nmovel(goal, 0.7, v1)\nmovej(goal)\n");
  CHECK(sut.has_value());
  DOUBLES_EQUAL(700, move(*sut, 0).acceleration, 1e-9);
  DOUBLES_EQUAL(200, move(*sut, 0).speed, 1e-9);
  DOUBLES_EQUAL(1.05, move(*sut, 1).speed, 1e-12);
}

TEST(Script, RefusesWhatItDoesNotKnowWithTheLine) {
  struct Row {
    const char* text;
    Errc code;
    const char* place;
  };
  for (const Row& row : {Row{"def a():\n  while True:\n end\n", Errc::NotSupported, "line 2"},
                         Row{"movel(p[0,0,0,0,0])\n", Errc::BadFormat, "line 1"},
                         Row{"movel(p[0,0,0,0,0,0], v=0)\n", Errc::BadValue, "line 1"},
                         Row{"movel(p[0,0,0,nan,0,0])\n", Errc::BadFormat, "line 1"},
                         Row{"movel(where)\n", Errc::NotSupported, "where"},
                         Row{"\nmovel(p[0,0,0,0,0,0]) movel\n", Errc::BadFormat, "line 2"},
                         Row{"def a():\n  sleep(1)\n", Errc::Truncated, "end"},
                         Row{"servoj([0,0,0,0,0,0])\n", Errc::NotSupported, "servoj"},
                         Row{"movel(p[0,0,0,0,0,0], t=2)\n", Errc::NotSupported, "time"}}) {
    const auto sut = parse_script(row.text);
    CHECK_TEXT(!sut.has_value(), row.text);
    CHECK_EQUAL_TEXT(static_cast<int>(row.code), static_cast<int>(sut.error().code), row.text);
    CHECK_TEXT(sut.error().where.view().find(row.place) != std::string_view::npos, row.text);
  }
}

}  // namespace biteline::sim
