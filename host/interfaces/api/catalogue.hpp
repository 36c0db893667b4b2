// SPDX-License-Identifier: MIT
#pragma once
/// \file The models and processes that scans are worked with: of a release in force, else the cell's own.

#include <string>

#include "host/interfaces/api/process_store.hpp"
#include "host/transfer/library.hpp"

namespace biteline::api {

/// Thread: no state but the folders' names.
struct Catalogue {
  std::string release;  ///< its hash; empty: the cell's own
  transfer::Library models;
  ProcessStore processes;
};

}  // namespace biteline::api
