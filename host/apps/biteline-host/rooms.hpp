// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a scan's models and processes come from: a release in force, else the cell's own.

#include <filesystem>
#include <optional>

#include "host/doors/api/process_store.hpp"
#include "host/records/release/shelf.hpp"
#include "host/transfer/library.hpp"

namespace biteline::service {

struct Rooms {
  transfer::Library models;
  api::ProcessStore processes;
};

/// Of a release nothing but its own: what was taught or saved at this cell waits for the next one.
[[nodiscard]] inline Rooms rooms_of(const std::optional<release::InForce>& release,
                                    const std::filesystem::path& library,
                                    const std::filesystem::path& shipped_processes,
                                    const std::filesystem::path& saved_processes) {
  if (release)
    return {.models = transfer::Library{release->models},
            .processes = api::ProcessStore{release->processes, {}}};
  return {.models = transfer::Library{library},
          .processes = api::ProcessStore{shipped_processes, saved_processes}};
}

}  // namespace biteline::service
