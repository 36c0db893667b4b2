// SPDX-License-Identifier: MIT
#include "common/core/base64.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline {

TEST_GROUP(Base64){};

TEST(Base64, TheVectorsOfRfc4648GoBothWays) {
  const struct {
    const char *bytes, *text;
  } k_vectors[] = {{"", ""},
                   {"f", "Zg=="},
                   {"fo", "Zm8="},
                   {"foo", "Zm9v"},
                   {"foob", "Zm9vYg=="},
                   {"fooba", "Zm9vYmE="},
                   {"foobar", "Zm9vYmFy"}};
  for (const auto& vector : k_vectors) {
    STRCMP_EQUAL(vector.text, to_base64(vector.bytes).c_str());
    const auto back = from_base64(vector.text);
    CHECK_TEXT(back.has_value(), vector.text);
    STRCMP_EQUAL(vector.bytes, back->c_str());
  }
}

TEST(Base64, EveryByteComesBack) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  for (std::size_t length = 250; length <= 256; ++length) {
    const auto back = from_base64(to_base64(bytes.substr(0, length)));
    CHECK(back.has_value());
    CHECK(*back == bytes.substr(0, length));
  }
}

TEST(Base64, WhatIsNotItsOwnTextIsNone) {
  for (const char* text :
       {"Z", "Zg", "Zg=", "Zg==Zg==", "Z===", "====", "=g==", "Zm8=Zm8=", "Zm9-", "Zm 9", "Zh==", "Zm9="})
    CHECK_TEXT(!from_base64(text).has_value(), text);
}

}  // namespace biteline
