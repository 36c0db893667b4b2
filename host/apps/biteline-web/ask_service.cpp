// SPDX-License-Identifier: MIT
// Questions to the service, without a thread that waits.
#include <memory>
#include <utility>

#include "host/apps/biteline-web/connection.hpp"

namespace biteline::web {

using net::use_awaitable;

net::awaitable<control::Answer> ask_service(WebContext& context, control::Request request) {
  ++context.forwarded;
  const auto begin = [&context](auto handler, control::Request asked) {
    // Shared, because std::function wants copies; called once.
    const auto shared = std::make_shared<decltype(handler)>(std::move(handler));
    const auto executor = net::get_associated_executor(*shared);
    context.door->ask(std::move(asked), [shared, executor](control::Answer given) {
      net::post(executor, [shared, given = std::move(given)]() mutable { (*shared)(std::move(given)); });
    });
  };
  auto token = use_awaitable;
  const control::Answer answer = co_await net::async_initiate<net::use_awaitable_t<>, void(control::Answer)>(
      begin, token, std::move(request));
  if (answer.status == 503) ++context.host_away;
  co_return answer;
}

net::awaitable<control::Answer> ask_who(WebContext& context, std::string session, bool local) {
  control::Request request;
  request.token = std::move(session);
  request.local = local;
  request.door = "web";
  request.method = "GET";
  request.path = "/api/v1/me";
  co_return co_await ask_service(context, std::move(request));
}

}  // namespace biteline::web
