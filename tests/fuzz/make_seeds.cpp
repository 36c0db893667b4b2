// SPDX-License-Identifier: MIT
// fuzz_seeds DIR: small good inputs for each target, from the writers of the project itself.
#include <fstream>
#include <random>

#include "common/config/sensor_yaml.hpp"
#include "common/image/grey_image.hpp"
#include "common/mcap/writer.hpp"
#include "common/session/session.hpp"
#include "common/settings/settings.hpp"
#include "common/wire/messages.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/ply.hpp"
#include "host/fleet/messages.hpp"
#include "host/interfaces/control/messages.hpp"
#include "tests/support/made_profile.hpp"

using namespace biteline;
namespace fs = std::filesystem;

namespace {

struct Seeds {
  fs::path root;
  bool good{true};

  fs::path in(const char* target, const char* name) const {
    const fs::path folder = root / (std::string{"fuzz_"} + target);
    fs::create_directories(folder);
    return folder / name;
  }
  void keep(const Result<void>& written) { good = good && written.has_value(); }
  void bytes(const char* target, const char* name, std::string_view text) const {
    std::ofstream(in(target, name), std::ios::binary) << text;
  }
};

void clouds(Seeds& seeds) {
  cloud::PointCloud cloud;
  for (int i = 0; i < 6; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 2.5F, -1.0F);
    cloud.normals.emplace_back(Eigen::Vector3f::UnitZ());
    cloud.profile.push_back(static_cast<std::uint32_t>(i / 3));
    cloud.column.push_back(static_cast<std::uint16_t>(i));
    cloud.sigma_mm.push_back(0.02F);
    cloud.flags.push_back(0);
  }
  seeds.keep(cloud::write_cloud(seeds.in("ply", "cloud.ply"), cloud));
  std::string mesh =
      "ply\nformat binary_little_endian 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  for (const Eigen::Vector3f& point : cloud.points)
    mesh.append(reinterpret_cast<const char*>(point.data()), 3 * sizeof(float));
  seeds.bytes("ply", "mesh.ply", mesh + std::string{"\3\0\0\0\0\1\0\0\0\2\0\0\0", 13});
  seeds.bytes(
      "ply", "ascii.ply",
      "ply\nformat ascii 1.0\ncomment x\nelement vertex 2\nproperty double x\nproperty float y\nproperty int "
      "z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n4 5e1 6\n3 0 1 0\n");
}

/// The digit in front chooses the reader.
void other_clouds(Seeds& seeds) {
  seeds.bytes("clouds", "comma", "0sep=;\r\n;X [mm];Y [mm];Z [mm]\r\n1;1,5;2,5;3,5\r\n2;4,5;\"5,5\";\r\n");
  seeds.bytes("clouds", "fortran", "0! made\n2\n 1.0D+01 -2.5D-02 1.#QNAN\n 4.0D+00 5.0D+00 6.0D+00\n");
  seeds.bytes("clouds", "index", "0,0,1,2\n0,1.5,2.5,3.5\n1,4.5,,6.5\n");
  seeds.bytes(
      "clouds", "pcd",
      "1# .PCD\nVERSION .7\nFIELDS x y z n\nSIZE 4 4 8 2\nTYPE F F F I\nCOUNT 1 1 1 2\nWIDTH 2\nHEIGHT 1\n"
      "DATA ascii\n1 2 3 4 5\nnan 5 6 7 8\n");
  seeds.bytes(
      "clouds", "stl",
      "2 solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 nan\nendloop\n"
      "endfacet\nendsolid\n");
  seeds.bytes("clouds", "binary_stl",
              "2" + std::string(80, ' ') + std::string("\1\0\0\0", 4) + std::string(50, '\0'));
  seeds.bytes("clouds", "obj", "3f 1 2 \\\n 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 nan\nf -1//1 -2 -3\n");
  seeds.bytes(
      "clouds", "ply",
      "4ply\rformat ascii 1.0\relement tristrips 1\rproperty list int int vertex_indices\relement vertex 4\r"
      "property int64 t\rproperty float X\rproperty float Y\rproperty float Z\rend header\r6 0 1 2 -1 2 3\r"
      "9 0 0 0\r9 1 0 0\r9 1 1 1.#IND\r9 0 1 0\r");
}

void tables(Seeds& seeds) {
  cloud::ClosedLine line;
  std::vector<session::StampedPose> poses;
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.157 * i;
    const Vec3 outward{std::cos(angle), std::sin(angle), 0};
    line.points.push_back({.position = 40 * outward,
                           .normal = outward,
                           .tangent = Vec3::UnitZ().cross(outward),
                           .confidence = 0.9});
    poses.push_back(
        {.stamp = RobotClock::time_point{Nanoseconds{1000 * i}}, .T_base_flange = SE3::Identity()});
  }
  seeds.keep(cloud::write_line(seeds.in("tables", "line.csv"), line));
  poses.resize(4);
  seeds.keep(session::write_pose_table(seeds.in("tables", "poses.csv"), poses));
  seeds.bytes("tables", "encoder.csv", std::string{session::k_encoder_table_head} + "0,-5\n1000,7\n3000,9\n");
}

void messages(Seeds& seeds) {
  wire::Health health;
  health.stages = {{.name = "peaks"}};
  health.devices.clocks = {{.name = "camera"}};
  health.devices.trigger.emplace();
  health.devices.capture.emplace();
  wire::SensorHello hello;
  hello.name = "sensor";
  hello.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 64, .height_px = 64};
  wire::EndOfScan end;
  end.errc = 208;
  end.where = "disk";
  wire::ObserverHello observer;
  observer.name = "observer";
  wire::Picture picture;
  picture.region = {.width_px = 2, .height_px = 1};
  picture.pixels = {1, 2};
  const wire::Body bodies[] = {wire::HostHello{.name = "host"},
                               hello,
                               test::made_profile(1, 3),
                               health,
                               end,
                               wire::Ack{},
                               wire::Control{},
                               wire::ControlReply{},
                               wire::Gap{.first = 1, .count = 2},
                               wire::Bye{},
                               observer,
                               picture};
  int number = 0;
  for (const wire::Body& body : bodies) {
    wire::Bytes packet;
    wire::encode({.scan_id = 7, .sequence = 3, .body = body}, packet);
    seeds.bytes("wire", ("message" + std::to_string(number++)).c_str(),
                {reinterpret_cast<const char*>(packet.data()), packet.size()});
  }
}

Result<void> recording(const fs::path& file, mcap::Compression compression) {
  fs::remove(file);
  BITELINE_ASSIGN(
      mcap::Writer writer,
      mcap::Writer::create(file, {.library = "fuzz", .compression = compression, .chunk_bytes = 90}));
  BITELINE_ASSIGN(const std::uint16_t schema, writer.add_schema("s", "jsonschema", "{}"));
  BITELINE_ASSIGN(const std::uint16_t channel, writer.add_channel(schema, "/t", "json", {{"k", "v"}}));
  const std::vector<std::uint8_t> data(20, 'x');
  for (std::uint32_t i = 0; i < 4; ++i)
    BITELINE_TRY(writer.write({.channel_id = channel, .sequence = i, .log_time_ns = i, .data = data}));
  BITELINE_TRY(writer.attach({.name = "a", .media_type = "text", .data = data}));
  BITELINE_TRY(writer.add_metadata({.name = "m", .values = {{"k", "v"}}}));
  BITELINE_TRY(writer.close());
  return {};
}

/// The first byte tells tests/fuzz/doors.cpp which words these are.
void doors(const Seeds& seeds) {
  const auto keep = [&](const char* name, char kind, const std::string& text) {
    seeds.bytes("doors", name, kind + text);
  };
  control::Request request{.id = 7, .token = "t", .local = true, .door = "web", .method = "POST"};
  request.path = "/api/v1/scans/scan-0003/accept";
  request.query = {{"a", "b"}};
  request.body = {{"x", {1, 2.5, "y"}}};
  keep("request", 0, control::to_text(request));
  keep("hello", 0, control::to_text(control::Hello{.door = "web"}));
  keep("answer", 1, control::to_text(control::refusal(404, "no_such_scan", "no scan of this name")));
  fleet::ShoeMessage shoe{.book = "b", .seq = 2, .after = 1, .scan = {}, .places = memory::Places{}};
  shoe.scan.name = "scan-0001";
  shoe.scan.length_mm = 628.5;
  keep("shoe", 2, fleet::to_text(shoe));
  keep("health", 3, fleet::to_text(fleet::HealthMessage{.online = true, .version = "1", .book = "b"}));
  keep("committed", 4, fleet::to_text(fleet::CommittedMessage{.book = "b", .seq = 3}));
  keep("line", 6, "JOB 2\nSTART 7\nSTATE\n");
  using namespace std::string_literals;
  keep("modbus", 7, "\0\1\0\0\0\6\1\6\0\1\0\7"s + "\0\2\0\0\0\6\1\4\0\0\0\14"s);
}

/// The first byte chooses the reader: even EGM, odd RSI.
void udp_poses(const Seeds& seeds) {
  using namespace std::string_literals;
  seeds.bytes(
      "udp_poses", "rsi",
      "\1<Rob Type=\"KUKA\"><RIst X=\"540.4\" Y=\"-12.5\" Z=\"915.0\" A=\"90.0\" B=\"0.5\" C=\"-7.0\"/>"
      "<Delay D=\"0\"/><IPOC>4208163634</IPOC></Rob>");
  const auto number = [](char field, double value) {
    return std::string{field} + std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const std::string place = number(9, 400) + number(17, -20) + number(25, 300);
  const std::string turn = number(9, 1) + number(17, 0) + number(25, 0) + number(33, 0);
  const auto message = [](char field, const std::string& bytes) {
    return std::string{field, static_cast<char>(bytes.size())} + bytes;
  };
  const std::string feedback =
      message(18, message(10, place) + message(18, turn)) + message(34, "\10\11\20\7");
  seeds.bytes("udp_poses", "egm",
              "\0"s + message(10, "\10\3\20\100\30\2") + message(18, feedback) + message(66, "\10\2"));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  Seeds seeds{.root = argv[1]};
  clouds(seeds);
  other_clouds(seeds);
  tables(seeds);
  messages(seeds);
  doors(seeds);
  udp_poses(seeds);
  seeds.keep(recording(seeds.in("mcap", "stored.mcap"), mcap::Compression::None));
  seeds.keep(recording(seeds.in("mcap", "packed.mcap"), mcap::Compression::Zstd));
  geometry::SensorModel sensor;
  sensor.camera = {.fu_px = 1000, .fv_px = 1000, .cu_px = 16, .cv_px = 8};
  sensor.laser_plane = {.normal_cam = Vec3(0, 0.6, -0.8), .distance_mm = -100};
  sensor.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 32, .height_px = 24};
  seeds.bytes("settings", "sensor.yaml", config::sensor_yaml_text(sensor, "made"));
  settings::SettingsSet set;
  set.set(settings::Key::ExposureUs, {.number = 400});
  set.set(settings::Key::AutoExposure, {.on = true});
  set.set(settings::Key::PeakChoice, {.word = "first"});
  seeds.bytes("settings", "set.yaml", settings::settings_text(set));
  for (const auto& entry : fs::directory_iterator(BITELINE_PROCESSES))
    fs::copy_file(entry.path(), seeds.in("settings", entry.path().filename().c_str()),
                  fs::copy_options::overwrite_existing);
  std::vector<std::uint8_t> pixels(16 * 12);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * 7);
  seeds.keep(
      image::write_png(seeds.in("picture", "grey.png"), {.width_px = 16, .height_px = 12, .pixels = pixels}));
  std::mt19937 random{3};
  for (const char* target : {"arm_link", "canpose", "controller", "gige", "link", "packing", "stripe",
                             "surface", "text", "udp_poses"}) {
    std::string noise(600, '\0');
    for (char& byte : noise) byte = static_cast<char>(random());
    seeds.bytes(target, "noise", noise);
  }
  return seeds.good ? 0 : 1;
}
