// SPDX-License-Identifier: MIT
#pragma once
/// \file The service's life: scan after scan from the sensor to the arm.

#include <pthread.h>

#include <atomic>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>

#include "common/core/result.hpp"
#include "host/apps/biteline-host/confirm.hpp"
#include "host/apps/biteline-host/next_of.hpp"
#include "host/apps/biteline-host/operator_control.hpp"
#include "host/apps/biteline-host/options.hpp"
#include "host/apps/biteline-host/recognise.hpp"
#include "host/apps/biteline-host/scan_pipeline.hpp"
#include "host/apps/biteline-host/send_step.hpp"
#include "host/apps/biteline-host/taken_process.hpp"
#include "host/apps/biteline-host/told_once.hpp"
#include "host/apps/biteline-host/work_book.hpp"
#include "host/calibration/drift/evidence.hpp"
#include "host/intake/child_process.hpp"
#include "host/intake/live_line.hpp"
#include "host/intake/scan_intake.hpp"
#include "host/records/centre_word/centre_word.hpp"
#include "host/records/force_book/force_book.hpp"
#include "host/records/look/look_result.hpp"
#include "host/records/release/shelf.hpp"
#include "host/report/ended_by.hpp"
#include "host/report/file_lock.hpp"
#include "host/report/refusal.hpp"
#include "host/robot/kinematics/arm_model.hpp"
#include "host/robot/link/ur/arm_claim.hpp"
#include "host/robot/link/ur/clamp_watch.hpp"
#include "host/robot/link/ur/pendant_watch.hpp"
#include "host/robot/path/process.hpp"
#include "host/robot/path/zones.hpp"
#include "host/second_look/rework.hpp"

namespace biteline::service {

/// Threads: the caller's owns the link and hears the sensor at least every 100 ms whatever else goes on; each
/// scan has one that works on its line (host/intake); a result is written, planned and followed on one more,
/// one scan at a time.  A scan whose working-out fails, by an exception or by the end of the process, is set
/// aside by name and the next one goes on.
class Service {
 public:
  /// Reads keys, process, arm and sample first: a fault there is told before anything moves.  Holds the
  /// folder of the results, and the arm when paths are to be sent, for as long as it lives: Errc::PeerRefused
  /// names who holds them.
  /// `stops`: counted up here and by the process's signals; they outlive it.
  [[nodiscard]] static Result<Service> create(const Options& options, robot::Stops& stops);

  /// Until `stop`; with `once` until the first scan's result.  A link or a robot that fails is one plain line
  /// and, without `once`, tried again: a scan that was cut off goes on where it stood.
  [[nodiscard]] Result<ExitStatus> run(const std::atomic<bool>& stop);

 private:
  struct Robot {
    kinematics::ArmModel arm;
    TakenProcess process;
    RobotOptions options;
  };
  /// What a look has found missing, to be worked once more.
  struct Missing {
    second_look::Rework pieces;
    second_look::PlannedBand band;  ///< all that was to be worked, as the look had it
    std::string look_sha256;        ///< of its report
  };
  /// What a scan is worked with.
  struct Chosen {
    std::string model;
    double probability{0};
    std::string sample{};        ///< of that model in the library: whose line and process it is
    std::string foot{}, size{};  ///< as recognised or ordered; empty: nobody knows
    std::string part{};          ///< part number; empty: none was told
    std::string told_twice{};    ///< that part was worked before: why a person has to look
    std::string unknown{};       ///< why no model is named, where a person is to name it
    std::string process_name;
    std::string
        process_by{};    ///< whose word the process is; empty: nobody's, the model's or the service's own
    bool taught{false};  ///< that word was about a scan that waited
    std::string taught_model{};   ///< of that scan; empty: none was known
    std::string other_process{};  ///< of the model: why a person has to look though nobody asked for it
    std::optional<TakenProcess> process{};
    std::vector<TakenProcess> following{};  ///< that the same shoe is worked with then, in this order
    std::string follows{};                  ///< the result of the process before; empty: it is the first
    std::optional<Missing> rework{};        ///< it works this alone, of what it follows
    memory::Evidence written{};             ///< what was looked at, as the service wrote it
    std::optional<memory::Places> places{};
    std::optional<release::InForce> release{};  ///< else the cell's own library and processes

    /// What it was recognised as, or named; what nobody knows of foot and size stays as it was ordered.
    void take(const Recognised& recognised);
    [[nodiscard]] bool in_sequence() const { return !following.empty() || !follows.empty(); }
  };
  /// A scan and the folder it belongs to.
  struct Scan {
    std::filesystem::path folder;
    intake::ScanIntake intake;
    std::unique_ptr<intake::LiveLine> line;  ///< none where a sample's line is carried over
    bool recovered{false};                   ///< of a process that ended: nobody knows how old it is
    std::optional<robot::Word> confirmed{};  ///< a person's at the start, for this one
    std::string stopped_by{};                ///< who ended it on its way
    int connection{0};                       ///< that it began on
    bool one_connection{false};              ///< it ended on the same
    std::optional<HostClock::time_point> ended{};
    Chosen chosen{};
    robot::StopMark mark{};  ///< of the start that it comes of
    bool drifted{false};     ///< the calibration has, as this scan and those before it show
    /// What this scan shows of it, looked at meanwhile; none: not yet, or no more.
    std::future<Result<drift::Evidence>> calibration{};
    bool calibration_checked{false};
    std::future<ArmSeen> arm_seen{};  ///< after the scan, asked meanwhile
    bool look{false};                 ///< at what is held, and no shoe of its own
    bool after_work{false};           ///< at what was done, and no shoe of its own either
    std::string trouble{};            ///< why no more of it came in when it had so many profiles
    std::optional<std::uint64_t> profiles_at_trouble{}, went_on_at{};
  };
  /// No scan is asked for at once: the machine spoilt the last one, or the sensor did not begin it.
  struct Rest {
    HostClock::time_point until{};
    std::string words;      ///< what is wrong
    std::string next_step;  ///< what helps
  };
  /// Who ended the scan whose row was written last.
  struct LastEnd {
    report::EndedBy who{report::EndedBy::Nobody};
    report::ToldRefusal told{};
  };
  /// With a checked path, or with none yet (`plan.outcome.path`).
  struct Planned {
    PlanStep plan;
    SendRequest request;
  };
  /// A person is to name its model.
  struct Unnamed {
    intake::ScanOutcome outcome;
    LineStep line;
  };
  /// A scan that waits for a person.
  struct HeldScan {
    Scan scan;
    std::variant<Planned, Unnamed> what;

    std::string look_words{};  ///< what came of the last look at it; empty: none was taken

    [[nodiscard]] std::string name() const { return scan.folder.filename().string(); }
    [[nodiscard]] Planned* planned() { return std::get_if<Planned>(&what); }
    [[nodiscard]] const Planned* planned() const { return std::get_if<Planned>(&what); }
    [[nodiscard]] Unnamed* unnamed() { return std::get_if<Unnamed>(&what); }
  };
  /// A shoe that was worked, and is to be looked at.
  struct AfterWork {
    Scan scan;
    Planned planned;                 ///< what was followed first
    int looks{0};                    ///< that were worked out
    std::optional<Looked> looked{};  ///< whether it has moved, by the last one

    [[nodiscard]] std::string name() const { return scan.folder.filename().string(); }
  };
  /// What the result's thread leaves.
  struct Worked {
    Result<ExitStatus> status;
    std::optional<HeldScan> held{};  ///< it waits for a person, again or for the first time
    LastEnd end{};
    std::optional<AfterWork> after{};  ///< it was worked, and is to be looked at
    std::string asks{};                ///< why nobody may go on before a person has looked
  };
  /// A line and perhaps a path, before the scan's row is written.
  struct WorkedOut {
    Result<ExitStatus> status;
    std::optional<HeldScan> held{};
    std::optional<AfterWork> after{};
  };
  /// What the next scan is worked with, and whose word that is.  It outlives the service.
  struct Ordered {
    api::Job job{};
    std::string who{};
    bool taught{false};           ///< said of a scan that waited; it holds for those after it
    std::string model{};          ///< of that scan
    std::string sha256{};         ///< of that process
    robot::StopMark part_mark{};  ///< of when the part number was said: a stop ends it
    memory::UnixMs part_said{0};  ///< the same for a service after this one
  };
  /// What the service alone may use while it lives.
  struct Locks {
    report::FileLock results;
    std::optional<report::FileLock> arm;           ///< against others on this machine
    std::unique_ptr<robot::ur::ArmClaim> claim{};  ///< and on any
    /// An arm of another make, which takes one host at a time: its program is kept connected.
    std::shared_ptr<robot::other::ArmLink> other{};
  };

  Service(Options options, std::optional<wire::HostKeys> keys, std::optional<Robot> robot,
          std::optional<Carrier> carrier, Locks locks, std::unique_ptr<OperatorControl> operator_control,
          std::optional<Confirm> confirm);

  /// What the sensor has to say; connects (and goes on with `scan_`, if there is one) where there is no link.
  [[nodiscard]] Result<void> hear_sensor();
  [[nodiscard]] Result<void> on_event(const intake::LinkEvent& event);
  [[nodiscard]] Result<void> on_hello(const intake::Hello& hello);
  /// The sensor has said no to a scan: told as that, and asked again later.
  [[nodiscard]] Result<void> on_refused_start(const std::string& why);
  /// After a scan that the machine spoilt: the next one is asked for later, and later each time.  A start is
  /// a person's word to ask at once; where each scan has its own start nothing is asked for by itself.
  void rest_after(const Worked& worked);
  void rest(const std::string& words, const std::string& next_step);
  [[nodiscard]] bool rests();
  /// Goes on with a scan as far as it has come.
  void hold_scan(const std::filesystem::path& folder, intake::ScanIntake intake);
  /// The scans that predecessors of this process did not finish.
  void find_unfinished();
  /// Takes up the next of them, or sets it aside when a predecessor died of it.
  [[nodiscard]] Result<void> take_up(const std::filesystem::path& folder);
  [[nodiscard]] std::filesystem::path next_folder() const;
  /// The same, looked for ahead of time: the memory may be slow, and a stop must not wait on this thread.
  [[nodiscard]] std::filesystem::path take_next_folder();
  void look_for_next_folder();

  /// Stop, Laser off, what a person decided: of the doors.
  void heed_wishes();
  void handle(const OperatorCommand& command);
  /// What waits for a person and comes of a start before a stop waits no longer: its row says so.
  void end_what_was_stopped();
  /// The scan that the command is about, or nothing where it is not held any more; then doors are told what
  /// is.
  [[nodiscard]] std::optional<HeldScan> take_held(const OperatorCommand& command);
  /// What is held goes on with a person's word, on the result's thread.
  void go_on(const OperatorCommand& command, HeldScan held);
  /// The arm is there, of the right kind and in remote control, or there is none; asked before a scan is
  /// spent.
  [[nodiscard]] bool robot_ready();
  /// From now on whoever takes local control at the pendant says stop.
  [[nodiscard]] Result<void> watch_pendant();
  [[nodiscard]] Result<void> watch_clamp();
  /// biteline-web beside this service, and again when it ended.
  void supervise_web();
  void show_idle();
  void show_scan(const Scan& scan);
  /// What the uplink was told by the factory's centre: to the page, the log and stdout.
  void look_at_centre();
  /// From now on doors may decide about it.  `again`: only where they may already.  Thread: any.
  void tell_held(const HeldScan& held, bool again = false);

  // A look at what is held (service_look.cpp).
  /// A person has asked for one, and the sensor is to be asked, or has begun.
  [[nodiscard]] bool looks() const;
  /// Pre: looks().
  [[nodiscard]] Result<void> begin_look(const intake::Hello& hello);
  /// It waits on as before.  Pre: looks().
  void give_up_look(const std::string& why);
  /// On the result's thread.
  [[nodiscard]] Worked look_at_held(HeldScan held, Scan look);
  /// Doors are told what changes with it.
  void look_at_clamp();
  /// The same where a person has said which tool is mounted.
  void look_at_tool();

  // Several processes for one shoe (service_steps.cpp).
  /// What follows chosen's process by `next_process`.  Errc::FileNotFound: no such process;
  /// Errc::NotSupported names what does not go together.
  [[nodiscard]] Result<void> take_following(Chosen& chosen) const;
  /// A look, or another process, follows the work.
  [[nodiscard]] bool goes_on_after(const Chosen& chosen) const {
    return looks_after(chosen) || !chosen.following.empty();
  }
  /// Of several processes this one was begun and not ended: why a person must look; empty: nobody must.
  [[nodiscard]] std::string cut_off(const std::filesystem::path& folder, const Chosen& chosen,
                                    const Result<ExitStatus>& status) const;
  /// Of a step: which shoe, and with what.
  [[nodiscard]] static std::string not_worked(const Chosen& chosen);
  [[nodiscard]] static std::vector<path::Piece> pieces_of(const Missing& rework);
  /// No scan is asked for before a person has looked.
  [[nodiscard]] Worked ask_a_person(Worked worked, const std::string& words);
  /// The shoe's next process, or a rework, from its files to its end or until it waits.  The result's thread.
  /// Pre: one follows, and what was worked is ended and looked at as it asks.
  [[nodiscard]] Worked begin_step(AfterWork after, std::optional<Missing> rework = {});
  /// `after` becomes the next process's: folder, files and what it is worked with.
  [[nodiscard]] Result<void> take_step(AfterWork& after, std::optional<Missing> rework) const;
  [[nodiscard]] Result<void> plan_step(AfterWork& after) const;
  [[nodiscard]] NextStep next_of_step(const AfterWork& after) const;
  /// Pre: it may be sent without a person.
  [[nodiscard]] Worked follow_step(AfterWork after);
  /// It waited, and a person's word has ended that: the shoe stays as the process before has left it, and a
  /// person looks before the next scan: why; empty: the scan follows nothing.
  [[nodiscard]] std::string leave_step(const Scan& scan) const;
  /// Into the book of the process before: `next` is its result; not owed: nothing of it is open any more.
  void tell_next_scan(const std::string& before, const std::string& next, bool owed) const;

  // A look at what was done, and once more what is missing (service_work.cpp).
  /// The process asks for it.
  [[nodiscard]] bool looks_after(const Chosen& chosen) const;
  /// As `follow` does; from before it a look is owed where the process asks for one, and none is where the
  /// path was not followed to its end.
  [[nodiscard]] Result<ExitStatus> follow_and_owe_look(
      const std::filesystem::path& folder, const Chosen& chosen,
      const std::function<Result<ExitStatus>()>& follow) const;
  /// The sensor is to be asked for it, or has begun.
  [[nodiscard]] bool inspects() const;
  /// Pre: inspects().
  [[nodiscard]] Result<void> begin_inspection(const intake::Hello& hello);
  /// Nobody has looked: a person is to.  Pre: inspects().
  void give_up_inspection(const std::string& why);
  // The result's thread, to end_work().
  [[nodiscard]] Worked inspect_work(AfterWork after, Scan look);
  /// What a look found, and by which plan.
  struct Inspected {
    HostClock::time_point at{};  ///< of the look's end
    second_look::Findings findings{};
    second_look::PlannedBand plan{};
    look::Judged judged{};
    std::string sha256{};  ///< of its report
  };
  [[nodiscard]] Result<Inspected> inspect_files(const AfterWork& after, const cloud::PointCloud& seen,
                                                HostClock::time_point at) const;
  /// What is missing becomes a step of its own.  Pre: something is, and it is the first time.
  [[nodiscard]] Worked rework(AfterWork after, const Inspected& seen, WorkBook book);
  /// Its rework was sent: what is missing of it is that one's to tell.
  void tell_reworked(const std::string& before) const;
  /// Work and reason anew, of the scan's files; nothing where it has no row.
  void put_work_row(const std::string& scan) const;
  /// Nobody looks any more: the row says what is known.
  [[nodiscard]] Worked end_work(AfterWork after, WorkBook book, Result<ExitStatus> status);
  [[nodiscard]] Worked end_unlooked(AfterWork after, WorkBook book, const std::string& why);
  /// It waited for a person when the service ended, and has no messages to be taken up by.
  void close_held_step(const std::string& scan, const report::ToldRefusal& told) const;
  /// Of a service before this one: the shoe was worked, and nobody has looked.
  void close_owed_looks();
  /// A person must look before the next scan, also of a service after this one; empty: nobody must any more.
  void keep_asking(const std::string& words) const;

  /// Doors are told of what is held, on the result's thread: its files are read for that.  Pre: it is held,
  /// and no result is worked out.
  void tell_aside(bool again);
  /// Begins to work out a scan that is complete, once the result before it is done.
  void start_result();
  /// On the result's thread.  Pre: it is free.
  template <class Work>
  void begin_result(const std::string& scan, Work work);
  /// Nothing is in work, and nothing waits.
  [[nodiscard]] bool is_free() const { return !result_.valid() && !held_ && !after_; }
  /// What the result's thread left, once.
  [[nodiscard]] std::optional<Worked> result_done();
  /// Whatever the scan does to it: a result, or a report that says why there is none.
  [[nodiscard]] Worked work_out(Scan scan);
  [[nodiscard]] WorkedOut work_out_files(Scan& scan);
  /// What was worked out is a scan's no more that waits or goes on.
  [[nodiscard]] static const Chosen& chosen_of(const WorkedOut& out, const Scan& scan);
  /// The row of what was worked out, and room for the next.
  [[nodiscard]] Worked close_result(WorkedOut out, const std::filesystem::path& folder, Chosen chosen);
  /// It waits again: its row says so.
  [[nodiscard]] Worked hold_again(Result<ExitStatus> status, HeldScan held, const std::string& failed = {});
  [[nodiscard]] KnownBefore known_before() const;
  void keep_arm(const Scan& scan, const LineStep& step) const;
  [[nodiscard]] Result<LineStep> work_out_line(Scan& scan, intake::ScanOutcome& outcome);
  /// What the scan says about its own calibration; what fails in it is told, and costs no scan, but with
  /// --on-drift stop counts as a drift.
  /// Beside what comes next, on one core; `outcome` stays until check_own_calibration().
  void look_at_own_calibration(Scan& scan, const intake::ScanOutcome& outcome) const;
  /// Once for each scan: waits for that look.
  void check_own_calibration(Scan& scan, const intake::ScanOutcome& outcome);
  /// The same with the library: whose line it is, and the process of that model.
  [[nodiscard]] Result<LineStep> use_library(Scan& scan, const intake::ScanOutcome& outcome, LineStep found);
  /// The scan's own line weighed against its model's, or the model's carried over.
  [[nodiscard]] Result<LineStep> use_model(const std::filesystem::path& folder,
                                           const intake::ScanOutcome& outcome, Chosen& chosen,
                                           const Recognised& model, transfer::SampleFiles sample,
                                           LineStep found) const;
  /// A line for review whose model is known: the model's own line, carried over, or the line for review where
  /// that is refused.
  [[nodiscard]] Result<LineStep> carry_or_review(const std::filesystem::path& folder, Carrier carrier,
                                                 const intake::ScanOutcome& outcome, const Chosen& chosen,
                                                 LineStep found) const;
  [[nodiscard]] const TakenProcess& taken_of(const Chosen& chosen) const;
  /// As it lies on the shoe's foot.
  [[nodiscard]] path::Process process_of(const Chosen& chosen) const {
    return path::on_foot(taken_of(chosen).process, chosen.foot);
  }
  [[nodiscard]] Result<void> choose_process(Chosen& chosen) const;
  /// A model that was recognised has a process of its own, and a person has taken another one for the shoe
  /// before: neither is used unseen.
  void look_at_other_process(Chosen& chosen) const;
  /// A shoe of this part number was worked before: a person looks before it is worked again.
  void look_at_part(Chosen& chosen, const std::filesystem::path& folder) const;
  /// What the next scan is worked with, and kept for a service after this one.
  void order(Ordered ordered);
  void order_by(const OperatorCommand& start);
  /// The shoe that is scanned again has the part number that it had, unless somebody has said stop since.
  void order_part_again(const OperatorCommand& rescan);
  /// Pre: a scan begins.  The part number that was said is its own, and of no later one.
  void take_part();
  /// A person has taken this process for a scan that waits: the scans after it have it, too.
  void order_taught(const std::string& process, const Chosen& chosen);
  /// It stands in a model now, which will be recognised.
  void order_is_saved(const OperatorCommand& saved);
  /// As the service before this one left it; what no process answers for any more is told when it is used.
  void take_up_order();
  /// What was said before this service, and is of a scan that it left unfinished, is of no other one.
  void forget_used_part();
  [[nodiscard]] Ordered ordered() const;
  /// Between scans doors are told what the next shoe is worked with.
  void show_next_process();
  /// The process beside the scan's result, as it was read: a model made of the scan takes it.
  [[nodiscard]] Result<void> keep_process(const std::filesystem::path& folder, const Chosen& chosen) const;
  /// Read once for a scan: a switch while it is worked is for the next one.
  [[nodiscard]] Result<void> choose_release(Chosen& chosen) const;
  [[nodiscard]] api::Catalogue catalogue_for(const Chosen& chosen) const;
  /// Now, here and below: a scan may have waited for a long time.
  [[nodiscard]] bool holds_arm() const;
  /// Pre: there is a robot.
  [[nodiscard]] ControllerAddress controller() const;
  /// What was taught of the process's tool, whether a changer brings it, and which one is mounted; one that
  /// cannot be read is an Error, so that nothing is planned or sent unchecked.
  [[nodiscard]] Result<path::Mounted> mounted(const path::Process& process) const;
  /// Whose force is learned; nothing: the process has none, or nobody knows the model.
  [[nodiscard]] Result<std::optional<force_book::Subject>> force_subject(const Chosen& chosen) const;
  /// As process_of(), with what its model's shoes have taught of the force.
  [[nodiscard]] path::Process process_to_plan(const Chosen& chosen) const;
  /// Of a shoe that was pressed to its end; `planned`: with which its path was.  What fails in it is told.
  void learn_force(const Chosen& chosen, const std::string& name, const path::Process& planned,
                   const path::ForceTold& told) const;
  /// `waits`: it waits for a person in any case, also without a path.
  [[nodiscard]] Result<WorkedOut> work_out_path(Scan& scan, const intake::ScanOutcome& outcome,
                                                LineStep& line, bool waits);
  /// The same; an exception of it is an Error.
  [[nodiscard]] WorkedOut path_without_exceptions(Scan& scan, const intake::ScanOutcome& outcome,
                                                  LineStep& line, bool waits);
  /// The changer turns its tools where the arm comes to rest after `process`: higher up, where `next` needs
  /// another tool of it.
  void make_room_for(const path::Process& next, path::Process& process) const;
  /// A changer was asked: into the record, where it is another one; nothing: nobody knows.
  void keep_tool_that_stands(const std::optional<std::string>& name) const;
  /// Without the arm's claim a path is refused.
  [[nodiscard]] SendRequest send_request(const Scan& scan, const intake::ScanOutcome& outcome,
                                         const LineStep& line, const path::Mounted& taught) const;
  /// Why a person has to look though nobody asked for it; empty: no reason.
  [[nodiscard]] std::string looks_of(const Chosen& chosen, const path::Mounted& mounted) const;
  /// With the line as it stands in the folder, mended or not, and the request's process.
  [[nodiscard]] Result<ExitStatus> plan_anew(HeldScan& held);
  /// The files are what the service, or a mend, wrote; Errc::WrongState names the one that is not.
  [[nodiscard]] Result<void> look_at_files(HeldScan& held);
  // Of what waits, from here to send_held(): the result's thread.  Pre: it is planned; of work_named() and
  // work_with() that its model is not known.
  /// Plans it anew, with the line that a person has mended, and lets it wait again.
  [[nodiscard]] Worked plan_mended(HeldScan held);
  /// Goes on with a scan whose model a person has named; it waits again where that model cannot be read.
  [[nodiscard]] Worked work_named(HeldScan held, const std::string& model);
  /// What is taught (service_teach.cpp): plans it anew with another process.
  [[nodiscard]] Worked plan_with(HeldScan held, const std::string& process, const std::string& who);
  /// The same of a scan whose model nobody knows: it goes on without one.
  [[nodiscard]] Worked work_with(HeldScan held, const std::string& process, const std::string& who);
  /// The arm runs it in the air; its outcome stands in the scan's folder `air`.
  [[nodiscard]] Worked run_in_air(HeldScan held, const robot::Word& word);
  /// Sends it, with a person's word.
  [[nodiscard]] Worked send_held(HeldScan held, const robot::Word& word);
  /// Of the shoe and its release, for another model or process.
  [[nodiscard]] static Chosen chosen_anew(const Chosen& before);
  /// Nothing has come of a word: it waits as before.
  [[nodiscard]] Worked wait_on(HeldScan held, Error error);
  /// What a scan's row says beside its report.
  struct After {
    bool stopped{false};   ///< it waited, and a stop has ended that
    std::string failed{};  ///< why nothing came of a person's word
    bool goes_on{false};   ///< it is looked at after the work: the cycle is not over
  };
  /// The scan's row, of its folder; a memory that cannot take it is told, and costs no scan.
  /// `held`: it waits, and doors hear of it with its row; false: not any more, as a person's word says.
  struct Remembered {
    bool waits{false};
    LastEnd end{};
  };
  [[nodiscard]] Remembered remember(const std::filesystem::path& folder, const std::string& decision,
                                    const Chosen& chosen, const After& after, const HeldScan* held = nullptr);
  /// The scan is done with: its messages stay or go.
  void end_recording(intake::ScanIntake& intake, ExitStatus status);
  [[nodiscard]] robot::ScanFacts facts_of(const Scan& scan, const intake::ScanOutcome& outcome) const;
  /// Removes the folders that retention lets go.
  [[nodiscard]] Result<void> make_room() const;
  /// The messages of refused scans: no more than --keep-refused-gb.
  void bound_black_box() const;
  /// It has said hello on this link.
  [[nodiscard]] bool sensor_hears() const;
  /// Counts every connection to the sensor, also those that came back by themselves.
  [[nodiscard]] int connection() const;
  /// Its end is in, and the sensor has said how its light ended.
  [[nodiscard]] static bool ready(const Scan& scan);
  /// The word of the start is for this folder; whether for this scan its number tells.
  [[nodiscard]] bool confirmed(const std::filesystem::path& folder) const;
  /// It is a person's word no more, whatever comes of it; nothing: it was none for this scan.
  [[nodiscard]] std::optional<robot::Word> take_word(const std::filesystem::path& folder,
                                                     std::uint64_t scan_id);
  /// Set aside, with its row before the next scan begins.
  [[nodiscard]] Result<void> set_scan_aside(const std::filesystem::path& folder, const std::string& why);

  Options options_;
  const std::atomic<bool>* stop_{nullptr};  ///< of run()
  std::optional<wire::HostKeys> keys_;
  std::optional<Robot> robot_;
  std::optional<Carrier> carrier_;
  Locks locks_;
  std::unique_ptr<OperatorControl> operator_control_;
  std::optional<Confirm> confirm_;                      ///< until it is used up
  std::unique_ptr<robot::ur::PendantWatch> pendant_{};  ///< of an arm that paths are sent to
  std::unique_ptr<robot::ur::ClampWatch> clamp_{};      ///< where the cell has one that tells
  bool clamp_holds_{false};                             ///< as doors were told
  int tools_mounted_{0};                                ///< the same, so often
  std::deque<std::filesystem::path> unfinished_;        ///< folders, still to be taken up
  std::unique_ptr<intake::SensorLink> link_;
  std::optional<Scan> scan_;                ///< coming in
  int links_{0};                            ///< opened to the sensor so far
  std::deque<Scan> cut_off_;                ///< nothing more comes of them
  std::optional<robot::StopMark> asked_{};  ///< of the start whose scan has neither begun nor been refused
  std::optional<HeldScan> held_;
  std::optional<AfterWork> after_;
  std::string asks_;  ///< why a person must look before the next scan; empty: nobody must
  std::optional<intake::ChildProcess> web_;
  HostClock::time_point web_started_{}, web_next_{};
  HostClock::time_point centre_looked_{};
  std::optional<centre_word::CentreWord> centre_{};  ///< as it was told last
  HostClock::time_point robot_asked_{};
  std::string robot_wrong_;  ///< what; empty: nothing, or nobody has asked
  bool robot_moves_{false};  ///< and that is all that is wrong: it will stand
  ToldOnce told_;            ///< of robot and page, by the caller's thread
  ToldOnce spoilt_;          ///< of scans that do not come, or are no use; the same
  std::optional<Rest> rest_{};
  std::string sensor_lost_;  ///< why; empty: nobody has called it, or it is heard
  std::unique_ptr<std::mutex> job_mutex_{std::make_unique<std::mutex>()};
  Ordered ordered_;  ///< chosen at a door; read by the result's thread
  /// Of the last start or scan: what a shoe that is scanned again is called.
  struct AtTheCell {
    std::string part{};
    robot::StopMark mark{};
  };
  AtTheCell shoe_;
  HostClock::time_point next_shown_{};  ///< what the next shoe is worked with; the same mutex
  std::future<std::filesystem::path> next_folder_;
  std::future<Worked> result_;  ///< being worked out; last: its thread uses the rest
};

template <class Work>
void Service::begin_result(const std::string& scan, Work work) {
  operator_control_->works(scan);
  result_ = std::async(std::launch::async, [work = std::move(work)]() mutable {
    pthread_setname_np(pthread_self(), "bl-result");
    return work();
  });
}

}  // namespace biteline::service
