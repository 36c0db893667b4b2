// SPDX-License-Identifier: MIT
#include "host/interfaces/accounts/accounts.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "common/core/text_bounds.hpp"
#include "host/interfaces/accounts/secrets.hpp"

namespace biteline::accounts {
namespace {

constexpr std::size_t k_longest_name = bounds::k_name;
constexpr std::size_t k_shortest_password = 8;
constexpr std::size_t k_longest_password = 200;
constexpr memory::UnixMs k_session_ms = 12LL * 3600 * 1000;  // a shift, with room
/// A clock that is set by the network goes back by some seconds at times.
constexpr memory::UnixMs k_clock_mended_ms = 60'000;
constexpr int k_free_failures = 2;
constexpr int k_longest_wait_s = 60;
/// Names that were tried; beyond them the oldest waits end.
constexpr std::size_t k_most_names = 1000;
constexpr std::array k_roles{"viewer", "operator", "engineer", "administrator"};

memory::LogRow event(const std::string& who, const std::string& door, const std::string& action,
                     const std::string& subject, const std::string& before = {},
                     const std::string& after = {}) {
  return {.id = 0,
          .time = memory::now_ms(),
          .who = who,
          .door = door,
          .action = action,
          .subject = subject,
          .before = before,
          .after = after};
}

/// What the log calls programs, and the names of the centre and of a Sparkplug host at the factory's broker.
constexpr std::array<std::string_view, 4> k_reserved{"service", "guest", "fleet", "host"};

Result<void> check_name(const std::string& name) {
  const bool good =
      !name.empty() && name.size() <= k_longest_name &&
      std::ranges::find(k_reserved, name) == k_reserved.end() &&
      std::ranges::all_of(name, [](unsigned char c) {
        return c < 128 && (std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-' || c == '@');
      });
  if (good) return {};
  return fail(Errc::InvalidArgument,
              "name '%.40s': letters, digits, '.', '_', '-', '@', at most 64, not service, guest, fleet or "
              "host, expected",
              name.c_str());
}

Result<void> check_password(const std::string& password) {
  if (password.size() >= k_shortest_password && password.size() <= k_longest_password) return {};
  return fail(Errc::InvalidArgument, "password: 8 to 200 bytes expected");
}

Result<std::optional<memory::User>> find(const memory::Memory& memory, const std::string& name) {
  BITELINE_ASSIGN(const std::vector<memory::User> users, memory.users());
  const auto found = std::ranges::find(users, name, &memory::User::name);
  if (found == users.end()) return std::optional<memory::User>{};
  return std::optional<memory::User>{*found};
}

}  // namespace

const char* to_text(Role role) {
  return k_roles.at(static_cast<std::size_t>(role));
}

std::optional<Role> role_of(const std::string& text) {
  for (std::size_t i = 0; i < k_roles.size(); ++i) {
    if (text == k_roles.at(i)) return static_cast<Role>(i);
  }
  return std::nullopt;
}

Accounts::Accounts(memory::Memory& memory, std::function<memory::UnixMs()> wall)
    : memory_{memory}, wall_{std::move(wall)} {
  // One that cannot be read now is asked for when somebody shows it.
  if (const auto sessions = memory_.sessions()) {
    for (const memory::Session& session : *sessions) note(session);
  }
}

void Accounts::note(const memory::Session& session) const {
  const memory::UnixMs now = session_time();
  const std::lock_guard lock{mutex_};
  std::erase_if(sessions_, [now](const auto& one) { return one.second.expires <= now; });
  std::erase_if(only_here_, [this](const std::string& hash) { return !sessions_.contains(hash); });
  sessions_.insert_or_assign(session.token_hash, session);
}

void Accounts::forget_sessions_of(const std::string& name) const {
  const std::lock_guard lock{mutex_};
  std::erase_if(sessions_, [&](const auto& one) { return one.second.user == name; });
}

namespace {

/// One that was made later than now was made by a clock that has been put back since: its end is not known.
std::optional<Person> person_of(const memory::Session& session, memory::UnixMs now) {
  if (session.expires <= now || session.created > now + k_clock_mended_ms) return std::nullopt;
  const std::optional<Role> role = role_of(session.role);
  if (!role) return std::nullopt;
  return Person{.name = session.user, .role = *role};
}

}  // namespace

std::optional<Person> Accounts::known(const std::string& token) const {
  if (token.empty()) return std::nullopt;
  const std::string hash = hash_token(token);
  const memory::UnixMs now = session_time();
  const std::lock_guard lock{mutex_};
  const auto found = sessions_.find(hash);
  return found == sessions_.end() ? std::nullopt : person_of(found->second, now);
}

Result<tl::expected<Login, NoLogin>> Accounts::log_in(const std::string& name, const std::string& password,
                                                      const std::string& door, Clock::time_point now) {
  using Outcome = tl::expected<Login, NoLogin>;
  {
    const std::lock_guard lock{mutex_};
    if (const auto found = failures_.find(name); found != failures_.end() && now < found->second.until) {
      const auto wait = std::chrono::ceil<std::chrono::seconds>(found->second.until - now);
      return Outcome{tl::unexpected<NoLogin>{{.too_often = true, .wait_s = static_cast<int>(wait.count())}}};
    }
  }
  BITELINE_ASSIGN(const std::optional<memory::User> user, find(memory_, name));
  // Of nobody's password: an unknown name shall not answer sooner.
  static const Result<std::string> k_nobody = hash_password("no password of anybody");
  const bool right = password.size() <= k_longest_password &&
                     is_password(password, user ? user->password_hash : k_nobody.value_or("")) &&
                     user.has_value() && user->enabled;
  if (!right) {
    {
      const std::lock_guard lock{mutex_};
      if (failures_.size() >= k_most_names && !failures_.contains(name)) failures_.clear();
      Failures& failures = failures_[name];
      ++failures.count;
      if (failures.count > k_free_failures) {
        const int wait_s = std::min(k_longest_wait_s, 1 << std::min(failures.count - k_free_failures, 10));
        failures.until = now + std::chrono::seconds{wait_s};
      }
    }
    // Nobody gets in, whether it can be noted or not.
    static_cast<void>(
        memory_.log(event(user ? name : "?", door, "login failed", user ? name : "unknown name")));
    return Outcome{tl::unexpected<NoLogin>{{.too_often = false, .wait_s = 0}}};
  }
  {
    const std::lock_guard lock{mutex_};
    failures_.erase(name);
  }
  const std::optional<Role> role = role_of(user->role);
  if (!role)
    return fail(Errc::BadValue, "memory: user '%.40s' of role '%.40s'", name.c_str(), user->role.c_str());
  static_cast<void>(memory_.note_login(name, memory::now_ms()));
  BITELINE_ASSIGN(Login login, open_session({.name = name, .role = *role}, door, "login"));
  return Outcome{std::move(login)};
}

memory::UnixMs Accounts::session_time() const {
  const std::lock_guard lock{mutex_};
  const Clock::time_point now = Clock::now();
  const auto passed = std::chrono::duration_cast<std::chrono::milliseconds>(now - latest_at_);
  latest_ = std::max(wall_(), latest_ + passed.count());
  latest_at_ = now;
  return latest_;
}

Result<Login> Accounts::open_session(const Person& person, const std::string& door,
                                     const std::string& action) {
  const memory::UnixMs now = session_time();
  Login login{.token = {}, .person = person, .expires = now + k_session_ms};
  BITELINE_ASSIGN(login.token, make_token());
  const memory::Session session{.token_hash = hash_token(login.token),
                                .user = person.name,
                                .role = to_text(person.role),
                                .created = now,
                                .expires = login.expires};
  note(session);
  const Result<void> kept = keep_session(session, event(person.name, door, action, person.name));
  if (!kept) {
    login.not_kept = kept.error();
    const std::lock_guard lock{mutex_};
    only_here_.insert(session.token_hash);
  }
  return login;
}

Result<void> Accounts::keep_session(const memory::Session& session, const memory::LogRow& event) {
  BITELINE_TRY(memory_.remove_sessions_before(session.created));
  std::map<std::string, std::string> ended;
  {
    const std::lock_guard lock{mutex_};
    ended = ended_;
  }
  for (const auto& [hash, name] : ended) {
    BITELINE_TRY(memory_.remove_session(hash, accounts::event(name, "", "logout", name)));
    const std::lock_guard lock{mutex_};
    ended_.erase(hash);
  }
  return memory_.put_session(session, event);
}

std::optional<memory::Session> Accounts::only_here(const std::string& token_hash) const {
  const std::lock_guard lock{mutex_};
  const auto found = sessions_.find(token_hash);
  if (!only_here_.contains(token_hash) || found == sessions_.end()) return std::nullopt;
  return found->second;
}

Result<std::string> Accounts::make_guest_token() {
  BITELINE_ASSIGN(std::string token, make_token());
  const std::lock_guard lock{mutex_};
  guest_hash_ = hash_token(token);
  return token;
}

Result<std::string> Accounts::make_first_token() {
  BITELINE_ASSIGN(std::string token, make_token());
  const std::lock_guard lock{mutex_};
  first_hash_ = hash_token(token);
  return token;
}

bool Accounts::is_first_token(const std::string& token) const {
  const std::lock_guard lock{mutex_};
  return !first_hash_.empty() && hash_token(token) == first_hash_;
}

Result<std::optional<Login>> Accounts::use_guest_token(const std::string& token, const std::string& door) {
  {
    const std::lock_guard lock{mutex_};
    if (guest_hash_.empty() || hash_token(token) != guest_hash_) return std::optional<Login>{};
    guest_hash_.clear();
  }
  BITELINE_ASSIGN(Login login, open_session({.name = "guest", .role = Role::Viewer}, door, "guest login"));
  return std::optional<Login>{std::move(login)};
}

Result<void> Accounts::log_out(const std::string& token, const std::string& door) {
  BITELINE_ASSIGN(const std::optional<Person> person, who_is(token));
  if (!person) return {};
  const std::string hash = hash_token(token);
  bool here = false;
  {
    const std::lock_guard lock{mutex_};
    sessions_.erase(hash);
    here = only_here_.erase(hash) > 0;
    if (!here) ended_.emplace(hash, person->name);
  }
  const Result<void> forgotten =
      memory_.remove_session(hash, event(person->name, door, "logout", person->name));
  // What stood only here is over with it.
  if (!forgotten && !here) return forgotten;
  const std::lock_guard lock{mutex_};
  ended_.erase(hash);
  return {};
}

Result<std::optional<Person>> Accounts::who_is(const std::string& token) const {
  if (token.empty()) return std::optional<Person>{};
  const std::string hash = hash_token(token);
  {
    const std::lock_guard lock{mutex_};
    if (ended_.contains(hash)) return std::optional<Person>{};
  }
  BITELINE_ASSIGN(std::optional<memory::Session> session, memory_.session(hash));
  if (!session) session = only_here(hash);
  if (!session) return std::optional<Person>{};
  return person_of(*session, session_time());
}

Result<bool> Accounts::has_users() const {
  BITELINE_ASSIGN(const std::vector<memory::User> users, memory_.users());
  return !users.empty();
}

Result<void> Accounts::keep_an_administrator(const std::string& without) const {
  BITELINE_ASSIGN(const std::vector<memory::User> users, memory_.users());
  const bool another = std::ranges::any_of(users, [&](const memory::User& user) {
    return user.name != without && user.enabled && user.role == to_text(Role::Administrator);
  });
  if (another) return {};
  return fail(Errc::InvalidArgument, "'%.40s' is the last administrator; make another one first",
              without.c_str());
}

Result<void> Accounts::add(const std::string& name, Role role, const std::string& password,
                           const std::string& by, const std::string& door) {
  BITELINE_TRY(check_name(name));
  BITELINE_TRY(check_password(password));
  BITELINE_ASSIGN(const std::vector<memory::User> users, memory_.users());
  if (users.empty() && role != Role::Administrator)
    return fail(Errc::InvalidArgument, "role %s: the first account must be an administrator's",
                to_text(role));
  if (std::ranges::find(users, name, &memory::User::name) != users.end())
    return fail(Errc::InvalidArgument, "'%.40s' exists; change it instead", name.c_str());
  memory::User user{.name = name, .role = to_text(role), .password_hash = {}, .created = memory::now_ms()};
  BITELINE_ASSIGN(user.password_hash, hash_password(password));
  return memory_.put_user(user, event(by, door, "add user", name, "", to_text(role)));
}

Result<void> Accounts::change(const std::string& name, const Change& change, const std::string& by,
                              const std::string& door) {
  BITELINE_ASSIGN(std::optional<memory::User> user, find(memory_, name));
  if (!user) return fail(Errc::FileNotFound, "user '%.40s'", name.c_str());
  const bool leaves = (change.role && *change.role != Role::Administrator) || change.enabled == false;
  if (leaves && user->role == to_text(Role::Administrator)) BITELINE_TRY(keep_an_administrator(name));
  const auto words = [](const memory::User& one) { return one.role + (one.enabled ? "" : ", closed"); };
  const std::string before = words(*user);
  if (change.role) user->role = to_text(*change.role);
  if (change.enabled) user->enabled = *change.enabled;
  if (change.password) {
    BITELINE_TRY(check_password(*change.password));
    BITELINE_ASSIGN(user->password_hash, hash_password(*change.password));
  }
  // The memory ends them with it.
  forget_sessions_of(name);
  return memory_.put_user(*user, event(by, door, change.password ? "change user and password" : "change user",
                                       name, before, words(*user)));
}

Result<bool> Accounts::is_password_of(const std::string& name, const std::string& password) const {
  BITELINE_ASSIGN(const std::optional<memory::User> user, find(memory_, name));
  return user && password.size() <= k_longest_password && is_password(password, user->password_hash);
}

Result<void> Accounts::remove(const std::string& name, const std::string& by, const std::string& door) {
  BITELINE_ASSIGN(const std::optional<memory::User> user, find(memory_, name));
  if (!user) return fail(Errc::FileNotFound, "user '%.40s'", name.c_str());
  if (user->role == to_text(Role::Administrator)) BITELINE_TRY(keep_an_administrator(name));
  forget_sessions_of(name);
  BITELINE_TRY(memory_.remove_user(name, event(by, door, "remove user", name, user->role, "")));
  const std::lock_guard lock{mutex_};
  if (holder_ && holder_->name == name) holder_.reset();
  return {};
}

Result<std::vector<memory::User>> Accounts::all() const {
  return memory_.users();
}

std::optional<Holder> Accounts::holder() const {
  const std::lock_guard lock{mutex_};
  return holder_;
}

Result<void> Accounts::take_control(const std::string& name, const std::string& door,
                                    const std::string& why) {
  const std::lock_guard words{words_mutex_};
  const std::optional<Holder> held = holder();
  const std::string before = held ? held->name : "";
  BITELINE_TRY(memory_.log(event(name, door, "take control", "control", before, name)));
  const std::lock_guard lock{mutex_};
  holder_ = Holder{.name = name, .door = door, .since = memory::now_ms(), .why = why};
  return {};
}

Result<void> Accounts::give_control(const std::string& name, const std::string& to, const std::string& door) {
  BITELINE_ASSIGN(const std::optional<memory::User> user, find(memory_, to));
  if (!user || role_of(user->role) == Role::Viewer)
    return fail(Errc::InvalidArgument, "control to '%.40s': a person who may operate expected", to.c_str());
  const std::lock_guard words{words_mutex_};
  const std::optional<Holder> held = holder();
  if (!held || held->name != name) return fail(Errc::NoRights, "control is not held by %.40s", name.c_str());
  BITELINE_TRY(memory_.log(event(name, door, "give control", "control", name, to)));
  const std::lock_guard lock{mutex_};
  holder_ = Holder{.name = to, .door = door, .since = memory::now_ms(), .why = {}};
  return {};
}

Result<void> Accounts::release_control(const std::string& name, const std::string& door) {
  const std::lock_guard words{words_mutex_};
  const std::optional<Holder> held = holder();
  if (!held || held->name != name) return fail(Errc::NoRights, "control is not held by %.40s", name.c_str());
  BITELINE_TRY(memory_.log(event(name, door, "release control", "control", name, "")));
  const std::lock_guard lock{mutex_};
  holder_.reset();
  return {};
}

}  // namespace biteline::accounts
