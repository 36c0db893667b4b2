// SPDX-License-Identifier: MIT
#include "common/mcap/verify.hpp"

#include "tests/unit/common/mcap/made_file.hpp"

namespace biteline::mcap {

TEST_GROUP(McapVerify) {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "a.mcap";

  Result<Verdict> verdict_of(const std::string& bytes) const {
    return verify(put(folder, bytes));
  }
};

TEST(McapVerify, WholeFileHasNoFault) {
  for (const Compression compression : {Compression::None, Compression::Zstd}) {
    std::filesystem::remove(file);
    std::string link;
    made_file(file, compression, &link);
    const auto verdict = verify(file);
    SUCCEEDS(verdict);
    STRCMP_EQUAL("", verdict->faults.empty() ? "" : verdict->faults[0].what.c_str());
    LONGS_EQUAL(9, verdict->messages);
    LONGS_EQUAL(3, verdict->chunks);
    LONGS_EQUAL(1, verdict->attachments);
    LONGS_EQUAL(4, verdict->links);  // one for each chunk, one at the end
    LONGS_EQUAL(6, verdict->topics.at("/pose").messages);
    STRCMP_EQUAL(link.c_str(), verdict->last_link.c_str());
    CHECK(verdict->check_sums);
  }
}

TEST(McapVerify, EveryFlippedByteIsFound) {
  for (const Compression compression : {Compression::None, Compression::Zstd}) {
    std::filesystem::remove(file);
    const std::string whole = made_file(file, compression);
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string spoiled = whole;
      spoiled[at] = static_cast<char>(spoiled[at] ^ (1U << at % 8));
      const auto verdict = verdict_of(spoiled);
      if (verdict && verdict->faults.empty())
        FAIL(("byte " + std::to_string(at) + " of " + std::to_string(whole.size())).c_str());
    }
  }
}

TEST(McapVerify, FlippedByteOfAChunkNamesTheChunk) {
  std::string spoiled = made_file(file, Compression::None);
  const std::size_t at = spoiled.find("message 4");
  spoiled[at] = 'M';
  const auto verdict = verdict_of(spoiled);
  SUCCEEDS(verdict);
  STRCMP_CONTAINS("chunk 2", verdict->faults.at(0).what.c_str());
  CHECK(verdict->faults[0].at < at && at - verdict->faults[0].at < 400);
}

TEST(McapVerify, EveryCutIsFound) {
  const std::string whole = made_file(file, Compression::Zstd);
  for (std::size_t size = k_magic.size(); size < whole.size(); ++size) {
    const auto verdict = verdict_of(whole.substr(0, size));
    SUCCEEDS(verdict);
    CHECK(!verdict->faults.empty());
  }
}

// The definition in chain.hpp, followed with nothing but the file's bytes.
TEST(McapVerify, ChainIsAsDescribed) {
  std::string link;
  const std::string whole = made_file(file, Compression::Zstd, &link);
  const std::string name = "biteline.chain", key = "sha256";
  std::array<std::uint8_t, 32> before{};
  std::size_t from = 0, links = 0;
  for (std::size_t at = whole.find(name); at != std::string::npos; at = whole.find(name, at + 1)) {
    if (static_cast<Opcode>(whole[at - 13]) != Opcode::Metadata) continue;  // an index of the summary
    Sha256 sha;
    sha.add(before);
    sha.add(view(whole).subspan(from, at - 13 - from));
    before = sha.take();
    const std::size_t value = whole.find(key, at) + key.size() + 4;
    STRCMP_EQUAL(hex(before).c_str(), whole.substr(value, 64).c_str());
    from = value + 64;
    ++links;
  }
  LONGS_EQUAL(4, links);
  STRCMP_EQUAL(link.c_str(), hex(before).c_str());
}

// What no check sum can find: somebody changes a message and makes all sums anew.
TEST(McapVerify, AnotherMessageMakesAnotherLastLink) {
  std::string one, other;
  made_file(file, Compression::None, &one);
  auto writer = Writer::create(folder.path() / "other.mcap", {.library = "test"});
  SUCCEEDS(writer);
  const auto last = writer->close();
  SUCCEEDS(last);
  CHECK(one != *last);
}

}  // namespace biteline::mcap
