// SPDX-License-Identifier: MIT
#pragma once
/// \file What the shared library shows to other programs.

/// Everything without this word is hidden: it may change from one version to the next.
#define BITELINE_API __attribute__((visibility("default")))
