// SPDX-License-Identifier: MIT
// biteline mounted: tip, payload and table of a cell, shown and taught.
#include <iostream>

#include "common/core/fixed_text.hpp"
#include "common/options/command.hpp"
#include "common/system/user_name.hpp"
#include "common/wire/endpoint.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/records/force_book/tool_wear.hpp"
#include "host/records/mounted/mounted_record.hpp"
#include "host/report/file_lock.hpp"
#include "host/robot/link/ur/arm_look.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using Lesson = kinematics::TouchLesson;

struct MountedOptions {
  fs::path results, touches;
  std::string teach, forget, mount, arm, who;
  std::vector<double> payload;  // kg, then the centre in the flange [mm]
  bool renew{false};
  std::optional<int> on_output;
  std::vector<double> changer;  // the output that asks, the input that tells
};

std::string words_of(const kinematics::Touched& touched, Lesson::Part part) {
  using Text = FixedText<200>;
  if (part == Lesson::Part::Table)
    return Text::format("the table stands at %.2f mm in the robot's base; residual %.2f mm, U95 %.2f mm",
                        touched.z_mm, touched.residual_mm, touched.u95_mm)
        .c_str();
  return Text::format("the tip stands at (%.2f, %.2f, %.2f) mm in the flange; residual %.2f mm, U95 %.2f mm",
                      touched.tip_flange.x(), touched.tip_flange.y(), touched.tip_flange.z(),
                      touched.residual_mm, touched.u95_mm)
      .c_str();
}

/// One line of a person for each touch, until "save".  What went wrong with a touch is told, and costs only
/// that touch.
Result<void> touch_by_hand(Lesson& lesson, const std::string& arm) {
  BITELINE_ASSIGN(const wire::Endpoint at, wire::parse_endpoint("tcp://" + arm));
  std::fputs("Enter: touch; back: take the last touch back; save: keep it; Ctrl-D: leave\n", stderr);
  for (std::string line; std::getline(std::cin, line);) {
    if (line == "save") return {};
    Result<void> done{};
    if (line == "back") {
      lesson.take_back();
    } else {
      const Result<robot::ur::ArmLook> look = robot::ur::look_at_arm(at.host, at.port);
      done = look ? lesson.add(look->T_base_flange) : Result<void>{tl::unexpected<Error>{look.error()}};
    }
    const Result<kinematics::Touched> outcome = lesson.outcome();
    std::fprintf(stderr, "%s\n",
                 !done ? to_line(done.error()).c_str()
                       : (std::to_string(lesson.touches()) + " touches: " +
                          (outcome ? words_of(*outcome, lesson.part()) : to_line(outcome.error())))
                             .c_str());
  }
  return fail(Errc::InvalidArgument, "nothing was kept: the input ended before 'save'");
}

Result<mounted::Record> teach(memory::Memory& memory, const MountedOptions& options,
                              const mounted::Hand& hand, report::Report& report) {
  BITELINE_ASSIGN(const mounted::Record before, mounted::read_record(memory));
  const Lesson::Part part = options.teach == "tip" ? Lesson::Part::Tip : Lesson::Part::Table;
  if (part == Lesson::Part::Table && !before.tip)
    return fail(Errc::WrongState, "teach the tip first: it is what touches the table");
  Lesson lesson;
  lesson.begin(part, before.tip ? before.tip->tip_flange : Vec3{Vec3::Zero()});
  if (!options.touches.empty()) {
    BITELINE_ASSIGN(const std::vector<SE3> touches, kinematics::read_touches(options.touches));
    for (const SE3& T_base_flange : touches) BITELINE_TRY(lesson.add(T_base_flange));
  } else {
    BITELINE_TRY(touch_by_hand(lesson, options.arm));
  }
  BITELINE_ASSIGN(const kinematics::Touched touched, lesson.outcome());
  report.fields["residual_mm"] = touched.residual_mm;
  report.fields["u95_mm"] = touched.u95_mm;
  return mounted::keep_touched(memory, part, touched, lesson.touches(), hand);
}

std::string words_of(const mounted::Taught& how) {
  std::string words =
      ", version " + std::to_string(how.version) + ", " + how.who + ", " + memory::to_iso(how.time);
  if (how.touches > 0)
    words += FixedText<120>::format(", %d touches, residual %.2f mm, U95 %.2f mm", how.touches,
                                    how.residual_mm, how.u95_mm)
                 .c_str();
  return words;
}

std::string words_of(const mounted::Lines& lines) {
  std::string words;
  if (lines.lines.on_output) words = "output " + std::to_string(*lines.lines.on_output) + " switches it on";
  if (lines.lines.changer)
    words += (words.empty() ? "" : "; ") + std::string{"output "} +
             std::to_string(lines.lines.changer->ask_output) + " asks the changer for it, input " +
             std::to_string(lines.lines.changer->there_input) + " tells that it stands";
  return words + words_of(lines.how);
}

std::string words_of(const mounted::Record& record) {
  using Text = FixedText<200>;
  std::string words = "tool     ";
  words += record.tool ? record.tool->name + words_of(record.tool->how) : "nobody has said which is mounted";
  if (!record.shelf.empty()) words += "\nshelf    ";
  for (const auto& [name, taught] : record.shelf)
    words += (name == record.shelf.begin()->first ? "" : ", ") + name;
  words += "\ntip      ";
  if (record.tip) {
    const Vec3& tip = record.tip->tip_flange;
    words +=
        Text::format("(%.2f, %.2f, %.2f) mm", tip.x(), tip.y(), tip.z()).c_str() + words_of(record.tip->how);
  } else {
    words += "not taught";
  }
  words += "\npayload  ";
  if (record.payload) {
    const Vec3& centre = record.payload->payload.centre_flange_mm;
    words += Text::format("%.2f kg at (%.0f, %.0f, %.0f) mm", record.payload->payload.mass_kg, centre.x(),
                          centre.y(), centre.z())
                 .c_str() +
             words_of(record.payload->how);
  } else {
    words += "not taught";
  }
  words += "\nlines    ";
  words += record.lines ? words_of(*record.lines) : "not taught";
  words += "\ntable    ";
  words += record.table ? Text::format("%.2f mm", record.table->z_mm).c_str() + words_of(record.table->how)
                        : std::string{"not taught"};
  return words;
}

/// Of the tools that have pressed a shoe.
Result<std::string> tell_wear(const mounted::Record& record, const memory::Memory& memory,
                              report::Report& report) {
  BITELINE_ASSIGN(const std::vector<force_book::Entry> pressed, force_book::read_all(memory));
  std::string words;
  const auto add = [&](const std::string& tool, const std::optional<mounted::Taught>& renewed) {
    const force_book::ToolWear wear = force_book::wear_of_tool(pressed, tool, renewed ? renewed->time : 0);
    if (wear.shoes == 0) return;
    report.fields["wear"][tool] = force_book::to_json(wear);
    words += "\nwear     " + tool + ": " + force_book::words_of(wear) +
             (renewed ? ", since " + memory::to_iso(renewed->time) : "");
  };
  if (record.tool) add(record.tool->name, record.renewed);
  for (const auto& [name, taught] : record.shelf) add(name, taught.renewed);
  return words;
}

Result<ExitStatus> show(const mounted::Record& record, const memory::Memory& memory, report::Report& report,
                        const GlobalOptions& global) {
  report.fields["mounted"] = mounted::to_json(record);
  BITELINE_ASSIGN(const std::string wear, tell_wear(record, memory, report));
  // What is mounted is the result: --quiet leaves it.
  return tell(report, {.quiet = false, .json = global.json}, words_of(record) + wear);
}

/// What is not told of them stays as it was.
Result<mounted::Record> keep_lines(memory::Memory& memory, const MountedOptions& options,
                                   const mounted::Hand& hand) {
  BITELINE_ASSIGN(const mounted::Record record, mounted::read_record(memory));
  path::ToolLines lines = record.lines ? record.lines->lines : path::ToolLines{};
  if (options.on_output) lines.on_output = options.on_output;
  if (!options.changer.empty())
    lines.changer = path::ChangerLines{.ask_output = static_cast<int>(options.changer[0]),
                                       .there_input = static_cast<int>(options.changer[1])};
  return mounted::keep_lines(memory, lines, hand);
}

Result<ExitStatus> run_mounted(const MountedOptions& options, const GlobalOptions& global) {
  report::Report report;
  const fs::path file = options.results / memory::k_memory_file;
  const bool of_lines = options.on_output || !options.changer.empty();
  if (options.teach.empty() && options.forget.empty() && options.mount.empty() && options.payload.empty() &&
      !of_lines && !options.renew) {
    BITELINE_ASSIGN(const memory::Memory memory, memory::Memory::open_to_read(file));
    BITELINE_ASSIGN(const mounted::Record record, mounted::read_record(memory));
    return show(record, memory, report, global);
  }
  if (!options.teach.empty() && options.touches.empty() == options.arm.empty())
    return fail(Errc::InvalidArgument, "--teach needs --touches or --arm, one of them");
  Result<report::FileLock> lock =
      report::FileLock::take(options.results / "biteline-host.lock", "biteline mounted");
  if (!lock)
    return fail(lock.error().code, "%.200s; while a service runs, teach on its page",
                to_line(lock.error()).c_str());
  BITELINE_ASSIGN(memory::Memory memory, memory::Memory::open(file));
  const mounted::Hand hand{.who = options.who.empty() ? user_name() : options.who, .door = "command line"};
  if (!options.forget.empty()) {
    BITELINE_ASSIGN(const mounted::Record record,
                    mounted::forget(memory, *mounted::part_of(options.forget), hand));
    return show(record, memory, report, global);
  }
  if (!options.mount.empty()) {
    BITELINE_ASSIGN(const mounted::Record record, mounted::mount_tool(memory, options.mount, hand));
    return show(record, memory, report, global);
  }
  if (!options.payload.empty()) {
    const path::Payload payload{
        .mass_kg = options.payload[0],
        .centre_flange_mm = {options.payload[1], options.payload[2], options.payload[3]}};
    BITELINE_ASSIGN(const mounted::Record record, mounted::keep_payload(memory, payload, hand));
    return show(record, memory, report, global);
  }
  if (options.renew) {
    BITELINE_ASSIGN(const mounted::Record record, mounted::renew_tool(memory, hand));
    return show(record, memory, report, global);
  }
  if (of_lines) {
    BITELINE_ASSIGN(const mounted::Record record, keep_lines(memory, options, hand));
    return show(record, memory, report, global);
  }
  BITELINE_ASSIGN(const mounted::Record record, teach(memory, options, hand, report));
  return show(record, memory, report, global);
}

}  // namespace

void add_mounted(options::Command& app, Context& context) {
  auto options = std::make_shared<MountedOptions>();
  options::Command* command = app.add_subcommand(
      "mounted", "What is mounted at a cell: the tool, its tip and payload, and the table, shown and taught");
  command->add_option("results", options->results, "The service's --out folder")->required();
  auto* teach = command
                    ->add_option("--teach", options->teach,
                                 "Teach the tip (touch one point from several sides), or the table's height "
                                 "(touch it at three places or more)")
                    ->check(options::one_of({"tip", "table"}));
  command
      ->add_option("--touches", options->touches,
                   "With --teach: poses of the flange (number, mm, quaternion), a row for each touch")
      ->needs(teach);
  command
      ->add_option("--arm", options->arm,
                   "With --teach: the controller's real-time port, HOST:PORT; one Enter for each touch")
      ->needs(teach);
  auto* payload = command
                      ->add_option("--payload", options->payload,
                                   "What the flange carries: its mass [kg], and its centre in the flange x y "
                                   "z [mm]")
                      ->check(options::number({.minimum = -1000, .maximum = 1000}, "kg, mm"))
                      ->expected(4)
                      ->excludes(teach);
  auto* mount = command
                    ->add_option("--mount", options->mount,
                                 "This tool is mounted now: tip, payload and lines are what was taught of it")
                    ->excludes(teach)
                    ->excludes(payload);
  const options::Check line = options::whole_number(0, 7);
  auto* renew = command
                    ->add_flag("--renew", options->renew,
                               "The mounted tool has a new disc, brush or roller: its wear counts from now")
                    ->excludes(teach)
                    ->excludes(payload)
                    ->excludes(mount);
  auto* on_output =
      command
          ->add_option("--on-output", options->on_output,
                       "The controller's digital output, 0 to 7, that switches the mounted tool "
                       "on: its processes must switch this one")
          ->check(line)
          ->excludes(teach)
          ->excludes(payload)
          ->excludes(mount);
  auto* changer = command
                      ->add_option("--changer", options->changer,
                                   "Place of the mounted tool in a changer: the digital output that asks for "
                                   "it, and the digital input that tells that it stands")
                      ->check(line)
                      ->expected(2)
                      ->excludes(teach)
                      ->excludes(payload)
                      ->excludes(mount);
  command
      ->add_option("--forget", options->forget, "Forget what was taught of this part: it is checked no more")
      ->check(options::one_of({"tip", "payload", "table", "tool", "lines", "renewed"}))
      ->excludes(renew)
      ->excludes(on_output)
      ->excludes(changer)
      ->excludes(teach)
      ->excludes(mount)
      ->excludes(payload);
  command->add_option("--who", options->who, "Whose hand it is; default: this user");
  command->callback([options, &context] {
    context.run = [options, &context] { return run_mounted(*options, context.options); };
  });
}

}  // namespace biteline::app
