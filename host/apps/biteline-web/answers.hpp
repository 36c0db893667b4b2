// SPDX-License-Identifier: MIT
#pragma once
/// \file Answers with the headers that every one of them carries.

#include <string>
#include <string_view>

#include "host/apps/biteline-web/beast.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::web {

using WebRequest = http::request<http::string_body>;
using WebAnswer = http::response<http::string_body>;

/// What a document may load and do: nothing that does not come from this server, no script within the page's
/// text, no frame round it.
inline constexpr std::string_view k_page_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; font-src 'self'; "
    "connect-src 'self'; manifest-src 'self'; worker-src 'self'; frame-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";
/// Of answers that are no pages of ours.
inline constexpr std::string_view k_data_policy = "default-src 'none'; frame-ancestors 'none'; sandbox";
/// Of a result's own page: it shows what stands in it, in a room apart from the session and from this server.
inline constexpr std::string_view k_result_page_policy =
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";

/// Puts them on any response; `tls` adds that the browser is to stay with TLS.
template <class Fields>
void put_security_headers(Fields& fields, std::string_view policy, bool tls) {
  const auto text = [](std::string_view view) { return beast::string_view{view.data(), view.size()}; };
  fields.set(http::field::server, "biteline");
  fields.set("Content-Security-Policy", text(policy));
  fields.set("X-Content-Type-Options", "nosniff");
  fields.set(http::field::x_frame_options, policy == k_result_page_policy ? "SAMEORIGIN" : "DENY");
  fields.set("Referrer-Policy", "no-referrer");
  fields.set("Cross-Origin-Opener-Policy", "same-origin");
  fields.set("Cross-Origin-Resource-Policy", "same-origin");
  fields.set("Permissions-Policy", "camera=(), microphone=(), geolocation=()");
  if (tls) fields.set(http::field::strict_transport_security, "max-age=31536000");
}

/// {"error": {"code": ..., "message": ...}}, never cached.
[[nodiscard]] WebAnswer error_answer(int status, std::string_view code, const std::string& message);
[[nodiscard]] WebAnswer text_answer(int status, std::string_view type, std::string text);
/// 404 and 401.
[[nodiscard]] WebAnswer not_found(std::string_view path);
[[nodiscard]] WebAnswer login_needed();
/// The service's answer in HTTP's clothes; `path` tells the type of a text.
[[nodiscard]] WebAnswer as_http(const control::Answer& answer, std::string_view path);
/// One line; what is no UTF-8 is replaced.
[[nodiscard]] std::string to_body(const control::Json& json);
[[nodiscard]] std::string_view view(beast::string_view text);

}  // namespace biteline::web
