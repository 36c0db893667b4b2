// SPDX-License-Identifier: MIT
#pragma once
/// \file Who may do what: accounts, sessions, and the one holder of control.

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/records/memory/memory.hpp"

namespace biteline::accounts {

/// Each may do what those before it may.
enum class Role { Viewer, Operator, Engineer, Administrator };
[[nodiscard]] const char* to_text(Role role);
[[nodiscard]] std::optional<Role> role_of(const std::string& text);

/// Somebody who is logged in.
struct Person {
  std::string name;
  Role role{Role::Viewer};
};

struct Login {
  std::string token;  ///< for this person alone; kept hashed only
  Person person;
  memory::UnixMs expires{0};
  /// Why the memory could not keep it: the session then stands in no log, and ends with the program.
  std::optional<Error> not_kept{};
};

/// Why nobody gets in.
struct NoLogin {
  bool too_often{false};  ///< wait `wait_s` first
  int wait_s{0};
};

struct Holder {
  std::string name;
  std::string door;
  memory::UnixMs since{0};
  std::string why;  ///< a word to the others
};

/// What is given, is changed.
struct Change {
  std::optional<Role> role{};
  std::optional<std::string> password{};
  std::optional<bool> enabled{};  ///< false: closed, its sessions end
};

/// Thread: safe from any.
class Accounts {
 public:
  using Clock = std::chrono::steady_clock;

  /// `memory` outlives it.  `wall`: of a test.
  explicit Accounts(memory::Memory& memory, std::function<memory::UnixMs()> wall = memory::now_ms);

  /// Needs no write: an Error only where nobody can be looked up.  A name that fails waits: nothing after the
  /// first two failures, then 2, 4, 8 ... 60 s.  An unknown name takes as long as a wrong password.  Takes
  /// the clock, so that a test need not wait.
  [[nodiscard]] Result<tl::expected<Login, NoLogin>> log_in(const std::string& name,
                                                            const std::string& password,
                                                            const std::string& door,
                                                            Clock::time_point now = Clock::now());
  /// A token that makes one session of a viewer, then nothing more.
  [[nodiscard]] Result<std::string> make_guest_token();
  [[nodiscard]] Result<std::optional<Login>> use_guest_token(const std::string& token,
                                                             const std::string& door);
  /// What whoever makes the first account must show from now on.
  [[nodiscard]] Result<std::string> make_first_token();
  /// Without one made before: nobody can show it.
  [[nodiscard]] bool is_first_token(const std::string& token) const;
  /// Ends the session here in any case; an Error: the memory still has it, for a restart of the program.
  [[nodiscard]] Result<void> log_out(const std::string& token, const std::string& door);
  /// Nobody: no such session, or it has expired.
  [[nodiscard]] Result<std::optional<Person>> who_is(const std::string& token) const;
  /// The same without asking the memory, so that nothing is waited for; nobody: not known here, who_is() may
  /// know more.
  [[nodiscard]] std::optional<Person> known(const std::string& token) const;

  [[nodiscard]] Result<bool> has_users() const;
  /// Names: letters, digits, '.', '_', '-', '@', 64 at most; passwords: 8 to 200 bytes. Errc::InvalidArgument
  /// says so. The first account must be an administrator's, else nobody could make the others.
  [[nodiscard]] Result<void> add(const std::string& name, Role role, const std::string& password,
                                 const std::string& by, const std::string& door);
  /// The last administrator stays one.
  [[nodiscard]] Result<void> change(const std::string& name, const Change& change, const std::string& by,
                                    const std::string& door);
  [[nodiscard]] Result<bool> is_password_of(const std::string& name, const std::string& password) const;
  [[nodiscard]] Result<void> remove(const std::string& name, const std::string& by, const std::string& door);
  [[nodiscard]] Result<std::vector<memory::User>> all() const;

  /// One person at a time moves and changes things.
  [[nodiscard]] std::optional<Holder> holder() const;
  /// From nobody, or from whoever has it: that one is named in the log.
  [[nodiscard]] Result<void> take_control(const std::string& name, const std::string& door,
                                          const std::string& why = {});
  /// Errc::NoRights when `name` does not hold it.
  [[nodiscard]] Result<void> give_control(const std::string& name, const std::string& to,
                                          const std::string& door);
  [[nodiscard]] Result<void> release_control(const std::string& name, const std::string& door);

 private:
  struct Failures {
    int count{0};
    Clock::time_point until{};
  };
  [[nodiscard]] Result<Login> open_session(const Person& person, const std::string& door,
                                           const std::string& action);
  [[nodiscard]] Result<void> keep_an_administrator(const std::string& without) const;
  void note(const memory::Session& session) const;
  void forget_sessions_of(const std::string& name) const;
  [[nodiscard]] Result<void> keep_session(const memory::Session& session, const memory::LogRow& event);
  [[nodiscard]] std::optional<memory::Session> only_here(const std::string& token_hash) const;

  /// For sessions: never goes back, whatever the machine's clock is set to.
  [[nodiscard]] memory::UnixMs session_time() const;

  memory::Memory& memory_;
  std::function<memory::UnixMs()> wall_;
  mutable memory::UnixMs latest_{0};  ///< of session_time(), and what the steady clock said then
  mutable Clock::time_point latest_at_{Clock::now()};
  std::mutex words_mutex_;  ///< of who changes control: taken before mutex_, and held while the memory writes
  mutable std::mutex mutex_;  ///< never while the memory is asked
  std::map<std::string, Failures> failures_;
  std::string guest_hash_, first_hash_;
  std::optional<Holder> holder_;
  mutable std::map<std::string, memory::Session> sessions_;  ///< as they stand in the memory, by token's hash
  mutable std::set<std::string> only_here_;                  ///< of sessions_: what the memory could not keep
  std::map<std::string, std::string> ended_;  ///< what the memory could not forget, and whose it is
};

}  // namespace biteline::accounts
