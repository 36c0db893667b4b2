// SPDX-License-Identifier: MIT
#include "host/robot/link/gate/gate_file.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "host/report/report.hpp"

namespace biteline::robot {
namespace {

using nlohmann::ordered_json;

constexpr const char* k_schema = "biteline gate 1";
constexpr std::uintmax_t k_largest_bytes = 1 << 20;

// One list of the inputs for both directions: what is written is what is read.
template <class Visit>
void visit(const Visit& v, ScanFacts& scan) {
  v("name", scan.name);
  v("scan_id", scan.scan_id);
  v("recovered", scan.recovered);
  v("from_recording", scan.from_recording);
  v("one_connection", scan.one_connection);
  v("age_s", scan.age_s);
  v("messages_lost", scan.messages_lost);
  v("frames_lost_in_a_row", scan.lost.frames);
  v("profiles_lost_in_a_row", scan.lost.profiles);
  v("edges_lost_in_a_row", scan.lost.edges);
  v("sent_before", scan.sent_before);
  v.since("pictures_vouched", scan.pictures_vouched);
  v.since("stopped", scan.stopped);
}

/// What is of a look has no meaning of a clamp.
template <class Visit>
void visit(const Visit& v, Unmoved& shown) {
  v("age_s", shown.age_s);
  if (shown.by != Unmoved::By::Look) return;
  v("shift_mm", shown.shift_mm);
  v("u95_mm", shown.u95_mm);
  v("limit_mm", shown.limit_mm);
  v("same_shoe", shown.same_shoe);
}

template <class Visit>
void visit(const Visit& v, ResultFacts& result) {
  v("line_passed", result.line_passed);
  v("path_passed", result.path_passed);
  v("way_clearance_mm", result.way_clearance_mm);
  v("u95_mm", result.u95_mm);
  v("approved", result.approved);
  v("approved_by", result.approved_by);
  v("tool_off_mm", result.tool_off_mm);
  v("tool_off_rad", result.tool_off_rad);
  v("same_payload", result.same_payload);
  v.since("tip_bound_mm", result.tip_bound_mm);
  v.since("tool", result.tool);
  v.since("mounted_tool", result.mounted_tool);
  v.since("changer_trouble", result.changer_trouble);
  v.since("tip_from_taught_mm", result.tip_from_taught_mm);
  v.since("payload_as_taught", result.payload_as_taught);
  v.since("output_as_taught", result.output_as_taught);
  v.since("table_from_taught_mm", result.table_from_taught_mm);
}

template <class Visit>
void visit(const Visit& v, FilesFacts& files) {
  v.since("line_sha256", files.line.written);
  v.since("line_now_sha256", files.line.now);
  v.since("cloud_sha256", files.cloud.written);
  v.since("cloud_now_sha256", files.cloud.now);
  v.since("report_sha256", files.report.written);
  v.since("report_now_sha256", files.report.now);
  v.since("process_sha256", files.process.written);
  v.since("process_now_sha256", files.process.now);
}

template <class Visit>
void visit(const Visit& v, ArmFacts& arm) {
  v("arm", arm.arm);
  v("serial", arm.serial);
  v("told_version", arm.told_version);
  v("told_model", arm.told_model);
  v("told_serial", arm.told_serial);
  v("told_remote", arm.told_remote);
  v("q_checked_rad", arm.q_checked_rad);
  v("q_now_rad", arm.q_now_rad);
  v("held", arm.held);
  v.since("asked", arm.asked);
  v.since("pose_off_mm", arm.pose_off_mm);
  v.since("pose_off_rad", arm.pose_off_rad);
}

template <class Visit>
void visit(const Visit& v, path::GateLimits& limits) {
  v("scan_age_s", limits.scan_age_s);
  v("lost_in_a_row", limits.lost_in_a_row);
  v("start_rad", limits.start_rad);
  v("approval", limits.approval);
  v("automatic_above", limits.automatic_above);
  v("tolerance_mm", limits.tolerance_mm);
  v.since("tip_tolerance_mm", limits.tip_tolerance_mm);
}

struct Writer {
  ordered_json& out;
  /// What older files lack.
  template <class T>
  void since(const char* name, const std::optional<T>& value) const {
    if (value) out[name] = *value;
  }
  template <class T>
  void operator()(const char* name, const T& value) const {
    out[name] = value;
  }
  template <class T>
  void operator()(const char* name, const std::optional<T>& value) const {
    out[name] = value ? ordered_json(*value) : ordered_json(nullptr);
  }
  void operator()(const char* name, const kinematics::Joints& q) const {
    out[name] = std::vector<double>(q.data(), q.data() + q.size());
  }
};

/// Types as JSON has them: a number where a number is due, no conversions.  The first fault stays.
struct Reader {
  const ordered_json& in;
  std::string& fault;

  template <class T>
  void since(const char* name, std::optional<T>& value) const {
    if (in.is_object() && in.contains(name)) (*this)(name, value);
  }
  bool take(const char* name, const ordered_json*& value) const {
    const auto found = in.is_object() ? in.find(name) : in.end();
    if (!in.is_object() || found == in.end()) {
      if (fault.empty()) fault = std::string{name} + " is missing";
      return false;
    }
    value = &*found;
    return true;
  }
  void wrong(const char* name, const char* expected) const {
    if (fault.empty()) fault = std::string{name} + ": " + expected + " expected";
  }
  void operator()(const char* name, bool& value) const {
    if (const ordered_json* j = nullptr; take(name, j))
      j->is_boolean() ? void(value = *j) : wrong(name, "true or false");
  }
  void operator()(const char* name, std::string& value) const {
    if (const ordered_json* j = nullptr; take(name, j))
      j->is_string() ? void(value = *j) : wrong(name, "a text");
  }
  void operator()(const char* name, double& value) const {
    if (const ordered_json* j = nullptr; take(name, j))
      j->is_number() ? void(value = *j) : wrong(name, "a number");
  }
  void operator()(const char* name, std::uint64_t& value) const {
    if (const ordered_json* j = nullptr; take(name, j))
      j->is_number_unsigned() ? void(value = *j) : wrong(name, "a count");
  }
  void operator()(const char* name, int& value) const {
    if (const ordered_json* j = nullptr; take(name, j)) {
      const bool small = j->is_number_unsigned() && j->get<std::uint64_t>() <= 1'000'000;
      small ? void(value = *j) : wrong(name, "a count");
    }
  }
  template <class T>
  void operator()(const char* name, std::optional<T>& value) const {
    const ordered_json* j = nullptr;
    if (!take(name, j) || j->is_null()) return;
    (*this)(name, value.emplace());
  }
  void operator()(const char* name, kinematics::Joints& q) const {
    const ordered_json* j = nullptr;
    if (!take(name, j)) return;
    if (!j->is_array() || j->size() != kinematics::k_joints) return wrong(name, "six numbers");
    for (std::size_t i = 0; i < kinematics::k_joints; ++i) {
      if (!(*j)[i].is_number()) return wrong(name, "six numbers");
      q[static_cast<Eigen::Index>(i)] = (*j)[i];
    }
  }
};

template <class Facts>
ordered_json written(Facts facts) {
  ordered_json out;
  visit(Writer{out}, facts);
  return out;
}

constexpr const char* k_by_look = "look";
constexpr const char* k_by_clamp = "clamp";

ordered_json written_unmoved(const Unmoved& shown) {
  ordered_json out{{"by", shown.by == Unmoved::By::Look ? k_by_look : k_by_clamp}};
  out.update(written(shown));
  return out;
}

void read_unmoved(const Reader& reader, Unmoved& shown) {
  std::string by;
  reader("by", by);
  shown.by = by == k_by_clamp ? Unmoved::By::Clamp : Unmoved::By::Look;
  if (by != k_by_clamp && by != k_by_look) reader.wrong("by", "look or clamp");
  visit(reader, shown);
}

const char* name_of(GateRow::State state) {
  switch (state) {
    case GateRow::State::Passed:
      return "passed";
    case GateRow::State::Failed:
      return "failed";
    case GateRow::State::NotKnown:
      return "not known";
    case GateRow::State::NotLookedAt:
      return "not looked at";
  }
  return "failed";
}

ordered_json rows_of(const std::vector<GateRow>& rows) {
  ordered_json out = ordered_json::array();
  for (const GateRow& row : rows) {
    out.push_back(
        {{"name", row.name}, {"value", row.value}, {"limit", row.limit}, {"state", name_of(row.state)}});
    if (row.state == GateRow::State::Failed) {
      const auto& words = report::refusal_row(row.code);
      out.back()["reason_code"] = words.name;
      out.back()["next_step"] = words.next_step;
    }
  }
  return out;
}

}  // namespace

Result<void> write_gate(const std::filesystem::path& file, const GateInputs& inputs) {
  const std::vector<GateRow> rows = judge(inputs);
  ordered_json json{{"schema", k_schema},
                    {"permitted", passed(rows)},
                    {"rows", rows_of(rows)},
                    {"inputs",
                     {{"scan", written(inputs.scan)},
                      {"result", written(inputs.result)},
                      {"arm", written(inputs.arm)},
                      {"limits", written(inputs.limits)}}}};
  if (ordered_json files = written(inputs.files); files.is_object())
    json["inputs"]["files"] = std::move(files);
  ordered_json& word = json["inputs"]["scan"]["confirmed"];
  if (inputs.scan.confirmed) word = {{"by", inputs.scan.confirmed->by}, {"at", inputs.scan.confirmed->at}};
  if (inputs.scan.unmoved) json["inputs"]["scan"]["unmoved"] = written_unmoved(*inputs.scan.unmoved);
  return report::write_file_atomically(
      file, json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

Result<GateFile> read_gate(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return fail(Errc::FileNotFound, "%.200s", file.c_str());
  if (std::filesystem::file_size(file, error) > k_largest_bytes)
    return fail(Errc::BadFormat, "%.200s: larger than any gate's file", file.c_str());
  std::ifstream stream{file};
  const ordered_json json = ordered_json::parse(stream, nullptr, false);
  if (!json.is_object() || json.value("schema", ordered_json()) != k_schema || !json.contains("inputs") ||
      !json["inputs"].is_object() || !json.contains("permitted") || !json["permitted"].is_boolean())
    return fail(Errc::BadFormat, "%.200s: '%s' expected", file.c_str(), k_schema);
  GateFile out{.inputs = {}, .permitted = json["permitted"]};
  std::string fault;
  const ordered_json& inputs = json["inputs"];
  const auto part = [&](const char* name) -> const ordered_json& {
    static const ordered_json k_nothing;
    return inputs.contains(name) ? inputs[name] : k_nothing;
  };
  visit(Reader{part("scan"), fault}, out.inputs.scan);
  visit(Reader{part("result"), fault}, out.inputs.result);
  visit(Reader{part("arm"), fault}, out.inputs.arm);
  visit(Reader{part("limits"), fault}, out.inputs.limits);
  visit(Reader{part("files"), fault}, out.inputs.files);
  if (const ordered_json& scan = part("scan"); scan.is_object() && scan.contains("unmoved"))
    read_unmoved(Reader{scan["unmoved"], fault}, out.inputs.scan.unmoved.emplace());
  if (const ordered_json& word =
          part("scan").is_object() ? part("scan").value("confirmed", ordered_json()) : ordered_json();
      word.is_object()) {
    const Reader reader{word, fault};
    Word& confirmed = out.inputs.scan.confirmed.emplace();
    reader("by", confirmed.by);
    reader("at", confirmed.at);
  }
  if (!fault.empty()) return fail(Errc::BadFormat, "%.150s: %.80s", file.c_str(), fault.c_str());
  const std::vector<GateRow> rows = judge(out.inputs);
  if (out.permitted != passed(rows) || json.value("rows", ordered_json()) != rows_of(rows))
    return fail(Errc::BadValue, "%.150s: its words are not what its inputs give", file.c_str());
  return out;
}

}  // namespace biteline::robot
