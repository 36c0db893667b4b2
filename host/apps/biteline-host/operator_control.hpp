// SPDX-License-Identifier: MIT
#pragma once
/// \file What doors see of the service and say to it: the cell's face behind the control end.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/wire/messages.hpp"
#include "host/apps/biteline-host/cell_machine.hpp"
#include "host/apps/biteline-host/rerun.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/interfaces/control/server.hpp"
#include "host/interfaces/line_control/cycle.hpp"
#include "host/robot/link/gate/stops.hpp"
#include "host/robot/link/other/arm_link.hpp"
#include "host/robot/link/ur/controller_words.hpp"

namespace biteline::service {

struct OperatorControlConfig {
  std::filesystem::path results;
  CatalogueFolders catalogue;
  std::string sensor;                              ///< tcp://HOST:PORT
  std::string arm;                                 ///< UR5e, ...; empty: none
  std::string controller;                          ///< HOST:PORT; empty: none
  std::string rtde;                                ///< its real-time port, HOST:PORT; empty: none
  std::shared_ptr<robot::other::ArmLink> other{};  ///< an arm of another make, in place of that port
  std::string process;                             ///< its name; empty: none
  std::optional<RerunArm> rerun_arm;       ///< what a scan's path is planned anew with; nothing: none is
  std::optional<wire::Endpoint> endpoint;  ///< where doors come in; nothing: none do
  std::optional<wire::SensorKeys> keys;
  memory::FactoryDay day{};             ///< of filters, trends and tables
  std::vector<line_control::Job> jobs;  ///< of the line's control; with any, each start is one scan
  robot::Stops* stops{nullptr};         ///< that the process counts, too; nothing: the operator_control's own
};

/// In the memory's settings: "yes" while every scan waits for a person.
inline constexpr const char* k_hold_key = "hold_every_scan";

/// What a client commands the service's own thread.
struct OperatorCommand {
  enum class Kind {
    Start,
    Rescan,
    Stop,
    LaserOff,
    Send,
    Reject,
    Hold,
    Mended,
    Model,
    Settings,
    Keep,
    Process,
    Air,
    Look,
    Saved  ///< a model was made with the process of SHA-256 `why`
  };
  Kind kind{Kind::Stop};
  std::string scan{}, who{}, why{};
  api::Job job{};
  std::string settings{};                          ///< a whole settings file
  wire::Command command{wire::Command::KeepLast};  ///< of Keep
  std::uint32_t question{0};                       ///< which answer_settings() is to name
  robot::StopMark mark{};                          ///< of when it was heard

  /// Of a scan that is held.
  [[nodiscard]] bool of_held() const {
    return kind == Kind::Send || kind == Kind::Reject || kind == Kind::Model || kind == Kind::Mended ||
           kind == Kind::Process || kind == Kind::Air || kind == Kind::Look;
  }
  /// What was said before a stop is over.
  [[nodiscard]] bool ends_by_stop() const {
    return of_held() || kind == Kind::Start || kind == Kind::Rescan || kind == Kind::Hold;
  }
};

/// Owns memory, accounts, API and control end.  Thread: the doors' threads call the Cell's methods, the
/// service's the rest; neither waits for the other longer than a row is written (between_words()).
class OperatorControl final : public api::Cell {
 public:
  [[nodiscard]] static Result<std::unique_ptr<OperatorControl>> open(const OperatorControlConfig& config);
  ~OperatorControl() override;

  // For the service.
  [[nodiscard]] memory::Memory& memory() { return memory_; }
  [[nodiscard]] accounts::Accounts& accounts() { return accounts_; }
  /// Doors can come in, so somebody may decide about a scan that is held.
  [[nodiscard]] bool has_doors() const { return server_ != nullptr; }
  [[nodiscard]] const std::string& address() const { return address_; }

  /// `of_held` false: what is held is not to be had now, and what was said about it stays in the queue.
  [[nodiscard]] std::optional<OperatorCommand> next_command(bool of_held = true);
  /// It is not carried out, as it was said before a stop.
  void drop(const OperatorCommand& command);
  /// As a stop that no person said.
  void halt() { stops_.stop(); }
  /// A person at the arm's pendant has taken it: a stop, also in the log.  Where no doors are open nobody can
  /// say start: giving the arm back is the word to go on with the next scan.
  void taken_at_the_pendant();
  /// Of the last start that was taken; of the service's own until there is one.
  [[nodiscard]] robot::StopMark going() const;
  /// The cell's state at this moment.  Of its events the sensor's and the work's come by enter(), all others
  /// by doors.
  [[nodiscard]] CellMachine cell() const;
  void enter(CellEvent event);
  /// The result's thread begins with this scan.
  void works(const std::string& scan);
  /// Why no scan is asked for though one would be.
  void hinder(Hindrance hindrance);
  /// A person wants to see this scan before it is sent.
  [[nodiscard]] bool wants_hold(const std::string& scan) const;
  /// The last look, of a scan that goes to the arm else: from now on whoever wants it held is told that it is
  /// too late, and to say stop.
  [[nodiscard]] bool wants_hold_at_last(const std::string& scan);

  /// What the cell is about, and what comes next, in words.
  void show(const std::string& now, const std::string& next);
  void scan_begins(const std::string& scan);
  void show_progress(std::uint64_t profiles, std::uint64_t expected);
  struct ShownProcess {
    std::string name{};
    std::string by{};  ///< whose word it is; empty: nobody's, the model's or the service's own
  };
  /// Of the scan that is worked out, or waits.
  void show_model(const std::string& name, double probability, const ShownProcess& process);
  /// Whose shoe it is, as it was said or recognised: of the scan in work, between scans of the next one.
  struct ShownShoe {
    std::string part{}, foot{}, size{};
    bool operator==(const ShownShoe&) const = default;
  };
  void show_shoe(const ShownShoe& shoe);
  /// Between scans: what the next one is worked with.  Without a name: as its model says.
  void show_next(const ShownProcess& process);
  void hear(const wire::SensorHello& hello);
  void hear(const wire::Health& health);
  void lose_sensor(const std::string& why);
  /// What the sensor said to the settings of a command, or what it kept; without a question whichever is on
  /// its way.
  void answer_sensor(std::optional<std::uint32_t> question, const Result<std::string>& done);
  /// What the controller says of itself, or why it says nothing; `wrong`: what to do first.
  void hear(const Result<robot::ur::ControllerWords>& words, const std::string& wrong);
  /// What the last look at a shoe's work told; `asks`: a person must look.
  void show_work(const std::string& words, bool asks);
  /// What the factory's centre says of this cell's shoes; empty: it has them all.
  void show_centre(const std::string& words);
  /// A cycle goes from one asking for a scan to the next, and is none where somebody said stop in between.
  /// On demand this scan is the last until the next start.  The mark of the start that it comes of; nothing:
  /// somebody has said stop, no scan is asked for.
  [[nodiscard]] std::optional<robot::StopMark> begin_cycle();
  /// The scan that was asked for does not come: the next one waits for a start.
  void give_up_start();
  /// This row is the scan's last.
  void end_cycle(const memory::Scan& scan);
  /// Of the cycle that goes on; nothing: none does, or somebody has said stop since it began.
  [[nodiscard]] std::optional<double> cycle_s() const;
  /// What waits for a person.
  struct HeldShown {
    std::string scan;
    Waits waits{Waits::ForWord};
    /// For so long the gate lets it through for its age; nothing: its age does not end it, or it has no path.
    std::optional<double> fresh_s{};
    std::optional<robot::StopMark> mark{};  ///< of the start that it comes of; nothing: of the last one
    /// Why a yes would be refused at the gate, whatever the scan's age.
    std::optional<report::ToldRefusal> not_sendable{};
    std::string version{};  ///< of line, cloud, process and path
    /// The shoe has work of the process before on it: after a no nothing is scanned until somebody starts.
    bool is_step{false};
    std::string tool{};  ///< that a person has to mount first; empty: none, or it is
  };
  /// It waits until a person says a word; only what waits for a word can be accepted, and only what waits for
  /// its model can be given one.  Where somebody has said stop since its start, it does not wait.
  void hold(const HeldShown& held);
  /// What is told of it has changed; nothing where it waits no longer.
  void hold_on(const HeldShown& held);
  /// Somebody mends its line.
  [[nodiscard]] bool mends(const std::string& scan) const;
  /// While it is held no person's word about a scan is taken.  Whoever reads a scan's row and writes it again
  /// holds it, and who holds a scan writes its row and calls hold() under one of it: then a word never finds
  /// one without the other, and none is overwritten.
  [[nodiscard]] std::unique_lock<std::mutex> between_words() { return std::unique_lock{words_mutex_}; }
  /// The row is in the memory: all doors see it.
  void tell_scan(const std::string& scan);

  // For the API.
  [[nodiscard]] api::Json state() override;
  [[nodiscard]] api::Json robots() override;
  [[nodiscard]] api::Json sensors() override;
  void stop(const std::string& who) override;
  void laser_off(const std::string& who) override;
  [[nodiscard]] Result<void> start(const api::Job& job, const api::Speaker& who) override;
  [[nodiscard]] Result<void> rescan(const Rescan& order) override;
  [[nodiscard]] Result<void> decide(const api::Decision& decision) override;
  [[nodiscard]] Result<void> choose_model(const std::string& scan, const std::string& model,
                                          const api::Speaker& who) override;
  [[nodiscard]] Result<void> choose_process(const std::string& scan, const std::string& process,
                                            const api::Speaker& who) override;
  [[nodiscard]] Result<void> run_in_air(const std::string& scan, const api::Speaker& who) override;
  [[nodiscard]] Result<void> look_again(const std::string& scan, const api::Speaker& who) override;
  [[nodiscard]] Result<void> begin_mend(const std::string& scan) override;
  void end_mend(const std::string& scan, bool mended, const api::Speaker& who) override;
  void tool_mounted() override { ++tools_mounted_; }
  /// So often somebody has said so, since the service began.
  [[nodiscard]] int tools_mounted() const { return tools_mounted_; }
  void model_saved(const std::string& process_sha256, const std::string& who) override;
  [[nodiscard]] Result<void> change_settings(const std::vector<api::SettingChange>& changes,
                                             const std::string& who) override;
  [[nodiscard]] Result<std::string> keep_recording(bool next, const std::string& who) override;
  [[nodiscard]] bool on_demand() override { return cycle_.on_demand(); }
  [[nodiscard]] line_control::LineState line_state() override;
  [[nodiscard]] std::optional<api::Job> job_of(int number) override;
  [[nodiscard]] line_control::Refusal choose_job(int number, bool control_held) override;
  [[nodiscard]] line_control::Refusal choose_part(const std::string& part, bool control_held) override;
  [[nodiscard]] LineStart start_for_line(int request, bool control_held, std::uint64_t stops) override;
  [[nodiscard]] Result<int> rerun(const api::RerunOrder& order) override;
  [[nodiscard]] Result<api::TriedPath> try_process(const std::string& scan,
                                                   const path::Process& process) override;
  [[nodiscard]] Result<robot::ur::ArmLook> look_at_arm() override;
  [[nodiscard]] bool rerun_open(const std::string& scan, int number) override;

 private:
  OperatorControl(OperatorControlConfig config, memory::Memory memory);
  [[nodiscard]] Result<void> listen();
  /// For the service's user alone, in the folder of results; empty: none is asked for.
  [[nodiscard]] Result<std::string> make_line_token() const;
  /// So that `biteline history` goes by the same day.
  [[nodiscard]] Result<void> keep_day();
  void publish_state();
  [[nodiscard]] api::Json state_locked() const;
  /// What waits for a person, and for what; null: nothing.
  [[nodiscard]] api::Json held_json_locked() const;
  /// The commands that are taken now, by the names of their paths (operator_control_offers.cpp).
  [[nodiscard]] api::Json offers_locked() const;
  /// Its files are not what the service wrote and planned of.
  [[nodiscard]] Result<void> look_at_files(const std::string& scan) const;
  /// Why a yes to what is held would come to nothing now; nothing: the gate decides.
  [[nodiscard]] std::optional<report::ToldRefusal> not_sendable_locked() const;
  void command(OperatorCommand command);
  void command_locked(OperatorCommand command);
  /// Arm, scan, what waits and what was said end here; the service's thread tells the sensor.
  void end_all(OperatorCommand::Kind kind, const std::string& who);
  /// The scan that is held goes on: nobody can say a word about it until it is held again.
  [[nodiscard]] Result<void> take_held_locked(const std::string& scan, const robot::StopMark& mark,
                                              CellEvent event);
  void show_held_locked(const HeldShown& held);
  /// This scan is held.
  [[nodiscard]] bool holds_locked(const std::string& scan) const;
  /// It is held, or will be held again: a person's word about it is worked out.
  [[nodiscard]] bool goes_on_locked(const std::string& scan) const;
  /// It comes in, or its path is not there yet.
  [[nodiscard]] bool in_work_locked(const std::string& scan) const;
  [[nodiscard]] bool follows_locked(const std::string& scan) const;
  [[nodiscard]] std::string working_locked() const;
  /// Of the scans to come; one in work waits as it was asked for.
  void hold_all_locked(bool hold);
  /// So that it outlives this process.
  [[nodiscard]] Result<void> keep_hold(bool hold, const std::string& who);
  /// Of an order that was refused: kept is what is in force.
  void keep_what_holds(const std::string& who);
  void go_locked(OperatorCommand command);
  /// What of the state a stop changes.
  void show_stopped_locked(api::Json& state) const;
  [[nodiscard]] line_control::Standing standing_locked(bool control_held) const;

  /// Pre: no other question is on its way.  Waits, unlocked, for the sensor's answer to the command;
  /// `silent`: what is told when none comes.
  [[nodiscard]] Result<std::string> ask_sensor(std::unique_lock<std::mutex>& lock, OperatorCommand command,
                                               const char* silent);

  using Clock = std::chrono::steady_clock;

  OperatorControlConfig config_;
  memory::Memory memory_;
  accounts::Accounts accounts_;
  std::unique_ptr<api::Api> api_;
  std::string address_;
  robot::Stops own_stops_;
  robot::Stops& stops_;
  std::mutex words_mutex_;  ///< taken before mutex_
  mutable std::mutex mutex_;
  line_control::Cycle cycle_;
  CellMachine cell_;
  std::string scan_;       ///< that began last
  std::string shoe_scan_;  ///< that is in work, is held, or was last
  Hindrance hindrance_{Hindrance::None};
  std::string stopped_by_;
  std::string ended_;   ///< the last scan that waited when somebody said stop
  robot::StopMark go_;  ///< of the last start
  std::deque<OperatorCommand> commands_;
  std::string hold_wanted_;
  std::string past_hold_;                              ///< a scan that nobody can hold any more
  bool hold_all_{false};                               ///< of the job that a person started
  bool hold_kept_{false};                              ///< as it stands in the memory
  Waits waits_{Waits::ForWord};                        ///< of what is held
  std::optional<Clock::time_point> fresh_until_{};     ///< of what is held
  std::string version_{};                              ///< of what is held: of line, cloud, process and path
  std::string held_tool_{};                            ///< that is to be mounted for what is held
  bool held_is_step_{false};                           ///< of a shoe that bears work already
  std::optional<report::ToldRefusal> not_sendable_{};  ///< the same
  std::string mending_;  ///< a scan whose line is being mended, or whose path is planned anew
  std::string now_{"starts"}, next_;
  std::optional<double> progress_{};
  std::string model_;
  ShownProcess process_{};
  double model_probability_{0};
  ShownShoe shoe_{};
  std::optional<wire::SensorHello> hello_{};
  std::optional<wire::Health> health_{};
  std::string sensor_lost_{"not connected yet"};
  bool ending_{false};                                  ///< nobody waits for the sensor any more
  bool sensor_asked_{false};                            ///< a command is on its way to the sensor
  std::uint32_t sensor_question_{100};                  ///< its number; below are the service's own
  std::string settings_sent_;                           ///< its set; empty: it has none
  std::optional<Result<std::string>> sensor_answer_{};  ///< and this is what the sensor said
  std::condition_variable sensor_answered_;
  std::optional<robot::ur::ControllerWords> robot_{};
  std::string robot_wrong_;
  bool robot_asked_{false};
  struct ShownWork {
    std::string words{};
    bool asks{false};
  };
  std::optional<ShownWork> work_{};      ///< nothing: no shoe was looked at yet
  std::optional<std::string> centre_{};  ///< nothing: no centre has ever said anything
  struct Cycle {
    Clock::time_point begun;
    robot::StopMark mark;  ///< of when it began
  };
  [[nodiscard]] std::optional<double> cycle_s_locked() const;
  std::optional<Cycle> this_cycle_{};
  std::atomic<int> tools_mounted_{0};
  std::optional<double> last_cycle_s_{};
  Clock::time_point published_{};
  std::unique_ptr<RerunWorker> reruns_;      ///< tells the server when one is done
  std::unique_ptr<control::Server> server_;  ///< last: its threads use the rest
};

}  // namespace biteline::service
