// SPDX-License-Identifier: MIT
#pragma once
/// \file Sessions and accounts over the API: the same at a cell and at the factory's centre.

#include <string>

#include "host/interfaces/accounts/accounts.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::api::people {

using accounts::Accounts;
using accounts::Person;
using control::Answer;
using control::Request;

[[nodiscard]] Answer login_needed();
/// 401 or 403 where `person` (empty: nobody) may not do what needs this role; nothing: he may.
[[nodiscard]] std::optional<Answer> closed_to(const std::optional<Person>& person, accounts::Role needed);

[[nodiscard]] Answer log_in(Accounts& accounts, const Request& request);
[[nodiscard]] Answer log_out(Accounts& accounts, const Request& request);
[[nodiscard]] Answer read_me(const Accounts& accounts, const Request& request, const Person& person);
[[nodiscard]] Answer list_users(const Accounts& accounts);
/// The first account is made by whoever sits at this machine and shows the first token (first_token.hpp),
/// nobody logged in.
[[nodiscard]] Answer add_user(Accounts& accounts, const Request& request, const Person& person);
[[nodiscard]] Answer change_user(Accounts& accounts, const Request& request, const Person& person,
                                 const std::string& name);
[[nodiscard]] Answer remove_user(Accounts& accounts, const Request& request, const Person& person,
                                 const std::string& name);

}  // namespace biteline::api::people
