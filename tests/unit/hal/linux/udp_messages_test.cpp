// SPDX-License-Identifier: MIT
// What other makers' controllers say, read: messages of a foreign writer, of the made controllers, and
// spoilt.
#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <random>
#include <string>

#include "hal/api/pose_source.hpp"
#include "hal/linux/udp_poses/egm_message.hpp"
#include "hal/linux/udp_poses/rsi_message.hpp"
#include "hal/sim/robot/egm_stream.hpp"
#include "hal/sim/robot/rsi_exchange.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/fuzz.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr double k_tol_mm = 1e-9;
constexpr double k_tol_rad = 1e-7;      // through log and exp
constexpr double k_told_tol_mm = 2e-6;  // RSI texts have six places: half a step a coordinate
constexpr double k_told_tol_rad = 1e-7;

Bytes from_hex(std::string_view text) {
  Bytes out;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    out.push_back(static_cast<std::uint8_t>(std::stoi(std::string{text.substr(i, 2)}, nullptr, 16)));
  return out;
}

Bytes from_text(std::string_view text) {
  return {text.begin(), text.end()};
}

Result<ToldPose> read_text(const std::string& text) {
  return read_rsi(from_text(text));
}

SE3 somewhere(std::mt19937_64& random) {
  std::uniform_real_distribution<double> number{-1, 1};
  SE3 T = SE3::Identity();
  T.translation() = 900 * Vec3{number(random), number(random), number(random)};
  T.linear() = geometry::exp_so3(3 * Vec3{number(random), number(random), number(random)});
  return T;
}

/// All ten fields of an EgmRobot, joints, Euler angles and external joints too, as `protoc --encode` of
/// Protocol Buffers 3.21 wrote it from a text: 512.25, -80.5, 301.125 mm; 0.5 + 0.1 i + 0.7 j + 0.5 k; 4321 s
/// and 765000 us; message 300; RAPID running.
const Bytes k_foreign = from_hex(
    "0a0908ac0210c0c407180212ae010a3609000000000000f03f090000000000000040090000000000"
    "00084009000000000000104009000000000000144009000000000000184012600a1b090000000000"
    "0280401100000000002054c0190000000000d27240122409000000000000e03f119a9999999999b9"
    "3f19666666666666e63f21000000000000e03f1a1b09000000000000000011000000000000000019"
    "00000000008056401a09090000000000000000220708e12110c8d82e1a560a0909000000000000f0"
    "3f12430a1b09000000000000f03f1100000000000000401900000000000008401224090000000000"
    "00f03f11000000000000000019000000000000000021000000000000000022040809100922020801"
    "2a02080330013a0909000000000000f83f420208024a0909000000000000f03f5100000000000029"
    "40");

TEST_GROUP(EgmMessage){};

TEST(EgmMessage, OfAForeignWriterGivesTheMeasuredPose) {
  const Result<ToldPose> told = read_egm(k_foreign);
  SUCCEEDS(told);
  SE3 expected = SE3::Identity();
  expected.translation() = Vec3{512.25, -80.5, 301.125};
  // By hand, from the quaternion.
  expected.linear() << -0.48, -0.36, 0.8, 0.64, 0.48, 0.6, -0.6, 0.8, 0;
  TRANSFORMS_EQUAL(expected, told->T_base_flange, k_tol_mm, k_tol_rad);
  CHECK(told->stamp == RobotClock::time_point{4321s + 765ms});
  CHECK_EQUAL(300U, *told->number);
  CHECK_EQUAL(std::uint32_t{k_pose_program_running}, told->status);
}

TEST(EgmMessage, OfTheMadeControllerComesBack) {
  std::mt19937_64 random{1};
  for (const bool tells_time : {true, false}) {
    const sim::EgmStream stream = sim::EgmStream::open({.tells_measured_time = tells_time}).value();
    for (int i = 0; i < 100; ++i) {
      const SE3 T = somewhere(random);
      const Result<ToldPose> told = read_egm(stream.message(777s + 4ms * i, T, false));
      SUCCEEDS(told);
      TRANSFORMS_EQUAL(T, told->T_base_flange, k_tol_mm, k_tol_rad);
      CHECK(told->stamp == RobotClock::time_point{777s + 4ms * i});
      CHECK_EQUAL(0U, told->status);
    }
  }
}

TEST(EgmMessage, WithoutAPoseOrWithNumbersThatAreNoneIsRefused) {
  // A header alone; a pose alone, without stamp; lengths of 0.4 and 2; an answer's kind (3) in the header.
  FAILS_NAMING(Errc::BadFormat, "feedBack.cartesian", read_egm(from_hex("0a0908ac0210c0c4071802")));
  const std::string place = "0a1b09000000000000000011000000000000000019000000000000000012";
  const auto turned = [&](const char* u0) {
    return "2409" + std::string{u0} + "110000000000000000190000000000000000210000000000000000";
  };
  const auto framed = [&](const std::string& header, const std::string& turn) {
    const std::string pose = place + turn;
    const auto hex = [](std::size_t size) {
      std::array<char, 3> digits{};
      std::snprintf(digits.data(), digits.size(), "%02x", static_cast<unsigned>(size));
      return std::string{digits.data()};
    };
    const std::string feedback = "12" + hex(pose.size() / 2) + pose;
    return read_egm(from_hex(header + "12" + hex(feedback.size() / 2) + feedback));
  };
  SUCCEEDS(framed("0a0410641802", turned("000000000000f03f")));
  FAILS_NAMING(Errc::BadFormat, "header.tm", framed("", turned("000000000000f03f")));
  FAILS_NAMING(Errc::BadValue, "no pose", framed("0a0410641802", turned("9a9999999999d93f")));
  FAILS_NAMING(Errc::BadValue, "no pose", framed("0a0410641802", turned("0000000000000040")));
  FAILS_NAMING(Errc::BadValue, "no pose", framed("0a0410641802", turned("000000000000f87f")));
  FAILS_NAMING(Errc::ProtocolError, "no message", framed("0a0410641803", turned("000000000000f03f")));
  FAILS_NAMING(Errc::ProtocolError, "no message", read_egm({}));
}

TEST(EgmMessage, SpoiltOneIsRefusedOrAPose) {
  std::mt19937_64 random{2};
  int refused = 0;
  for (int i = 0; i < 20000 * test::fuzz_factor(); ++i) {
    Bytes bytes = k_foreign;
    test::garble(bytes, random);
    const Result<ToldPose> told = read_egm(bytes);
    refused += told ? 0 : 1;
    if (told) CHECK(told->T_base_flange.matrix().allFinite());
  }
  CHECK(refused > 1000);
  std::feclearexcept(FE_UNDERFLOW);  // squares of numbers next to nothing
}

const std::string k_usual =
    "<Rob Type=\"KUKA\"><RIst X=\"540.4\" Y=\"-12.5\" Z=\"915.0\" A=\"90.0\" B=\"90.0\" C=\"0.0\"/>"
    "<AIPos A1=\"0.0\" A2=\"-90.0\" A3=\"90.0\" A4=\"0.0\" A5=\"90.0\" A6=\"0.0\"/><Delay D=\"0\"/>"
    "<IPOC>4208163634</IPOC></Rob>";

TEST_GROUP(RsiMessage){};

TEST(RsiMessage, TurnsAboutZThenYThenX) {
  const Result<ToldPose> told = read_text(k_usual);
  SUCCEEDS(told);
  SE3 expected = SE3::Identity();
  expected.translation() = Vec3{540.4, -12.5, 915};
  // By hand: the tool's x is base's -z, its y is -x, its z is y.
  expected.linear() << 0, -1, 0, 0, 0, 1, -1, 0, 0;
  TRANSFORMS_EQUAL(expected, told->T_base_flange, k_tol_mm, k_tol_rad);
  CHECK(told->stamp == RobotClock::time_point{4208163634ms});
  CHECK_FALSE(told->number.has_value());
}

TEST(RsiMessage, OfTheMadeControllerComesBack) {
  std::mt19937_64 random{3};
  for (int i = 0; i < 200; ++i) {
    SE3 T = somewhere(random);
    if (i % 4 == 0)  // B at 90 degrees, where A and C turn about one line
      T.linear() = (Eigen::AngleAxisd{0.1 * i, Vec3::UnitZ()} *
                    Eigen::AngleAxisd{i % 8 == 0 ? std::acos(0.0) : -std::acos(0.0), Vec3::UnitY()})
                       .toRotationMatrix();
    const Result<ToldPose> told = read_text(sim::RsiExchange::message(1000 + i, T, 0));
    SUCCEEDS(told);
    TRANSFORMS_EQUAL(T, told->T_base_flange, k_told_tol_mm, k_told_tol_rad);
  }
}

TEST(RsiMessage, IsReadInWhateverOrderItStands) {
  SUCCEEDS(
      read_text(" <Rob TYPE='KUKA'>\r\n <IPOC> 7 </IPOC><Dio>3</Dio><Tech><C11 A='1'/></Tech>\n"
                "<RIst C = '0' B='0' A='0' Z='-1e2' Y='2' X='1' ></RIst></Rob>\n"));
  Bytes with_zeros = from_text(k_usual);
  with_zeros.resize(with_zeros.size() + 3, 0);
  SUCCEEDS(read_rsi(with_zeros));
}

TEST(RsiMessage, ThatIsNoneOfAControllersIsRefused) {
  const auto changed = [](const char* from, const char* to) {
    std::string text = k_usual;
    text.replace(text.find(from), std::string_view{from}.size(), to);
    return read_text(text);
  };
  FAILS_NAMING(Errc::BadFormat, "RIst and IPOC", changed("RIst", "RSol"));
  FAILS_NAMING(Errc::BadFormat, "RIst and IPOC", changed("<Delay D=\"0\"/><IPOC>4208163634</IPOC>", ""));
  FAILS_NAMING(Errc::BadFormat, "RIst and IPOC",
               read_text("<Rob><In><RIst X='0' Y='0' Z='0' A='0' B='0' C='0'/></In><IPOC>1</IPOC></Rob>"));
  FAILS_NAMING(Errc::BadValue, "IPOC", changed("4208163634", "-1"));
  FAILS_NAMING(Errc::BadValue, "IPOC", changed("4208163634", "99999999999999999999"));
  for (const char* number : {"nan", "inf", "1e400", "", "540,4", "1e9", "5 4"})
    FAILS_NAMING(Errc::BadValue, "RIst is no pose", changed("540.4", number));
  FAILS_NAMING(Errc::BadValue, "RIst is no pose", changed("A=\"90.0\" ", ""));
  FAILS_NAMING(Errc::BadValue, "RIst is no pose", changed("A=\"90.0\"", "A=\"361\""));
  for (const auto& [from, to] : {std::pair{"</Rob>", ""},
                                 {"</Rob>", "</Rob><Rob/>"},
                                 {"</Rob>", "</Bob>"},
                                 {"<Rob ", "<Sen "},
                                 {"<Delay", "<!-- --><Delay"},
                                 {"D=\"0\"", "D=0"},
                                 {"D=\"0\"", "D=\"0"}})
    FAILS_NAMING(Errc::ProtocolError, "no text", changed(from, to));
}

TEST(RsiMessage, SpoiltOneIsRefusedOrAPose) {
  std::mt19937_64 random{4};
  int refused = 0;
  for (int i = 0; i < 20000 * test::fuzz_factor(); ++i) {
    Bytes bytes = from_text(k_usual);
    test::garble(bytes, random);
    const Result<ToldPose> told = read_rsi(bytes);
    refused += told ? 0 : 1;
    if (told) CHECK(told->T_base_flange.matrix().allFinite());
  }
  CHECK(refused > 1000);
  std::feclearexcept(FE_UNDERFLOW);  // of numbers next to nothing
}

TEST(RsiMessage, IsAnsweredWithItsCountAndNoCorrection) {
  const RsiAnswer answer{read_text(k_usual)->stamp};
  STRCMP_EQUAL("<Sen Type=\"ImFree\"><IPOC>4208163634</IPOC></Sen>", std::string{answer.text()}.c_str());
}

}  // namespace
}  // namespace biteline::hal
