// SPDX-License-Identifier: MIT
#pragma once
/// \file Result<T>: a value, or the Error that prevented it.

#include <tl/expected.hpp>
#include <utility>

#include "common/core/error.hpp"

namespace biteline {

template <class T>
using Result = tl::expected<T, Error>;

/// `return fail(Errc::BadFormat, "%s row %d: 8 fields expected", path, row);`
template <class... Arguments>
[[nodiscard]] tl::unexpected<Error> fail(Errc code, const char* pattern, Arguments... arguments) {
  Error error{.code = code, .sys_errno = 0, .more_faults = 0, .where = {}};
  if constexpr (sizeof...(arguments) == 0) {
    error.where = FixedText<256>::copy(pattern);
  } else {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-security"
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    error.where = FixedText<256>::format(pattern, arguments...);
#pragma GCC diagnostic pop
  }
  return tl::unexpected<Error>(error);
}

/// As fail(), with the errno of the call that failed.
template <class... Arguments>
[[nodiscard]] tl::unexpected<Error> fail_errno(Errc code, int sys_errno, const char* pattern,
                                               Arguments... arguments) {
  tl::unexpected<Error> failure = fail(code, pattern, arguments...);
  failure.value().sys_errno = sys_errno;
  return failure;
}

}  // namespace biteline

#define BITELINE_CONCAT_(a, b) a##b
#define BITELINE_CONCAT(a, b) BITELINE_CONCAT_(a, b)

/// Returns the Error of `expression` (a Result) from the enclosing function, if it has one.
#define BITELINE_TRY(expression) BITELINE_TRY_(BITELINE_CONCAT(biteline_result_, __COUNTER__), expression)
#define BITELINE_TRY_(name, expression)                       \
  do {                                                        \
    if (auto&& name = (expression); !name) {                  \
      return tl::unexpected<::biteline::Error>(name.error()); \
    }                                                         \
  } while (false)

/// `BITELINE_ASSIGN(auto image, read_png(path));` declares `image`, or returns the Error.
#define BITELINE_ASSIGN(declaration, expression) \
  BITELINE_ASSIGN_(BITELINE_CONCAT(biteline_result_, __COUNTER__), declaration, expression)
#define BITELINE_ASSIGN_(name, declaration, expression)                         \
  auto name = (expression);                                                     \
  if (!name) return tl::unexpected<::biteline::Error>(std::move(name).error()); \
  declaration = std::move(*name)
