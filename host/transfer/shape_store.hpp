// SPDX-License-Identifier: MIT
#pragma once
/// \file What is worked out of saved models once and kept beside them, so that recognition reads no clouds.

#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/transfer/align/rough_fit.hpp"
#include "host/transfer/grading.hpp"
#include "host/transfer/library.hpp"

namespace biteline::transfer {

/// Some 10 kB a model, in the library's folder `.shapes`.  Each is noted with size, time of change and number
/// of all files of its model: when one of them differs, or the note itself is damaged, the model is read and
/// checked whole and the note made anew.  A library that may not be written to works as well, only slower.
/// Thread: no state but the library's folder; several processes may work on one library.
class ShapeStore {
 public:
  explicit ShapeStore(const Library& library) : library_{library} {}

  /// Fails as Library::load() does, and when the model's sample cannot be used.
  [[nodiscard]] Result<RoughShape> shape_of(const std::string& name) const;

  /// What teach_grading() says of the two; nothing where they teach nothing.  `mirror`: they are of both
  /// feet. Fails as Library::load() does.
  [[nodiscard]] Result<std::optional<TaughtGrading>> grading_of(const std::string& sample,
                                                                const std::string& other, bool mirror) const;

 private:
  const Library& library_;
};

}  // namespace biteline::transfer
