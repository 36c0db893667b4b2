// SPDX-License-Identifier: MIT
// Which scans keep their messages.
#include "host/apps/biteline-host/kept_recordings.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"

namespace biteline::service {

TEST_GROUP(KeptRecordings){
    /// Of six scans, the third and the sixth refused: k where kept.
    static std::string six(const char* words){Result<KeptRecordings> sut = KeptRecordings::parse(words);
SUCCEEDS(sut);
std::string kept;
for (int scan = 1; scan <= 6; ++scan) kept += sut->keeps(scan % 3 == 0) ? 'k' : '-';
return kept;
}  // namespace biteline::service
}
;

TEST(KeptRecordings, EachWordKeepsItsOwn) {
  STRCMP_EQUAL("------", six("none").c_str());
  STRCMP_EQUAL("kkkkkk", six("all").c_str());
  STRCMP_EQUAL("--k--k", six("refused").c_str());
  STRCMP_EQUAL("kkkkkk", six("1").c_str());
  STRCMP_EQUAL("-k-k-k", six("2").c_str());
  STRCMP_EQUAL("------", six("1000000").c_str());
}

TEST(KeptRecordings, OtherWordsAreRefused) {
  for (const char* words :
       {"", "0", "-1", "1.5", "2x", " 2", "1000001", "99999999999999999999", "ALL", "nan"}) {
    const Result<KeptRecordings> sut = KeptRecordings::parse(words);
    CHECK_TEXT(!sut, words);
    LONGS_EQUAL(Errc::InvalidArgument, sut.error().code);
  }
}

}  // namespace biteline::service
