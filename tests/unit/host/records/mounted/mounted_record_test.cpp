// SPDX-License-Identifier: MIT
#include "host/records/mounted/mounted_record.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <limits>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::mounted {

using Lesson = kinematics::TouchLesson;

TEST_GROUP(MountedRecord) {
  test::TemporaryFolder folder;
  Result<memory::Memory> memory{memory::Memory::open(folder.path() / memory::k_memory_file)};
  const Hand hand{.who = "eng", .door = "web"};
  const kinematics::Touched tip{.tip_flange = {1, 2, 180}, .z_mm = 0, .residual_mm = 0.1, .u95_mm = 0.2};
  const kinematics::Touched table{
      .tip_flange = Vec3::Zero(), .z_mm = -12.5, .residual_mm = 0.3, .u95_mm = 0.5};

  void put(const char* text) {
    SUCCEEDS(memory->put_setting(
        "mounted", text,
        {.id = 0, .who = "x", .door = {}, .action = "x", .subject = {}, .before = {}, .after = {}}));
  }
};

TEST(MountedRecord, AtFirstNothingIsTaught) {
  const auto record = read_record(*memory);
  SUCCEEDS(record);
  LONGS_EQUAL(0, record->version);
  CHECK(!record->mounted({}).tip_flange && !record->mounted({}).payload && !record->mounted({}).table_z_mm);
}

TEST(MountedRecord, EachChangeIsAVersionWithWhoAndWhenAndARowOfTheLog) {
  SUCCEEDS(keep_touched(*memory, Lesson::Part::Tip, tip, 6, hand));
  SUCCEEDS(keep_payload(*memory, {.mass_kg = 1.6, .centre_flange_mm = {0, 0, 65}}, hand));
  SUCCEEDS(keep_touched(*memory, Lesson::Part::Table, table, 3, {.who = "ada", .door = "command line"}));
  const auto record = read_record(*memory);
  SUCCEEDS(record);
  LONGS_EQUAL(3, record->version);
  LONGS_EQUAL(1, record->tip->how.version);
  LONGS_EQUAL(6, record->tip->how.touches);
  DOUBLES_EQUAL(0.2, record->tip->how.u95_mm, 1e-12);
  STRCMP_EQUAL("eng", record->tip->how.who.c_str());
  CHECK(record->tip->how.time > 0);
  LONGS_EQUAL(2, record->payload->how.version);
  DOUBLES_EQUAL(1.6, record->payload->payload.mass_kg, 1e-12);
  LONGS_EQUAL(3, record->table->how.version);
  STRCMP_EQUAL("ada", record->table->how.who.c_str());
  DOUBLES_EQUAL(-12.5, *record->mounted({}).table_z_mm, 1e-12);
  const auto rows = memory->log_rows(0, 10);
  SUCCEEDS(rows);
  LONGS_EQUAL(3, rows->size());
  STRCMP_EQUAL("table", rows->front().subject.c_str());
  STRCMP_EQUAL("null", rows->front().before.c_str());
  STRCMP_CONTAINS("-12.5", rows->front().after.c_str());
}

TEST(MountedRecord, WhatIsForgottenIsCheckedNoMoreAndTheLogKeepsIt) {
  SUCCEEDS(keep_touched(*memory, Lesson::Part::Tip, tip, 6, hand));
  SUCCEEDS(forget(*memory, Part::Tip, hand));
  const auto record = read_record(*memory);
  SUCCEEDS(record);
  LONGS_EQUAL(2, record->version);
  CHECK(!record->mounted({}).tip_flange);
  const auto rows = memory->log_rows(0, 1);
  SUCCEEDS(rows);
  STRCMP_CONTAINS("180", rows->front().before.c_str());
  STRCMP_EQUAL("null", rows->front().after.c_str());
}

TEST(MountedRecord, EachToolHasItsOwnTipAndPayload) {
  SUCCEEDS(keep_touched(*memory, Lesson::Part::Tip, tip, 6, hand));
  SUCCEEDS(keep_payload(*memory, {.mass_kg = 1.6, .centre_flange_mm = {0, 0, 65}}, hand));
  // What was taught before tools had names is the first one's.
  SUCCEEDS(mount_tool(*memory, "brush", hand));
  SUCCEEDS(keep_touched(*memory, Lesson::Part::Table, table, 3, hand));
  const auto gun = mount_tool(*memory, "gun", hand);
  SUCCEEDS(gun);
  STRCMP_EQUAL("gun", gun->mounted({}).tool->c_str());
  CHECK(!gun->mounted({}).tip_flange && !gun->mounted({}).payload);
  DOUBLES_EQUAL(-12.5, *gun->mounted({}).table_z_mm, 1e-12);
  // A path of the brush is planned with the brush's, and the gun is mounted all the same.
  const auto read = read_record(*memory);
  SUCCEEDS(read);
  const path::Mounted brush = read->mounted("brush");
  STRCMP_EQUAL("gun", brush.tool->c_str());
  DOUBLES_EQUAL(180, brush.tip_flange->z(), 1e-12);
  DOUBLES_EQUAL(0.2, brush.tip_u95_mm, 1e-12);
  DOUBLES_EQUAL(1.6, brush.payload->mass_kg, 1e-12);
  CHECK(!read->mounted("roller").tip_flange);
  const auto back = mount_tool(*memory, "brush", hand);
  SUCCEEDS(back);
  DOUBLES_EQUAL(180, back->tip->tip_flange.z(), 1e-12);
  LONGS_EQUAL(1, back->shelf.size());
  const auto none = forget(*memory, Part::Tool, hand);
  SUCCEEDS(none);
  CHECK(!none->tool && !none->tip && none->shelf.contains("brush"));
  for (const char* bad : {"", "../brush", ".brush", "a b"})
    CHECK_TEXT(mount_tool(*memory, bad, hand).error().code == Errc::BadValue, bad);
}

TEST(MountedRecord, AChangerBringsWhatItHoldsInPlaceOfWhatItHolds) {
  const auto place = [](int ask_output, int there_input) {
    return path::ToolLines{.on_output = 1, .changer = path::ChangerLines{ask_output, there_input}};
  };
  CHECK(keep_lines(*memory, place(4, 2), hand).error().code == Errc::WrongState);
  SUCCEEDS(mount_tool(*memory, "brush", hand));
  SUCCEEDS(keep_touched(*memory, Lesson::Part::Tip, tip, 6, hand));
  SUCCEEDS(keep_lines(*memory, place(4, 2), hand));
  SUCCEEDS(mount_tool(*memory, "hand-held", hand));
  // What a person has mounted a changer does not take away.
  CHECK(!read_record(*memory)->mounted("brush").changer);
  SUCCEEDS(mount_tool(*memory, "gun", hand));
  for (const path::ToolLines& bad : {place(4, 3), place(5, 2), place(8, 3), place(5, -1), place(1, 3),
                                     path::ToolLines{.on_output = 4}, path::ToolLines{.on_output = 9}})
    CHECK(keep_lines(*memory, bad, hand).error().code == Errc::BadValue);
  SUCCEEDS(keep_lines(*memory, place(5, 3), hand));
  const auto record = read_record(*memory);
  SUCCEEDS(record);
  const path::Mounted brush = record->mounted("brush");
  CHECK(brush.changer.has_value());
  LONGS_EQUAL(4, brush.changer->wanted.ask_output);
  LONGS_EQUAL(2, brush.changer->wanted.there_input);
  LONGS_EQUAL(1, brush.changer->others.size());
  LONGS_EQUAL(5, brush.changer->others.front().ask_output);
  DOUBLES_EQUAL(tip.tip_flange.norm(), brush.changer->reach_mm, 1e-12);
  LONGS_EQUAL(1, brush.lines->on_output.value_or(-1));
  CHECK(!record->mounted("hand-held").changer && !record->mounted("").changer);
  SUCCEEDS(forget(*memory, Part::Lines, hand));
  CHECK(!read_record(*memory)->mounted("brush").changer);
  SUCCEEDS(forget(*memory, Part::Tool, hand));
  CHECK(!read_record(*memory)->mounted("brush").changer);
}

/// Whose tip it is nobody knows: it is not given up for the one on the shelf without a word.
TEST(MountedRecord, WhatWasTaughtWithoutANameIsNotLostToAShelvedTool) {
  SUCCEEDS(mount_tool(*memory, "brush", hand));
  SUCCEEDS(keep_touched(*memory, Lesson::Part::Tip, tip, 6, hand));
  SUCCEEDS(forget(*memory, Part::Tool, hand));
  SUCCEEDS(mount_tool(*memory, "brush", hand));
  SUCCEEDS(forget(*memory, Part::Tool, hand));
  SUCCEEDS(keep_touched(*memory, Lesson::Part::Tip, {.tip_flange = {0, 0, 150}}, 6, hand));
  FAILS_NAMING(Errc::WrongState, "no tool was named", mount_tool(*memory, "brush", hand));
  DOUBLES_EQUAL(150, read_record(*memory)->tip->tip_flange.z(), 1e-12);
  SUCCEEDS(mount_tool(*memory, "gun", hand));
  DOUBLES_EQUAL(180, mount_tool(*memory, "brush", hand)->tip->tip_flange.z(), 1e-12);
}

TEST(MountedRecord, ARenewedDiscGoesWithItsTool) {
  CHECK(renew_tool(*memory, hand).error().code == Errc::WrongState);
  SUCCEEDS(mount_tool(*memory, "disc", hand));
  SUCCEEDS(renew_tool(*memory, hand));
  SUCCEEDS(mount_tool(*memory, "gun", hand));
  const auto record = read_record(*memory);
  SUCCEEDS(record);
  CHECK(!record->renewed && record->shelf.at("disc").renewed && record->shelf.at("disc").renewed->time > 0);
  CHECK(mount_tool(*memory, "disc", hand)->renewed.has_value());
}

TEST(MountedRecord, ToolsThatCannotBeReadAreNone) {
  for (const char* bad :
       {R"({"version":1,"tip":null,"payload":null,"table":null,"lines":{"on_output":8}})",
        R"({"version":1,"tip":null,"payload":null,"table":null,"lines":4})",
        R"({"version":1,"tip":null,"payload":null,"table":null,"renewed":4})",
        R"({"version":1,"tip":null,"payload":null,"table":null,"tool":"brush"})",
        R"({"version":1,"tip":null,"payload":null,"table":null,"tool":{"name":3}})",
        R"({"version":1,"tip":null,"payload":null,"table":null,"shelf":{"brush":{"tip":{}}}})"}) {
    put(bad);
    CHECK_TEXT(read_record(*memory).error().code == Errc::BadFormat, bad);
  }
  put(R"({"version":1,"tip":null,"payload":null,"table":null})");
  SUCCEEDS(read_record(*memory));
}

TEST(MountedRecord, APayloadBeyondItsRangeIsRefused) {
  for (const path::Payload& payload : {path::Payload{.mass_kg = 21}, path::Payload{.mass_kg = -0.1},
                                       path::Payload{.mass_kg = std::numeric_limits<double>::quiet_NaN()},
                                       path::Payload{.mass_kg = 1, .centre_flange_mm = {0, 0, 1001}}}) {
    CHECK(keep_payload(*memory, payload, hand).error().code == Errc::BadValue);
  }
  std::feclearexcept(FE_INVALID);  // of comparing with what is no number
  LONGS_EQUAL(0, read_record(*memory)->version);
}

TEST(MountedRecord, WhatNobodyWroteSoIsAnErrorAndNotNothing) {
  for (
      const char* text :
      {"", "[]", "{}", R"({"version":1,"tip":{"at_mm":[1,2]},"payload":null,"table":null})",
       R"({"version":1,"tip":[1,2,3],"payload":null,"table":null})",
       R"({"version":1,"tip":null,"payload":null,"table":-12.5})",
       R"({"version":1,"tip":{"at_mm":[1,2,"3"],"version":1,"who":"a","time":"2026-11-20"},"payload":null,"table":null})",
       R"({"version":1,"tip":{"at_mm":[1,2,3000],"version":1,"who":"a","time":"2026-11-20"},"payload":null,"table":null})",
       R"({"version":1,"tip":{"at_mm":[1,2,3],"version":1,"who":"a","time":"yesterday"},"payload":null,"table":null})"}) {
    put(text);
    CHECK_TEXT(read_record(*memory).error().code == Errc::BadFormat, text);
  }
  // Forgetting makes it whole again.
  SUCCEEDS(forget(*memory, Part::Tip, hand));
  SUCCEEDS(read_record(*memory));
}

}  // namespace biteline::mounted
