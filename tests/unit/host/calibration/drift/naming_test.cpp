// SPDX-License-Identifier: MIT
#include "host/calibration/drift/naming.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::drift {

TEST_GROUP(Naming){/// What a drift of `x` pulls where every quantity shows by itself.
                   static Sums shown(const Vector& x, double information){Sums sums;
sums.add(information* Matrix::Identity(), information* x);
return sums;
}  // namespace biteline::drift
}
;

TEST(Naming, EachQuantityNamesItsOwnPart) {
  for (int i = 0; i < k_quantities; ++i) {
    const Named sut = name(shown(Vector::Unit(i), 400), 1);
    CHECK(sut.part == k_table.at(static_cast<std::size_t>(i)).part);
    CHECK(sut.probability.at(static_cast<std::size_t>(sut.part)) > 0.99);
    DOUBLES_EQUAL(1, sut.drift[i], 0.01);
  }
}

TEST(Naming, TwoPartsThatLookAlikeAreBothNamed) {
  // Laser offset and mounting y move all that is seen alike.
  Sums sums;
  Vector direction = Vector::Zero();
  direction[5] = direction[7] = 1;
  sums.add(400 * direction * direction.transpose(), 400 * direction);
  const Named sut = name(sums, 1);
  DOUBLES_EQUAL(sut.probability[1], sut.probability[2], 0.1);
  CHECK(words_of(sut) == "laser or mounting" || words_of(sut) == "mounting or laser");
}

TEST(Naming, ScansThatScatterMoreSayLess) {
  const Vector x = 0.3 * Vector::Unit(12);
  CHECK(name(shown(x, 400), 1).probability[3] > name(shown(x, 400), 16).probability[3]);
}

TEST(Naming, TheLargestIsToldInItsUnit) {
  const Named sut = name(shown(-1.5 * Vector::Unit(12), 4e5), 1);
  STRCMP_EQUAL("clock", words_of(sut).c_str());
  STRCMP_EQUAL("pose clock -3.000 ms", largest_of(sut).c_str());
}

}  // namespace biteline::drift
