// SPDX-License-Identifier: MIT
// What this server itself gives out: the page, results, its description, its counts.
#include <algorithm>
#include <array>
#include <utility>

#include "common/core/text.hpp"
#include "host/apps/biteline-web/connection.hpp"
#include "host/apps/biteline-web/deadline.hpp"
#include "host/apps/biteline-web/guards.hpp"
#include "host/apps/biteline-web/served_folder.hpp"

namespace biteline::web {
namespace {

using control::Json;
using net::redirect_error;
using net::use_awaitable;

constexpr std::size_t k_piece_bytes = 64 * 1024;
constexpr std::size_t k_most_openapi_bytes = 1U << 20U;

/// The body of a list of files.
Json to_json(const std::vector<ListedFile>& files) {
  Json list = Json::array();
  for (const ListedFile& file : files) {
    list.push_back(
        {{"path", clean_text(file.path)}, {"bytes", file.size_bytes}, {"time", utc_text(file.changed_ns)}});
  }
  return {{"files", std::move(list)}};
}

/// RFC 9110, 12.5.3: gzip named, and not with a weight of 0.
bool takes_gzip(std::string_view accepted) {
  const std::size_t at = accepted.find("gzip");
  if (at == std::string_view::npos) return false;
  const std::string_view rest = accepted.substr(at + 4, accepted.substr(at).find(',') - 4);
  const std::size_t weight = rest.find("q=0");
  return weight == std::string_view::npos ||
         rest.find_first_of("123456789", weight + 3) != std::string_view::npos;
}

/// Of this version of a file: another size, time or packing is another one.
std::string tag_of(const ServedFile& file, bool packed) {
  return "\"" + std::to_string(file.size_bytes()) + "-" + std::to_string(file.changed_ns()) +
         (packed ? "-gzip\"" : "\"");
}

}  // namespace

net::awaitable<void> Connection::send_openapi() {
  const auto file =
      open_served_file(context_.config.openapi.parent_path(), context_.config.openapi.filename());
  std::string text(file ? std::min<std::uint64_t>(file->size_bytes(), k_most_openapi_bytes) : 0, '\0');
  if (!file || !file->read(0, text)) {
    co_await send(error_answer(404, "not_found", "openapi.yaml is not beside the program (share/biteline)"));
    co_return;
  }
  co_await send(text_answer(200, "application/yaml", std::move(text)));
}

net::awaitable<void> Connection::send_metrics(std::string token) {
  control::Request question;
  question.token = std::move(token);
  question.door = "web";
  question.method = "GET";
  question.path = "/api/v1/exchange/metrics";
  const control::Answer given = co_await ask_service(context_, std::move(question));
  if (given.status != 200 || !given.body.is_object()) {
    co_await send(as_http(given, "/metrics"));
    co_return;
  }
  co_await send(text_answer(200, "text/plain; version=0.0.4; charset=utf-8",
                            metrics_text(context_.counts(), given.body.value("state", Json{}),
                                         given.body.value("sensors", Json{}))));
}

net::awaitable<void> Connection::send_file_list(std::string scan) {
  if (context_.results.empty()) {
    co_await send(
        error_answer(503, "host_away", "the service has not yet said where its results are: try again"));
    co_return;
  }
  const auto files = is_scan_name(scan) ? list_served_files(context_.results, scan)
                                        : Result<std::vector<ListedFile>>{fail(Errc::FileNotFound, "scan")};
  if (!files) {
    co_await send(not_found(scan));
    co_return;
  }
  co_await send(text_answer(200, "application/json", to_body(to_json(*files))));
}

net::awaitable<void> Connection::send_result_file(const WebRequest& request, std::string scan,
                                                  std::string path) {
  if (context_.results.empty()) {
    co_await send(
        error_answer(503, "host_away", "the service has not yet said where its results are: try again"));
    co_return;
  }
  const std::string within = scan + "/" + path;
  // Hidden files are the program's own.
  const bool hidden = path.starts_with('.') || path.find("/.") != std::string::npos;
  auto file = is_scan_name(scan) && !hidden ? open_served_file(context_.results, within)
                                            : Result<ServedFile>{fail(Errc::FileNotFound, "file")};
  if (!file) {
    co_await send(not_found(path));
    co_return;
  }
  SentAs as{.kind = FileKind::Result, .range = view(request[http::field::range])};
  co_await send_file(*file, path, std::move(as));
}

net::awaitable<void> Connection::send_page(const WebRequest& request, std::string path) {
  path.erase(0, 1);
  if (path.empty() || path.ends_with('/')) path += "index.html";
  bool packed = takes_gzip(view(request[http::field::accept_encoding]));
  Result<ServedFile> file = fail(Errc::FileNotFound, "packed");
  if (packed) file = open_served_file(context_.config.page, path + ".gz");
  packed = file.has_value();
  if (!file) file = open_served_file(context_.config.page, path);
  if (!file) {
    WebAnswer refusal = not_found("/" + path);
    if (path == "index.html") {
      refusal =
          error_answer(404, "not_found", "the page is not there: build it, or name its folder with --page");
    }
    co_await send(std::move(refusal));
    co_return;
  }
  const std::string tag = tag_of(*file, packed);
  if (view(request[http::field::if_none_match]) == tag) {
    WebAnswer unchanged{http::status::not_modified, 11};
    unchanged.set(http::field::etag, tag);
    unchanged.set(http::field::cache_control, "no-cache");
    co_await send(std::move(unchanged), k_page_policy);
    co_return;
  }
  SentAs as{.kind = FileKind::Page, .tag = tag, .packed = packed};
  co_await send_file(*file, path, std::move(as));
}

net::awaitable<void> Connection::send_download(const control::Answer& given, std::string name) {
  auto opened = open_served_file(context_.results, given.file);
  if (!opened || context_.results.empty()) {
    co_await send(error_answer(503, "host_away", "the service's file is not there any more: try again"));
    co_return;
  }
  if (given.type == "application/x-tar") name += ".tar";
  SentAs as{.kind = FileKind::Download};
  co_await send_file(*opened, clean_text(name, 80), std::move(as));
}

net::awaitable<void> Connection::send_file(const ServedFile& file, std::string path, SentAs as) {
  const FileKind kind = as.kind;
  const RangeAnswer part = read_range(as.range, file.size_bytes());
  if (part.kind == RangeKind::Refused) {
    WebAnswer refusal = error_answer(416, "range_refused", "the range lies beyond the file's end");
    refusal.set(http::field::content_range, "bytes */" + std::to_string(file.size_bytes()));
    co_await send(std::move(refusal));
    co_return;
  }
  std::uint64_t at = part.kind == RangeKind::Part ? part.range.first : 0;
  const std::uint64_t end = part.kind == RangeKind::Part ? part.range.last + 1 : file.size_bytes();
  http::response<http::empty_body> header{
      part.kind == RangeKind::Part ? http::status::partial_content : http::status::ok, 11};
  const std::string_view type = content_type(path);
  const bool result_page = kind == FileKind::Result && type.starts_with("text/html");
  put_security_headers(header,
                       kind == FileKind::Page ? k_page_policy
                       : result_page          ? k_result_page_policy
                                              : k_data_policy,
                       stream_.encrypted());
  header.set(http::field::content_type, beast::string_view{type.data(), type.size()});
  header.set(http::field::cache_control, kind == FileKind::Page ? "no-cache" : "private, no-cache");
  if (!as.tag.empty()) {
    header.set(http::field::etag, as.tag);
    header.set(http::field::vary, "Accept-Encoding");
  }
  if (as.packed) header.set(http::field::content_encoding, "gzip");
  if (kind == FileKind::Download)
    header.set(http::field::content_disposition, "attachment; filename=\"" + path + "\"");
  if (kind != FileKind::Page) header.set(http::field::accept_ranges, "bytes");
  if (part.kind == RangeKind::Part) {
    header.set(http::field::content_range, "bytes " + std::to_string(at) + "-" + std::to_string(end - 1) +
                                               "/" + std::to_string(file.size_bytes()));
  }
  header.content_length(end - at);
  header.keep_alive(keep_alive_);
  ErrorCode fault;
  http::response_serializer<http::empty_body> serializer{header};
  {
    const Deadline deadline{stream_, context_.config.limits.answer_time};
    co_await http::async_write_header(stream_, serializer, redirect_error(use_awaitable, fault));
  }
  std::string piece;
  while (!fault && !head_only_ && at < end) {
    piece.resize(std::min<std::uint64_t>(k_piece_bytes, end - at));
    const Result<std::size_t> got = file.read(at, piece);
    // A file that became shorter meanwhile: the client sees that the answer is cut.
    if (!got || *got < piece.size()) {
      keep_alive_ = false;
      co_return;
    }
    const Deadline deadline{stream_, context_.config.limits.answer_time};
    co_await net::async_write(stream_, net::buffer(piece), redirect_error(use_awaitable, fault));
    at += piece.size();
  }
  if (fault) keep_alive_ = false;
}

}  // namespace biteline::web
