// SPDX-License-Identifier: MIT
#pragma once
/// \file What the API asks of the running service.

#include <optional>
#include <string>
#include <vector>

#include "common/settings/settings.hpp"
#include "host/interfaces/api/rerun.hpp"
#include "host/interfaces/control/messages.hpp"
#include "host/interfaces/line_control/line_state.hpp"
#include "host/report/refusal.hpp"
#include "host/robot/link/ur/arm_look.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::api {

using control::Json;

/// Who says something, and how many stops the service had counted when it heard it.  Without a number it was
/// said before every stop: a stop ends what was said before it, also where it waited and comes later.
struct Speaker {
  std::string name;
  std::uint64_t stops{0};
  Speaker(const char* name_) : name{name_} {}
  Speaker(std::string name_, std::uint64_t stops_ = 0) : name{std::move(name_)}, stops{stops_} {}
};

/// A person's word on one scan.
struct Decision {
  enum class Kind { Accept, Reject, Hold, Send };
  Kind kind{Kind::Hold};
  std::string scan;
  std::string who;
  std::string why;
  std::string door;        ///< through which the word came
  std::string version{};   ///< of what is held, as it was looked at; empty: not told
  std::uint64_t stops{0};  ///< as of a Speaker
};

/// What the next scan is worked with, until another is chosen.  Empty: as recognised.
struct Job {
  std::string model{};       ///< name of a model or of one of its samples
  std::string process{};     ///< name of a process; empty: the model's own
  std::string foot{};        ///< left or right
  std::string size{};        ///< as its samples name it, e.g. "EU 42"
  std::string part{};        ///< part number of the next shoe, and of no other
  bool keep_process{false};  ///< nothing was said of it: what a person chose before goes on
  bool hold{false};          ///< every scan of it waits for a person, whatever its process says
};

/// What a path along a kept scan's line would be.
struct TriedPath {
  std::optional<report::ToldRefusal> refused;  ///< nothing: every check passed
  double duration_s{0};                        ///< when it passed
};

/// One setting of the sensor and what it shall be; nothing: as it is without any set.
struct SettingChange {
  settings::Key key;
  std::optional<settings::Value> value;
};

/// Thread: each method from any thread; none waits for scan or arm.
class Cell {
 public:
  Cell() = default;
  Cell(const Cell&) = delete;
  Cell& operator=(const Cell&) = delete;
  virtual ~Cell() = default;

  /// `State` of the API without `control` and `seq`.
  [[nodiscard]] virtual Json state() = 0;
  /// Lists of `Robot` and `Sensor`.
  [[nodiscard]] virtual Json robots() = 0;
  [[nodiscard]] virtual Json sensors() = 0;

  /// Arm and scan end, and every order that was heard before; no new scan begins until somebody starts. Waits
  /// for nothing, here and below: of all that is asked these are the two that may never wait.
  virtual void stop(const std::string& who) = 0;
  /// As stop(), and the sensor turns its light off.
  virtual void laser_off(const std::string& who) = 0;

  /// Errc::WrongState says why not now, here and below also that a stop came after the order.
  [[nodiscard]] virtual Result<void> start(const Job& job, const Speaker& who) = 0;
  /// `hold` as of a job: of the shoe that is scanned again, and of those after it.
  struct Rescan {
    std::string who, why, door;
    bool hold{false};
    std::uint64_t stops{0};  ///< as of a Speaker
  };
  [[nodiscard]] virtual Result<void> rescan(const Rescan& order) = 0;
  [[nodiscard]] virtual Result<void> decide(const Decision& decision) = 0;

  /// The sensor takes all of them or none.  Waits for its answer, 8 s at most: a camera is told and read
  /// back. Errc::WrongState: it says its settings not or another change is on its way.  Errc::BadValue: they
  /// do not go together.  Errc::PeerRefused: the sensor's own reason.
  [[nodiscard]] virtual Result<void> change_settings(const std::vector<SettingChange>& changes,
                                                     const std::string& who) = 0;

  /// The sensor keeps the scan that waits, or with `next` the one that ends next, and says which.  Waits as
  /// change_settings().  Errc::WrongState: no sensor, or one that is too old.  Errc::PeerRefused: its own
  /// reason.
  [[nodiscard]] virtual Result<std::string> keep_recording(bool next, const std::string& who) = 0;

  /// For the line's control (host/interfaces/line_control).  False: it has no say here.
  [[nodiscard]] virtual bool on_demand() = 0;
  /// Nothing of the memory is asked: it may be read many times a second.
  [[nodiscard]] virtual line_control::LineState line_state() = 0;
  /// The job of a number; nothing: there is none.
  [[nodiscard]] virtual std::optional<Job> job_of(int number) = 0;
  /// `control_held`: by somebody at a page.
  [[nodiscard]] virtual line_control::Refusal choose_job(int number, bool control_held) = 0;
  /// Of the scan that is started next; empty: it has none.
  [[nodiscard]] virtual line_control::Refusal choose_part(const std::string& part, bool control_held) = 0;
  /// `fresh`: no start of this number was taken before.
  struct LineStart {
    line_control::Refusal refusal{line_control::Refusal::None};
    bool fresh{false};
  };
  [[nodiscard]] virtual LineStart start_for_line(int request, bool control_held, std::uint64_t stops) = 0;

  /// A scan that waits since nobody knows its model goes on as one of this model.  Errc::WrongState: it does
  /// not wait for that.
  [[nodiscard]] virtual Result<void> choose_model(const std::string& scan, const std::string& model,
                                                  const Speaker& who) = 0;

  /// A scan that waits gets its path planned anew with the process of this name, and waits on; one whose
  /// model nobody knows goes on without a model, and then waits for a person's word.  Errc::WrongState: it
  /// does not wait, or there is no arm.
  [[nodiscard]] virtual Result<void> choose_process(const std::string& scan, const std::string& process,
                                                    const Speaker& who) = 0;
  /// The arm runs the path of a scan that waits for a word in the air (host/robot/path/first_run.hpp),
  /// through the same checks and the same gate; then the scan waits again.  Errc::WrongState as above.
  [[nodiscard]] virtual Result<void> run_in_air(const std::string& scan, const Speaker& who) = 0;

  /// The sensor is asked whether the shoe of a scan that waits still lies as it was scanned.
  /// Errc::WrongState: it does not wait, or the sensor has no time.
  [[nodiscard]] virtual Result<void> look_again(const std::string& scan, const Speaker& who) = 0;

  /// Its line is being mended: until end_mend() nobody can accept the scan.  Errc::WrongState while the scan
  /// is in work.
  [[nodiscard]] virtual Result<void> begin_mend(const std::string& scan) = 0;
  /// `mended`: the scan's folder has a new line.  A scan that waits for a person gets its path planned anew.
  virtual void end_mend(const std::string& scan, bool mended, const Speaker& who) = 0;

  /// A model was made with this process: whoever chose it for the scans to come finds it there.
  virtual void model_saved(const std::string& process_sha256, const std::string& who) = 0;

  /// Works a kept scan out again, beside the cell's own work; the number of its folder
  /// (host/interfaces/api/rerun.hpp). Errc::WrongState where it has no points any more, too many wait, or a
  /// path is wanted without an arm.
  [[nodiscard]] virtual Result<int> rerun(const RerunOrder& order) = 0;
  /// Plans and checks a path along the line of a kept scan; nothing is written, nothing is sent.  Takes some
  /// tenths of a second of one core.  Errc::WrongState without an arm, and while the arm follows a path.
  [[nodiscard]] virtual Result<TriedPath> try_process(const std::string& scan,
                                                      const path::Process& process) = 0;
  /// Where the arm stands and what its controller carries; it is read, and takes up to some seconds.
  /// Errc::WrongState without an arm, while it moves, and while it follows a path.
  [[nodiscard]] virtual Result<robot::ur::ArmLook> look_at_arm() = 0;
  /// Another tool is mounted, as a person said, or nobody knows which: what waits may be sent now, or no
  /// more.
  virtual void tool_mounted() = 0;
  /// It waits or is worked on.
  [[nodiscard]] virtual bool rerun_open(const std::string& scan, int number) = 0;
};

}  // namespace biteline::api
