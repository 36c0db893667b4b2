// SPDX-License-Identifier: MIT
#include "common/wire/schema_parts.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include "common/core/numbers.hpp"
#include "common/core/text.hpp"

namespace biteline::wire {
namespace {

constexpr std::size_t k_max_text_bytes = 500;
constexpr double k_rotation_tolerance =
    1e-6;                               // far above the rounding of any rotation, far below any real fault
constexpr int k_max_sensor_px = 65536;  // columns travel as 16 bit

bool finite(const fb::Vec3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

Vec3 to_vec3(const fb::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

fb::Vec3 from_vec3(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Into the table that is being built.
template <class Counts, std::size_t N>
void add_counts(flatbuffers::FlatBufferBuilder& fbb, const Counts& counts,
                const std::array<profile::CountRow<Counts>, N>& rows) {
  for (const profile::CountRow<Counts>& row : rows)
    fbb.AddElement<std::uint64_t>(flatbuffers::FieldIndexToOffset(row.slot), counts.*row.value, 0);
}

/// A table of counts and nothing else.
template <class Table, class Counts, std::size_t N>
flatbuffers::Offset<Table> pack_counts(flatbuffers::FlatBufferBuilder& fbb, const Counts& counts,
                                       const std::array<profile::CountRow<Counts>, N>& rows) {
  const flatbuffers::uoffset_t start = fbb.StartTable();
  add_counts(fbb, counts, rows);
  return fbb.EndTable(start);
}

/// The generated tables hide what they are.
template <class Counts, class Table, std::size_t N>
void read_counts(const Table& table, const std::array<profile::CountRow<Counts>, N>& rows, Counts& counts) {
  const auto& fields = reinterpret_cast<const flatbuffers::Table&>(table);
  for (const profile::CountRow<Counts>& row : rows) {
    counts.*row.value = fields.GetField<std::uint64_t>(flatbuffers::FieldIndexToOffset(row.slot), 0);
  }
}

}  // namespace

flatbuffers::Offset<flatbuffers::String> text(flatbuffers::FlatBufferBuilder& fbb,
                                              const std::string& source) {
  return fbb.CreateString(clean_text(source, k_max_text_bytes));
}

std::string to_string(const flatbuffers::String* source) {
  if (source == nullptr) return {};
  return clean_text(source->string_view(), k_max_text_bytes);
}

bool plausible(const geometry::Region& region) {
  const auto in_range = [](int value, int minimum) { return value >= minimum && value <= k_max_sensor_px; };
  return in_range(region.offset_u_px, 0) && in_range(region.offset_v_px, 0) && in_range(region.width_px, 1) &&
         in_range(region.height_px, 1);
}

fb::Motion pack_motion(const SE3& T) {
  const Mat3 R = T.linear();
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1),
          R(1, 2), R(2, 0), R(2, 1), R(2, 2), from_vec3(T.translation())};
}

Result<SE3> read_motion(const fb::Motion& motion) {
  Mat3 R;
  R << motion.r00(), motion.r01(), motion.r02(), motion.r10(), motion.r11(), motion.r12(), motion.r20(),
      motion.r21(), motion.r22();
  if (!R.allFinite() || !is_plausible_place(motion.t()))
    return fail(Errc::ProtocolError, "pose with a number that is not finite, or farther than 100 m");
  // A rotation's entries are at most 1; checked first, so that the product below cannot overflow.
  if (R.cwiseAbs().maxCoeff() > 1 + k_rotation_tolerance ||
      (R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff() > k_rotation_tolerance ||
      R.determinant() < 0) {
    return fail(Errc::ProtocolError, "pose whose rotation is none");
  }
  SE3 T = SE3::Identity();
  T.linear() = R;
  T.translation() = to_vec3(motion.t());
  return T;
}

flatbuffers::Offset<fb::SensorModel> pack_model(flatbuffers::FlatBufferBuilder& fbb,
                                                const geometry::SensorModel& model) {
  const geometry::Camera& camera = model.camera;
  const fb::Vec3 normal = from_vec3(model.laser_plane.normal_cam);
  const fb::Motion mounting = pack_motion(model.T_flange_cam);
  const auto state = pack_camera_state(fbb, model.camera_state);
  return fb::CreateSensorModel(fbb, camera.fu_px, camera.fv_px, camera.cu_px, camera.cv_px, camera.k1,
                               camera.k2, camera.p1, camera.p2, camera.k3, &normal,
                               model.laser_plane.distance_mm, &mounting, model.region.offset_u_px,
                               model.region.offset_v_px, model.region.width_px, model.region.height_px,
                               model.pose_clock_offset.count(), model.rate_hz.value_or(0),
                               model.exposure.value_or(Nanoseconds{0}).count(), state);
}

Result<geometry::SensorModel> read_model(const fb::SensorModel& table) {
  const double numbers[] = {
      table.fu_px(),  table.fv_px(), table.cu_px(), table.cv_px(), table.k1(),
      table.k2(),     table.p1(),    table.p2(),    table.k3(),    table.plane_distance_mm(),
      table.rate_hz()};
  for (const double number : numbers) {
    if (!std::isfinite(number))
      return fail(Errc::ProtocolError, "sensor model with a number that is not finite");
  }
  if (table.plane_normal_cam() == nullptr || table.mounting() == nullptr ||
      !finite(*table.plane_normal_cam())) {
    return fail(Errc::ProtocolError, "sensor model without laser plane or mounting");
  }
  geometry::SensorModel model;
  model.camera = {.fu_px = table.fu_px(),
                  .fv_px = table.fv_px(),
                  .cu_px = table.cu_px(),
                  .cv_px = table.cv_px(),
                  .k1 = table.k1(),
                  .k2 = table.k2(),
                  .p1 = table.p1(),
                  .p2 = table.p2(),
                  .k3 = table.k3()};
  model.laser_plane = {.normal_cam = to_vec3(*table.plane_normal_cam()),
                       .distance_mm = table.plane_distance_mm()};
  BITELINE_ASSIGN(model.T_flange_cam, read_motion(*table.mounting()));
  model.region = {.offset_u_px = table.offset_u_px(),
                  .offset_v_px = table.offset_v_px(),
                  .width_px = table.width_px(),
                  .height_px = table.height_px()};
  if (!plausible(model.region)) return fail(Errc::ProtocolError, "sensor model with an impossible region");
  model.pose_clock_offset = Nanoseconds{table.pose_clock_offset_ns()};
  if (table.rate_hz() > 0) model.rate_hz = table.rate_hz();
  if (table.exposure_ns() > 0) model.exposure = Nanoseconds{table.exposure_ns()};
  BITELINE_ASSIGN(model.camera_state, read_camera_state(table.camera_state()));
  return model;
}

flatbuffers::Offset<fb::CameraState> pack_camera_state(flatbuffers::FlatBufferBuilder& fbb,
                                                       const geometry::CameraState& state) {
  if (!state.told()) return {};
  std::vector<fb::StateValue> values;
  for (std::size_t key = 0; key < geometry::k_state_keys; ++key)
    if (state.values[key]) values.emplace_back(static_cast<std::uint8_t>(key), *state.values[key]);
  const auto packed = fbb.CreateVectorOfStructs(values);
  return fb::CreateCameraState(fbb, packed, text(fbb, state.pixel_format));
}

Result<geometry::CameraState> read_camera_state(const fb::CameraState* table) {
  geometry::CameraState state;
  if (table == nullptr) return state;
  state.pixel_format = to_string(table->pixel_format());
  if (table->values() == nullptr) return state;
  for (const fb::StateValue* each : *table->values()) {
    if (each->key() >= geometry::k_state_keys) continue;
    const geometry::StateRow& row = geometry::state_table()[each->key()];
    if (!row.range.holds(each->value()))
      return fail(Errc::ProtocolError, "camera state with an impossible %s", row.name);
    state[row.key] = each->value();
  }
  return state;
}

flatbuffers::Offset<fb::Counters> pack_counters(flatbuffers::FlatBufferBuilder& fbb,
                                                const Counters& counters) {
  return pack_counts<fb::Counters>(fbb, counters, profile::k_scan_counts);
}

Counters read_counters(const fb::Counters* table) {
  Counters counters;
  if (table != nullptr) read_counts(*table, profile::k_scan_counts, counters);
  return counters;
}

flatbuffers::Offset<StageTimeVector> pack_stages(flatbuffers::FlatBufferBuilder& fbb,
                                                 const std::vector<StageTime>& stages) {
  std::vector<flatbuffers::Offset<fb::StageTime>> tables;
  for (const StageTime& stage : stages) {
    tables.push_back(fb::CreateStageTime(fbb, text(fbb, stage.name), stage.count, stage.min.count(),
                                         stage.mean.count(), stage.max.count()));
  }
  return fbb.CreateVector(tables);
}

std::vector<StageTime> read_stages(const StageTimeVector* tables) {
  std::vector<StageTime> stages;
  if (tables == nullptr) return stages;
  for (const fb::StageTime* table : *tables) {
    stages.push_back({.name = to_string(table->name()),
                      .count = table->count(),
                      .min = Nanoseconds{table->min_ns()},
                      .mean = Nanoseconds{table->mean_ns()},
                      .max = Nanoseconds{table->max_ns()}});
  }
  return stages;
}

flatbuffers::Offset<fb::Devices> pack_devices(flatbuffers::FlatBufferBuilder& fbb, const Devices& devices) {
  std::vector<flatbuffers::Offset<fb::ClockState>> clocks;
  for (const ClockState& clock : devices.clocks) {
    clocks.push_back(fb::CreateClockState(fbb, text(fbb, clock.name), clock.known, clock.offset.count(),
                                          clock.uncertainty.count(), clock.drift_ppm, clock.steps));
  }
  const auto clock_vector = fbb.CreateVector(clocks);
  flatbuffers::Offset<fb::TriggerState> trigger;
  if (devices.trigger) {
    trigger = pack_counts<fb::TriggerState>(fbb, *devices.trigger, profile::k_trigger_counts);
  }
  flatbuffers::Offset<fb::CaptureState> capture;
  if (const std::optional<CaptureState>& c = devices.capture) {
    capture = fb::CreateCaptureState(fbb, c->exposure.count(), c->exposure_changes, c->first_row_px,
                                     c->rows_px, c->row_changes, c->rate_max_hz, c->searching);
  }
  fb::DevicesBuilder table{fbb};
  add_counts<profile::DeviceCounts>(fbb, devices, profile::k_device_counts);
  table.add_clocks(clock_vector);
  table.add_trigger(trigger);
  table.add_trigger_by_software(devices.trigger_by_software);
  table.add_camera_connected(devices.camera_connected);
  table.add_temperature_known(devices.temperature_degc.has_value());
  table.add_temperature_degc(devices.temperature_degc.value_or(0));
  table.add_poses_flow(devices.poses_flow);
  table.add_realtime(devices.realtime);
  table.add_capture(capture);
  return table.Finish();
}

Result<Devices> read_devices(const fb::Devices* table) {
  Devices devices;
  if (table == nullptr) return devices;
  if (table->clocks() != nullptr) {
    for (const fb::ClockState* clock : *table->clocks()) {
      if (!std::isfinite(clock->drift_ppm()))
        return fail(Errc::ProtocolError, "clock with a drift that is not finite");
      devices.clocks.push_back({.name = to_string(clock->name()),
                                .known = clock->known(),
                                .offset = Nanoseconds{clock->offset_ns()},
                                .uncertainty = Nanoseconds{clock->uncertainty_ns()},
                                .drift_ppm = clock->drift_ppm(),
                                .steps = clock->steps()});
    }
  }
  if (const fb::TriggerState* trigger = table->trigger()) {
    read_counts(*trigger, profile::k_trigger_counts, devices.trigger.emplace());
  }
  if (table->temperature_known()) {
    if (!std::isfinite(table->temperature_degc()))
      return fail(Errc::ProtocolError, "temperature that is not finite");
    devices.temperature_degc = table->temperature_degc();
  }
  read_counts<profile::DeviceCounts>(*table, profile::k_device_counts, devices);
  devices.trigger_by_software = table->trigger_by_software();
  devices.camera_connected = table->camera_connected();
  devices.poses_flow = table->poses_flow();
  devices.realtime = table->realtime();
  if (const fb::CaptureState* capture = table->capture()) {
    if (!std::isfinite(capture->rate_max_hz()))
      return fail(Errc::ProtocolError, "frame rate that is not finite");
    devices.capture = CaptureState{.exposure = Nanoseconds{capture->exposure_ns()},
                                   .exposure_changes = capture->exposure_changes(),
                                   .first_row_px = capture->first_row_px(),
                                   .rows_px = capture->rows_px(),
                                   .row_changes = capture->row_changes(),
                                   .rate_max_hz = capture->rate_max_hz(),
                                   .searching = capture->searching()};
  }
  return devices;
}

flatbuffers::Offset<fb::UpkeepState> pack_upkeep(flatbuffers::FlatBufferBuilder& fbb,
                                                 const std::optional<UpkeepState>& upkeep) {
  if (!upkeep) return {};
  return fb::CreateUpkeepState(fbb, upkeep->starts, upkeep->boots, upkeep->run_s, upkeep->laser_s,
                               upkeep->lightings, upkeep->frames,
                               upkeep->coldest_degc && upkeep->hottest_degc, upkeep->coldest_degc.value_or(0),
                               upkeep->hottest_degc.value_or(0));
}

Result<std::optional<UpkeepState>> read_upkeep(const fb::UpkeepState* table) {
  if (table == nullptr) return std::optional<UpkeepState>{};
  for (const double duration_s : {table->run_s(), table->laser_s()}) {
    if (!std::isfinite(duration_s) || duration_s < 0)
      return fail(Errc::ProtocolError, "upkeep: a time that is none");
  }
  UpkeepState upkeep{.starts = table->starts(),
                     .boots = table->boots(),
                     .run_s = table->run_s(),
                     .laser_s = table->laser_s(),
                     .lightings = table->lightings(),
                     .frames = table->frames(),
                     .coldest_degc = {},
                     .hottest_degc = {}};
  if (table->degc_known()) {
    if (!std::isfinite(table->coldest_degc()) || !std::isfinite(table->hottest_degc()))
      return fail(Errc::ProtocolError, "upkeep: a temperature that is not finite");
    upkeep.coldest_degc = table->coldest_degc();
    upkeep.hottest_degc = table->hottest_degc();
  }
  return upkeep;
}

}  // namespace biteline::wire
