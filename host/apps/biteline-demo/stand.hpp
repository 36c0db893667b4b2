// SPDX-License-Identifier: MIT
#pragma once
/// \file The simulated cell and its sensor as processes, and what a host service is told of them.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/apps/biteline-demo/cell_run.hpp"
#include "host/intake/child_process.hpp"

namespace biteline::demo {

/// A program that has said in one line of JSON where it listens.
struct Server {
  intake::ChildProcess child;
  nlohmann::ordered_json endpoints;
};

/// Each program dies with this one, and goes when this object goes.
struct Stand {
  Server cell;
  Server sensor;
  std::string stream;           ///< where the sensor listens: tcp://HOST:PORT
  std::filesystem::path known;  ///< uncertainty.yaml of the cell's head
};

/// `folder`: of the shoe's results; the cell's own go into `cell` there.
[[nodiscard]] Result<Stand> start_stand(const CellOptions& options, const Shoe& shoe,
                                        const std::filesystem::path& folder);

/// For a service that finds the line, plans, and sends the path to the cell's arm; results into `folder`.
[[nodiscard]] std::vector<std::string> host_arguments(const CellOptions& options, const Stand& stand,
                                                      const std::filesystem::path& folder);

}  // namespace biteline::demo
