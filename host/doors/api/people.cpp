// SPDX-License-Identifier: MIT
// Accounts.
#include <algorithm>

#include "host/doors/api/api.hpp"
#include "host/doors/api/words.hpp"

namespace biteline::api {

using accounts::Role;
using control::Answer;

namespace {

constexpr std::size_t k_most_name = 64;
constexpr std::size_t k_most_password = 200;

std::optional<Role> role_field(Fields& fields, bool required) {
  const std::string text = fields.text("role", 20, required);
  if (text.empty()) return std::nullopt;
  const std::optional<Role> role = accounts::role_of(text);
  if (!role) fields.fault("role", "viewer, operator, engineer or administrator expected");
  return role;
}

Result<Json> user_json(const accounts::Accounts& accounts, const std::string& name) {
  BITELINE_ASSIGN(const std::vector<memory::User> users, accounts.all());
  const auto found = std::ranges::find(users, name, &memory::User::name);
  if (found == users.end()) return fail(Errc::FileNotFound, "user '%.40s'", name.c_str());
  return to_json(*found);
}

Answer user_answer(const accounts::Accounts& accounts, const std::string& name, int status) {
  const Result<Json> user = user_json(accounts, name);
  return user ? ok(*user, status) : answer_of(user.error());
}

}  // namespace

Answer Api::list_users(const Call&) {
  const Result<std::vector<memory::User>> users = rooms_.accounts.all();
  if (!users) return answer_of(users.error());
  Json list = Json::array();
  for (const memory::User& user : *users) list.push_back(to_json(user));
  return ok({{"users", std::move(list)}});
}

Answer Api::add_user(const Call& call) {
  const Result<bool> any = rooms_.accounts.has_users();
  if (!any) return answer_of(any.error());
  const bool first = !*any && call.request.local;
  if (!first && call.person.name.empty())
    return control::refusal(401, "login_needed",
                            "an administrator makes accounts; log in first (POST /sessions)");
  if (!first && call.person.role < Role::Administrator)
    return control::refusal(403, "not_allowed", "this needs the role administrator");
  Fields fields{call.request.body};
  const std::string name = fields.text("name", k_most_name, true);
  const std::optional<Role> role = role_field(fields, true);
  const std::string password = fields.text("password", k_most_password, true);
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Result<std::vector<memory::User>> users = rooms_.accounts.all();
  if (users && std::ranges::find(*users, name, &memory::User::name) != users->end())
    return control::refusal(409, "exists", name + " exists; change it instead (PATCH)");
  const Result<void> done =
      rooms_.accounts.add(name, *role, password, first ? name : call.person.name, call.request.door);
  return done ? user_answer(rooms_.accounts, name, 201) : answer_of(done.error());
}

Answer Api::change_user(const Call& call) {
  const std::string& name = call.names.front();
  Fields fields{call.request.body};
  accounts::Change change;
  change.role = role_field(fields, false);
  if (fields.has("password")) change.password = fields.text("password", k_most_password, true);
  const std::string old_password = fields.text("old_password", k_most_password);
  static_cast<void>(fields.text("password", k_most_password));  // known, given or not
  change.enabled = fields.boolean("enabled");
  if (!change.role && !change.password && !change.enabled) fields.fault("", "nothing to change");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (call.person.role < Role::Administrator) {
    const bool own = name == call.person.name && change.password && !change.role && !change.enabled;
    if (!own) return control::refusal(403, "not_allowed", "only one's own password, or an administrator");
    const Result<bool> right = rooms_.accounts.is_password_of(name, old_password);
    if (!right) return answer_of(right.error());
    if (!*right) return control::refusal(403, "wrong_password", "old_password does not fit");
  }
  const Result<void> done = rooms_.accounts.change(name, change, call.person.name, call.request.door);
  return done ? user_answer(rooms_.accounts, name, 200) : answer_of(done.error());
}

Answer Api::remove_user(const Call& call) {
  const Result<void> done = rooms_.accounts.remove(call.names.front(), call.person.name, call.request.door);
  return done ? nothing() : answer_of(done.error());
}

}  // namespace biteline::api
