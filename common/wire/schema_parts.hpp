// SPDX-License-Identifier: MIT
#pragma once
/// \file Parts that several messages share, to and from the generated schema code.  Private to common/wire.

#include <string>
#include <vector>

#include "common/wire/messages.hpp"
#include "common/wire/protocol_generated.h"

namespace biteline::wire {

/// Cut at 500 bytes.
[[nodiscard]] flatbuffers::Offset<flatbuffers::String> text(flatbuffers::FlatBufferBuilder& fbb,
                                                            const std::string& source);
/// Empty when absent; cut at 500 bytes; control characters become '?', since it may end on a terminal.
[[nodiscard]] std::string to_string(const flatbuffers::String* source);

/// Of a sensor of at most 65536 x 65536 pixels, and not empty.
[[nodiscard]] bool plausible(const geometry::Region& region);

[[nodiscard]] fb::Motion pack_motion(const SE3& T);
/// Finite, and a rotation to 1e-6; made exactly orthonormal by nobody: the bits stay.
[[nodiscard]] Result<SE3> read_motion(const fb::Motion& motion);

[[nodiscard]] flatbuffers::Offset<fb::SensorModel> pack_model(flatbuffers::FlatBufferBuilder& fbb,
                                                              const geometry::SensorModel& model);
[[nodiscard]] Result<geometry::SensorModel> read_model(const fb::SensorModel& table);

[[nodiscard]] flatbuffers::Offset<fb::CameraState> pack_camera_state(flatbuffers::FlatBufferBuilder& fbb,
                                                                     const geometry::CameraState& state);
/// Nothing told when absent: an older sensor.
[[nodiscard]] Result<geometry::CameraState> read_camera_state(const fb::CameraState* table);

[[nodiscard]] flatbuffers::Offset<fb::Counters> pack_counters(flatbuffers::FlatBufferBuilder& fbb,
                                                              const Counters& counters);
/// All zero when absent.
[[nodiscard]] Counters read_counters(const fb::Counters* table);

using StageTimeVector = flatbuffers::Vector<flatbuffers::Offset<fb::StageTime>>;
[[nodiscard]] flatbuffers::Offset<StageTimeVector> pack_stages(flatbuffers::FlatBufferBuilder& fbb,
                                                               const std::vector<StageTime>& stages);
[[nodiscard]] std::vector<StageTime> read_stages(const StageTimeVector* tables);

[[nodiscard]] flatbuffers::Offset<fb::Devices> pack_devices(flatbuffers::FlatBufferBuilder& fbb,
                                                            const Devices& devices);
/// All unknown when absent: an older sensor.
[[nodiscard]] Result<Devices> read_devices(const fb::Devices* table);

[[nodiscard]] flatbuffers::Offset<fb::UpkeepState> pack_upkeep(flatbuffers::FlatBufferBuilder& fbb,
                                                               const std::optional<UpkeepState>& upkeep);
[[nodiscard]] Result<std::optional<UpkeepState>> read_upkeep(const fb::UpkeepState* table);

}  // namespace biteline::wire
