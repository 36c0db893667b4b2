// SPDX-License-Identifier: MIT
#include "host/records/release/manifest.hpp"

#include <CppUTest/TestHarness.h>

#include "host/records/digest/digest.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/records/release/signer.hpp"

namespace biteline::release {

TEST_GROUP(ReleaseManifest) {
  test::TemporaryFolder folder;
  const Manifest manifest{.name = "autumn-3", .sha256 = Digest{}.add("abc").hex(), .bytes = 3};
};

TEST(ReleaseManifest, ComesBackAsItWas) {
  const auto back = read_manifest(to_text(manifest));
  SUCCEEDS(back);
  STRCMP_EQUAL("autumn-3", back->name.c_str());
  STRCMP_EQUAL(manifest.sha256.c_str(), back->sha256.c_str());
  LONGS_EQUAL(3, back->bytes);
}

TEST(ReleaseManifest, HasOneReading) {
  const std::string sound = to_text(manifest);
  for (std::size_t at = 0; at < sound.size(); ++at) {
    CHECK_TEXT(!read_manifest(sound.substr(0, at)), "cut short");
  }
  for (const std::string& text :
       {sound + "x", sound + "bytes 3\n", "version 1.4\n" + sound, sound + std::string(1000, '\n'),
        std::string{"biteline-release 1\nname a/b\nsha256 "} + manifest.sha256 + "\nbytes 3\n",
        std::string{"biteline-release 1\nname a\nsha256 "} + manifest.sha256 + "\nbytes 0\n",
        std::string{"biteline-release 1\nname a\nsha256 "} + manifest.sha256 + "\nbytes 99999999999\n",
        std::string{"biteline-release 1\nname a\nsha256 XYZ\nbytes 3\n"}})
    CHECK_TEXT(!read_manifest(text), text.c_str());
}

TEST(ReleaseManifest, SignatureVouchesForThisTextByThisKey) {
  const test::Signer signer{folder.path() / "key.pem"}, other{folder.path() / "other.pem"};
  const std::string text = to_text(manifest), signature = signer.sign(text);
  SUCCEEDS(check_signature(folder.path() / "key.pem", text, signature, "it"));
  FAILS_NAMING(Errc::AuthenticationFailed, "not signed by",
               check_signature(folder.path() / "other.pem", text, signature, "it"));
  for (const std::string& wrong :
       {std::string{}, signature.substr(1), signature + "x", std::string(64, '\0')})
    FAILS_NAMING(Errc::AuthenticationFailed, "not signed by",
                 check_signature(folder.path() / "key.pem", text, wrong, "it"));
  for (std::size_t at = 0; at < text.size(); at += 7) {
    std::string changed = text;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    CHECK_TEXT(!check_signature(folder.path() / "key.pem", changed, signature, "it"), changed.c_str());
  }
  FAILS_NAMING(Errc::FileUnreadable, "ed25519",
               check_signature(folder.write("none.pem", "no key"), text, signature, "it"));
}

TEST(ReleaseManifest, FileIsTheOneThatIsNamed) {
  SUCCEEDS(check_file(folder.write("sound", "abc"), manifest));
  FAILS_NAMING(Errc::BadValue, "not the file that was signed",
               check_file(folder.write("flipped", "abd"), manifest));
  FAILS_NAMING(Errc::SizeMismatch, "3 bytes expected", check_file(folder.write("short", "ab"), manifest));
}

}  // namespace biteline::release
