// SPDX-License-Identifier: MIT
// The centre's page: sessions and accounts, as at a cell.
#include "host/apps/biteline-fleet/page_api.hpp"
#include "host/interfaces/api/people.hpp"

namespace biteline::fleet {

using control::Answer;
namespace people = api::people;

Answer PageApi::log_in(const Call& call) {
  return people::log_in(rooms_.accounts, call.request);
}
Answer PageApi::log_out(const Call& call) {
  return people::log_out(rooms_.accounts, call.request);
}
Answer PageApi::read_me(const Call& call) {
  return people::read_me(rooms_.accounts, call.request, call.person);
}
Answer PageApi::list_users(const Call&) {
  return people::list_users(rooms_.accounts);
}
Answer PageApi::add_user(const Call& call) {
  return people::add_user(rooms_.accounts, call.request, call.person);
}
Answer PageApi::change_user(const Call& call) {
  return people::change_user(rooms_.accounts, call.request, call.person, call.names.front());
}
Answer PageApi::remove_user(const Call& call) {
  return people::remove_user(rooms_.accounts, call.request, call.person, call.names.front());
}

}  // namespace biteline::fleet
