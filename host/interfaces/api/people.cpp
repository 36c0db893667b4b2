// SPDX-License-Identifier: MIT
#include "host/interfaces/api/people.hpp"

#include <algorithm>

#include "common/core/text_bounds.hpp"
#include "host/interfaces/api/json_fields.hpp"

namespace biteline::api::people {

using accounts::Role;

namespace {

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

Answer login_needed() {
  return control::refusal(401, "login_needed", "log in first (POST /sessions)");
}

std::optional<Answer> closed_to(const std::optional<Person>& person, Role needed) {
  if (!person) return login_needed();
  if (person->role >= needed) return std::nullopt;
  return control::refusal(403, "not_allowed",
                          std::string{"this needs the role "} + accounts::to_text(needed));
}

Answer log_in(Accounts& accounts, const Request& request) {
  Fields fields{request.body};
  const bool guest = fields.has("token");
  const std::string token = guest ? fields.text("token", 100, true) : "";
  const std::string name = guest ? "" : fields.text("name", bounds::k_name, true);
  const std::string password = guest ? "" : fields.text("password", 200, true);
  fields.boolean("cookie");  // the web program's
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  std::optional<accounts::Login> login;
  if (guest) {
    Result<std::optional<accounts::Login>> used = accounts.use_guest_token(token, request.door);
    if (!used) return answer_of(used.error());
    login = std::move(*used);
    if (!login)
      return control::refusal(401, "wrong_password", "this one-time token was used or is none; log in");
  } else {
    auto tried = accounts.log_in(name, password, request.door);
    if (!tried) return answer_of(tried.error());
    if (!*tried && tried->error().too_often) {
      const int wait_s = tried->error().wait_s;
      return control::refusal(
          429, "too_many", "too many wrong passwords; wait " + std::to_string(wait_s) + " s, then try again");
    }
    if (!*tried) return control::refusal(401, "wrong_password", "name and password do not fit");
    login = std::move(**tried);
  }
  Json session{{"token", login->token},
               {"expires", memory::to_iso(login->expires)},
               {"user", {{"name", login->person.name}, {"role", accounts::to_text(login->person.role)}}}};
  if (login->not_kept)
    session["not_kept"] =
        "this login stands in no log, and a restart of the service ends it: " + to_line(*login->not_kept);
  return ok(std::move(session), 201);
}

Answer log_out(Accounts& accounts, const Request& request) {
  const Result<void> done = accounts.log_out(request.token, request.door);
  return done
             ? nothing()
             : unlogged("you are logged out until the service restarts, and then for good once there is room",
                        done.error());
}

Answer read_me(const Accounts& accounts, const Request& request, const Person& person) {
  const std::optional<accounts::Holder> holder = accounts.holder();
  return ok({{"name", person.name},
             {"role", accounts::to_text(person.role)},
             {"control", holder && holder->name == person.name},
             {"local", request.local}});
}

Answer list_users(const Accounts& accounts) {
  const Result<std::vector<memory::User>> users = accounts.all();
  if (!users) return answer_of(users.error());
  Json list = Json::array();
  for (const memory::User& user : *users) list.push_back(to_json(user));
  return ok({{"users", std::move(list)}});
}

Answer add_user(Accounts& accounts, const Request& request, const Person& person) {
  const Result<bool> any = accounts.has_users();
  if (!any) return answer_of(any.error());
  const bool first = !*any && request.local && accounts.is_first_token(request.token);
  if (!*any && !first)
    return control::refusal(403, "not_allowed",
                            "the first account is made at this service's own machine, by its own user "
                            "(biteline-web --add-user, or the page there)");
  if (!first && person.name.empty())
    return control::refusal(401, "login_needed",
                            "an administrator makes accounts; log in first (POST /sessions)");
  if (!first && person.role < Role::Administrator)
    return control::refusal(403, "not_allowed", "this needs the role administrator");
  Fields fields{request.body};
  const std::string name = fields.text("name", bounds::k_name, true);
  const std::optional<Role> role = role_field(fields, true);
  const std::string password = fields.text("password", k_most_password, true);
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Result<std::vector<memory::User>> users = accounts.all();
  if (users && std::ranges::find(*users, name, &memory::User::name) != users->end())
    return control::refusal(409, "exists", name + " exists; change it instead (PATCH)");
  const Result<void> done = accounts.add(name, *role, password, first ? name : person.name, request.door);
  return done ? user_answer(accounts, name, 201) : answer_of(done.error());
}

Answer change_user(Accounts& accounts, const Request& request, const Person& person,
                   const std::string& name) {
  Fields fields{request.body};
  accounts::Change change;
  change.role = role_field(fields, false);
  if (fields.has("password")) change.password = fields.text("password", k_most_password, true);
  const std::string old_password = fields.text("old_password", k_most_password);
  static_cast<void>(fields.text("password", k_most_password));  // known, given or not
  change.enabled = fields.boolean("enabled");
  if (!change.role && !change.password && !change.enabled) fields.fault("", "nothing to change");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (person.role < Role::Administrator) {
    const bool own = name == person.name && change.password && !change.role && !change.enabled;
    if (!own) return control::refusal(403, "not_allowed", "only one's own password, or an administrator");
    const Result<bool> right = accounts.is_password_of(name, old_password);
    if (!right) return answer_of(right.error());
    if (!*right) return control::refusal(403, "wrong_password", "old_password does not fit");
  }
  const Result<void> done = accounts.change(name, change, person.name, request.door);
  return done ? user_answer(accounts, name, 200) : answer_of(done.error());
}

Answer remove_user(Accounts& accounts, const Request& request, const Person& person,
                   const std::string& name) {
  const Result<void> done = accounts.remove(name, person.name, request.door);
  return done ? nothing() : answer_of(done.error());
}

}  // namespace biteline::api::people
