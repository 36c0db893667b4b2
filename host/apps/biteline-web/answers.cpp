// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/answers.hpp"

#include "host/control/messages.hpp"

namespace biteline::web {

WebAnswer text_answer(int status, std::string_view type, std::string text) {
  WebAnswer answer{static_cast<http::status>(status), 11};
  answer.set(http::field::content_type, beast::string_view{type.data(), type.size()});
  answer.set(http::field::cache_control, "no-store");
  answer.body() = std::move(text);
  return answer;
}

WebAnswer error_answer(int status, std::string_view code, const std::string& message) {
  const control::Json body = control::refusal(status, std::string{code}, message).body;
  return text_answer(status, "application/json",
                     body.dump(-1, ' ', false, control::Json::error_handler_t::replace) + "\n");
}

}  // namespace biteline::web
