// SPDX-License-Identifier: MIT
#include "common/core/error.hpp"

#include <array>
#include <cstring>

#include "common/core/contracts.hpp"
#include "common/core/text.hpp"

namespace biteline {
namespace {

using enum ExitStatus;

constexpr std::array k_rows{
    ErrorRow{Errc::InvalidArgument, "wrong use", "read --help", BadInput},
    ErrorRow{Errc::WrongState, "called in the wrong order", "report this as a defect", BadInput},
    ErrorRow{Errc::NotSupported, "not supported", "choose another setting or device", BadInput},
    ErrorRow{Errc::FileNotFound, "not found", "check the path", BadInput},
    ErrorRow{Errc::FileUnreadable, "cannot be read", "check the file and its permissions", BadInput},
    ErrorRow{Errc::BadFormat, "is not of the expected form", "repair or record the file again", BadInput},
    ErrorRow{Errc::BadValue, "has an impossible value", "repair or record the file again", BadInput},
    ErrorRow{Errc::UnknownKey, "has an unknown key", "remove or correct the key", BadInput},
    ErrorRow{Errc::Truncated, "ends too early", "copy or record the file again", BadInput},
    ErrorRow{Errc::SizeMismatch, "has another size than announced", "check that the files belong together",
             BadInput},
    ErrorRow{Errc::WriteFailed, "cannot be written", "check the folder and its permissions", BadInput},
    ErrorRow{Errc::DiskFull, "disk full", "free space and repeat", BadInput},
    ErrorRow{Errc::Refused, "refused", "see report.json for the reason", Refused},
    ErrorRow{Errc::NotConverged, "did not converge", "see report.json for the reason", Refused},
    ErrorRow{Errc::Degenerate, "the data do not determine the answer", "record more varied data", Refused},
    ErrorRow{Errc::OutOfReach, "out of the arm's reach", "move the shoe or the arm", Refused},
    ErrorRow{Errc::CheckFailed, "a check failed", "see report.json for the reason", Refused},
    ErrorRow{Errc::DeviceNotFound, "device not found", "run biteline doctor", Connection},
    ErrorRow{Errc::DeviceLost, "device lost", "check cable and power", Connection},
    ErrorRow{Errc::DeviceError, "device reports an error", "run biteline doctor", Connection},
    ErrorRow{Errc::Timeout, "no answer in time", "check that the peer runs", Connection},
    ErrorRow{Errc::ConnectFailed, "cannot connect", "check address and that the peer runs", Connection},
    ErrorRow{Errc::ConnectionLost, "connection lost", "check network and that the peer runs", Connection},
    ErrorRow{Errc::ProtocolError, "peer does not keep to the protocol", "check both versions", Connection},
    ErrorRow{Errc::AuthenticationFailed, "peer is not authenticated", "exchange the keys", Connection},
    ErrorRow{Errc::PeerRefused, "peer refused", "see the peer's log", Connection},
    ErrorRow{Errc::ProcessDied, "a process ended unexpectedly", "see its last line above", Connection},
    ErrorRow{Errc::NoRights, "rights for real time are missing", "run biteline doctor, or pass --rt=ignore",
             Connection},
    ErrorRow{Errc::Overrun, "deadline missed", "run biteline doctor", Connection},
    ErrorRow{Errc::PoseStale, "robot pose too old", "check the pose source", Connection},
    ErrorRow{Errc::InterlockOpen, "interlock open", "close the guard", Connection},
    ErrorRow{Errc::ContractBroken, "internal contract broken", "report this as a defect", Connection},
};

/// A text that fills its room may have been cut inside its last letter.
std::string_view without_torn_letter(std::string_view text) {
  if (text.size() + 1 < sizeof(Error::where)) return text;
  std::size_t end = text.size();
  while (end > 0 && (static_cast<unsigned char>(text[end - 1]) & 0xC0U) == 0x80U) --end;
  if (end == 0 || static_cast<unsigned char>(text[end - 1]) < 0xC0U) return text;
  const auto lead = static_cast<unsigned char>(text[end - 1]);
  const std::size_t bytes = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : 2;
  return text.size() - (end - 1) < bytes ? text.substr(0, end - 1) : text;
}

}  // namespace

std::span<const ErrorRow> error_table() {
  return k_rows;
}

const ErrorRow& error_row(Errc code) {
  for (const ErrorRow& row : k_rows) {
    if (row.code == code) return row;
  }
  BITELINE_EXPECTS(!"error code without a row");
  return k_rows.back();
}

std::string to_line(const Error& error) {
  // The one way of an error to a terminal or a page; what a file or the other side said stands in it.
  std::string line = clean_text(without_torn_letter(error.where.view()));
  if (!line.empty()) line += ": ";
  line += error_row(error.code).message;
  if (error.sys_errno != 0) line += std::string{" ("} + std::strerror(error.sys_errno) + ")";
  if (error.more_faults > 0) line += " (and " + std::to_string(error.more_faults) + " more faults)";
  return line;
}

}  // namespace biteline
