// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/answers.hpp"

#include "common/core/text.hpp"

namespace biteline::web {

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

std::string to_body(const control::Json& json) {
  return json.dump(-1, ' ', false, control::Json::error_handler_t::replace) + "\n";
}

WebAnswer text_answer(int status, std::string_view type, std::string text) {
  WebAnswer answer{static_cast<http::status>(status), 11};
  answer.set(http::field::content_type, beast::string_view{type.data(), type.size()});
  answer.set(http::field::cache_control, "no-store");
  answer.body() = std::move(text);
  return answer;
}

WebAnswer error_answer(int status, std::string_view code, const std::string& message) {
  return text_answer(status, "application/json",
                     to_body(control::refusal(status, std::string{code}, message).body));
}

WebAnswer not_found(std::string_view path) {
  return error_answer(404, "not_found", clean_text(path, 200) + ": nothing of this name here");
}

WebAnswer login_needed() {
  return error_answer(401, "login_needed",
                      "a session is needed: POST /api/v1/sessions, then send its cookie or Authorization: "
                      "Bearer TOKEN");
}

WebAnswer as_http(const control::Answer& answer, std::string_view path) {
  if (answer.status == 204) return text_answer(204, "application/json", "");
  if (answer.body.is_string()) {
    const std::string_view type =
        path.ends_with(".csv") ? "text/csv; charset=utf-8" : "text/plain; charset=utf-8";
    return text_answer(answer.status, type, answer.body.get<std::string>());
  }
  return text_answer(answer.status, "application/json", to_body(answer.body));
}

}  // namespace biteline::web
