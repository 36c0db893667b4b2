// SPDX-License-Identifier: MIT
#include "common/rtde/package.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

#include "common/rtde/data.hpp"

namespace biteline::rtde {

TEST_GROUP(RtdePackage) {
  PackageSplitter sut;

  Bytes body(std::size_t size, std::uint8_t first) {
    Bytes bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(first + i);
    return bytes;
  }
};

TEST(RtdePackage, HeaderIsBigEndianSizeThenLetter) {
  // The guide's own example: request of protocol version 2 is 00 05 56 00 02.
  Bytes out;
  append_package(out, PackageType::ProtocolVersion, Bytes{0, 2});
  const Bytes expected{0x00, 0x05, 0x56, 0x00, 0x02};
  CHECK(expected == out);
}

TEST(RtdePackage, ComesOutTheSameHoweverTheStreamIsCut) {
  Bytes stream;
  std::vector<std::size_t> sizes{0, 1, 253, 4, 65532, 17};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    append_package(stream, PackageType::Data, body(sizes[i], static_cast<std::uint8_t>(i)));
  }
  std::mt19937_64 random{11};
  for (const std::size_t longest : {1U, 2U, 7U, 1460U, 65535U}) {
    sut.reset();
    std::size_t found = 0;
    ByteView rest{stream};
    while (!rest.empty()) {
      const std::size_t piece = std::min<std::size_t>(rest.size(), 1 + random() % longest);
      CHECK_EQUAL(piece, sut.feed(rest.first(piece)));
      rest = rest.subspan(piece);
      for (auto package = sut.next(); package && *package; package = sut.next()) {
        CHECK_EQUAL(sizes[found], (*package)->payload.size());
        const Bytes expected = body(sizes[found], static_cast<std::uint8_t>(found));
        CHECK(std::equal(expected.begin(), expected.end(), (*package)->payload.begin()));
        ++found;
      }
    }
    CHECK_EQUAL(sizes.size(), found);
  }
}

TEST(RtdePackage, KindsThatNobodyKnowsComeOutAndTheStreamGoesOn) {
  const Bytes stream{0, 4, 'x', 9, 0, 4, 'V', 1};
  CHECK_EQUAL(stream.size(), sut.feed(stream));
  CHECK_FALSE(is_known((*sut.next())->type));
  CHECK(is_known((*sut.next())->type));
}

TEST(RtdePackage, SizeBelowTheHeaderLatchesUntilReset) {
  for (const Bytes& bad : {Bytes{0, 2, 'U'}, Bytes{0, 0, 'U'}, Bytes{0, 1, 'x', 0}}) {
    sut.reset();
    CHECK_EQUAL(bad.size(), sut.feed(bad));
    CHECK_FALSE(sut.next().has_value());
    CHECK_FALSE(sut.next().has_value());
    sut.reset();
    CHECK(sut.next().has_value());
  }
}

TEST(RtdePackage, TakesNoMoreThanItsRoom) {
  const Bytes flood(500000, 0xFF);  // announces packages of 65535 bytes of unknown kind
  CHECK_EQUAL(2 * k_max_package_bytes, sut.feed(flood));
  CHECK_EQUAL(0U, sut.feed(flood));
}

TEST(RtdePackage, RandomBytesNeverEscapeTheSpan) {
  // Under the address sanitizer an over-read would end the test.
  std::mt19937_64 random{12};
  for (int i = 0; i < 20000; ++i) {
    Bytes noise(random() % 40);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
    if (noise.size() >= 3) {
      noise[0] = 0;
      noise[1] = static_cast<std::uint8_t>(random() % 40);
      noise[2] = static_cast<std::uint8_t>("IMOPSUVv"[random() % 8]);
    }
    sut.reset();
    static_cast<void>(sut.feed(noise));
    for (auto package = sut.next(); package && *package; package = sut.next()) {
      CHECK((*package)->payload.size() + 3 <= noise.size());
    }
  }
}

TEST_GROUP(RtdeData) {
  Recipe recipe{.id = 7,
                .names = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j"},
                .types = {FieldType::Bool, FieldType::Uint8, FieldType::Uint32, FieldType::Uint64,
                          FieldType::Int32, FieldType::Double, FieldType::Vector3d, FieldType::Vector6d,
                          FieldType::Vector6i, FieldType::Vector6u}};
  std::vector<Value> values{true,
                            std::uint8_t{200},
                            std::uint32_t{4000000000U},
                            std::uint64_t{0x0102030405060708U},
                            std::int32_t{-5},
                            -0.125,
                            Vector3{1, -2, 3},
                            Vector6{1, 2, 3, 4, 5, -6.5},
                            Vector6Int32{-1, 2, -3, 4, -5, 6},
                            Vector6Uint32{1, 2, 3, 4, 5, 4294967295U}};

  Package only_package(PackageSplitter & splitter, const Bytes& bytes) {
    static_cast<void>(splitter.feed(bytes));
    return **splitter.next();
  }
};

TEST(RtdeData, EveryTypeComesBack) {
  for (const DataHeader header : {DataHeader::None, DataHeader::RecipeId}) {
    Bytes bytes;
    append_data(bytes, recipe, values, header);
    PackageSplitter splitter;
    std::vector<Value> read;
    CHECK(read_data(only_package(splitter, bytes), recipe, header, read).has_value());
    CHECK(values == read);
  }
}

TEST(RtdeData, NumbersAreBigEndianOnTheWire) {
  const Recipe one{.id = 3, .names = {"x"}, .types = {FieldType::Double}};
  Bytes bytes;
  append_data(bytes, one, std::vector<Value>{1.0}, DataHeader::RecipeId);
  const Bytes expected{0, 12, 'U', 3, 0x3F, 0xF0, 0, 0, 0, 0, 0, 0};
  CHECK(expected == bytes);
}

TEST(RtdeData, EveryWrongLengthIsRefused) {
  Bytes bytes;
  append_data(bytes, recipe, values, DataHeader::RecipeId);
  const ByteView body = ByteView{bytes}.subspan(k_header_bytes);
  std::vector<Value> read;
  for (std::size_t size = 0; size < body.size(); ++size) {
    const Package cut{.type = PackageType::Data, .payload = body.first(size)};
    CHECK_FALSE(read_data(cut, recipe, DataHeader::RecipeId, read).has_value());
  }
  Bytes longer(body.begin(), body.end());
  longer.push_back(0);
  CHECK_FALSE(read_data({.type = PackageType::Data, .payload = longer}, recipe, DataHeader::RecipeId, read)
                  .has_value());
}

TEST(RtdeData, UnknownRecipeNumberIsRefused) {
  Bytes bytes;
  append_data(bytes, recipe, values, DataHeader::RecipeId);
  PackageSplitter splitter;
  const Package package = only_package(splitter, bytes);
  const std::vector<Recipe> others{{.id = 1, .names = {}, .types = {}}};
  CHECK_FALSE(recipe_of(package, others, DataHeader::RecipeId).has_value());
  CHECK_EQUAL(0U, *recipe_of(package, std::vector<Recipe>{recipe}, DataHeader::RecipeId));
}

}  // namespace biteline::rtde
