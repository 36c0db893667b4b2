// SPDX-License-Identifier: MIT
#pragma once
/// \file Marks the hot path: a function so annotated neither allocates, locks, blocks, throws nor calls the
/// system.
///
/// `void rt_step() noexcept BITELINE_RT;`  Clang 20 and later proves it (-Wfunction-effects); with other
/// compilers the ctests rt_fence (symbols of the libraries) and rt_malloc_guard stand for it.

#if defined(__clang__) && __clang_major__ >= 20
#define BITELINE_RT [[clang::nonblocking]]
#else
#define BITELINE_RT
#endif
