// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/guards.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::web {

TEST_GROUP(Guards){};

TEST(Guards, PathsThatLeadOutAreNone) {
  for (const char* path :
       {"", "a", "/../etc/passwd", "/a/../b", "/%2e%2e/b", "/a/%2E%2e", "/a%2f..%2fb", "/a//b", "/./a",
        "/a%00", "/a%0a", "/a%", "/a%4", "/a%zz", "/a\\b", "/a%5cb", "/%c0%ae%c0%ae/", "/a%ff"}) {
    CHECK_TEXT(!decode_path(path), path);
  }
}

TEST(Guards, SoundPathsAreDecodedOnce) {
  STRCMP_EQUAL("/", decode_path("/")->c_str());
  STRCMP_EQUAL("/a/b c/d", decode_path("/a/b%20c/d")->c_str());
  STRCMP_EQUAL("/a%2eb", decode_path("/a%252eb")->c_str());
  STRCMP_EQUAL("/a+b/", decode_path("/a+b/")->c_str());
  STRCMP_EQUAL("/schuh-\xC3\xA4", decode_path("/schuh-%C3%A4")->c_str());
}

TEST(Guards, QueriesAreDecodedAndNamesComeOnce) {
  const auto entries = decode_query("from=2026-01-01T00%3A00%3A00Z&model=a+b&empty");
  CHECK(entries.has_value());
  STRCMP_EQUAL("2026-01-01T00:00:00Z", entries->at("from").c_str());
  STRCMP_EQUAL("a b", entries->at("model").c_str());
  STRCMP_EQUAL("", entries->at("empty").c_str());
  CHECK(decode_query("")->empty());
  CHECK(!decode_query("a=1&a=2"));
  CHECK(!decode_query("a=%1"));
  CHECK(!decode_query("=1"));
  std::string many;
  for (int i = 0; i < 33; ++i) many.append("k").append(std::to_string(i)).append("=1&");
  CHECK(!decode_query(many));
}

TEST(Guards, TokensComeOutOfTheirHeaders) {
  STRCMP_EQUAL("abc", cookie_value("x=1; biteline_session=abc; y=2", "biteline_session").c_str());
  STRCMP_EQUAL("", cookie_value("xbiteline_session=abc", "biteline_session").c_str());
  STRCMP_EQUAL("", cookie_value("", "biteline_session").c_str());
  STRCMP_EQUAL("abc", bearer_token("bEarer  abc ").c_str());
  STRCMP_EQUAL("", bearer_token("Basic abc").c_str());
  STRCMP_EQUAL("", bearer_token("Bearer ").c_str());
  CHECK(is_token("aZ09-_="));
  for (const char* text : {"", "a b", "a;b", "a\r\nb", "\xC3\xA4"}) CHECK_TEXT(!is_token(text), text);
  CHECK(is_token(std::string(128, 'a')));
  CHECK(!is_token(std::string(129, 'a')));
}

TEST(Guards, OnlyOwnNamesAreHosts) {
  const std::vector<std::string> names{"localhost", "127.0.0.1", "[::1]"};
  for (const char* host : {"localhost", "LOCALHOST:8080", "127.0.0.1:1", "[::1]", "[::1]:8080"}) {
    CHECK_TEXT(host_allowed(host, names), host);
  }
  for (const char* host : {"", "evil.example", "localhost.evil.example", "localhost:", "localhost:80:80",
                           "[::1", "::1", "127.0.0.1:8o", "localhost evil"}) {
    CHECK_TEXT(!host_allowed(host, names), host);
  }
}

TEST(Guards, PagesOfOtherOriginsAreRefused) {
  const auto allowed = [](std::string_view origin, std::string_view site, bool tls) {
    return origin_allowed({.origin = origin, .fetch_site = site, .host = "localhost:8080", .tls = tls});
  };
  CHECK(allowed("", "", false));
  CHECK(allowed("http://localhost:8080", "same-origin", false));
  CHECK(allowed("https://LOCALHOST:8080", "", true));
  CHECK(allowed("", "none", false));
  for (const char* origin : {"null", "http://localhost", "http://localhost:80801", "https://localhost:8080",
                             "http://evil.example", "http://localhost:8080.evil.example", "file://"}) {
    CHECK_TEXT(!allowed(origin, "", false), origin);
  }
  CHECK(!allowed("", "cross-site", false));
  CHECK(!allowed("", "same-site", false));
  CHECK(!allowed("http://localhost:8080", "cross-site", false));
}

TEST(Guards, RangesStayWithinTheFile) {
  const auto part = [](const char* header, std::uint64_t size, std::uint64_t first, std::uint64_t last) {
    const RangeAnswer answer = read_range(header, size);
    CHECK_TEXT(answer.kind == RangeKind::Part, header);
    LONGS_EQUAL(first, answer.range.first);
    LONGS_EQUAL(last, answer.range.last);
  };
  part("bytes=0-0", 10, 0, 0);
  part("bytes=2-5", 10, 2, 5);
  part("bytes=5-", 10, 5, 9);
  part("bytes=5-900", 10, 5, 9);
  part("bytes=-3", 10, 7, 9);
  part("bytes=-30", 10, 0, 9);
  part("bytes=0-18446744073709551615", 10, 0, 9);
  for (const char* header : {"bytes=10-", "bytes=10-12", "bytes=-0"}) {
    CHECK_TEXT(read_range(header, 10).kind == RangeKind::Refused, header);
  }
  CHECK(read_range("bytes=0-", 0).kind == RangeKind::Refused);
  for (const char* header : {"", "bytes=", "bytes=-", "bytes=5-2", "bytes=a-b", "lines=1-2", "bytes=0-1,3-4",
                             "bytes=1", "bytes=99999999999999999999-"}) {
    CHECK_TEXT(read_range(header, 10).kind == RangeKind::Whole, header);
  }
}

}  // namespace biteline::web
