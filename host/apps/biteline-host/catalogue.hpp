// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a scan's models and processes come from: a release in force, else the cell's own.

#include <filesystem>
#include <optional>

#include "host/interfaces/api/catalogue.hpp"
#include "host/records/memory/memory.hpp"
#include "host/records/release/shelf.hpp"

namespace biteline::service {

/// The folders of one cell.
struct CatalogueFolders {
  std::filesystem::path library;            ///< of its own models
  std::filesystem::path shipped_processes;  ///< may be absent
  std::filesystem::path saved_processes;    ///< may be absent
  std::filesystem::path releases{};         ///< empty: releases are not asked for
};

/// Of a release nothing but its own: what was taught or saved at this cell waits for the next one.
[[nodiscard]] inline api::Catalogue catalogue_of(const std::optional<release::InForce>& release,
                                                 const CatalogueFolders& folders) {
  if (release)
    return {.release = release->hash,
            .models = transfer::Library{release->models},
            .processes = api::ProcessStore{release->processes, {}}};
  return {.release = {},
          .models = transfer::Library{folders.library},
          .processes = api::ProcessStore{folders.shipped_processes, folders.saved_processes}};
}

/// Now.  Errc: of release::in_force().
[[nodiscard]] inline Result<api::Catalogue> catalogue_now(const CatalogueFolders& folders) {
  std::optional<release::InForce> release;
  if (!folders.releases.empty()) {
    BITELINE_ASSIGN(release, release::in_force(folders.releases, memory::now_ms()));
  }
  return catalogue_of(release, folders);
}

}  // namespace biteline::service
