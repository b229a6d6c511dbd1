// SPDX-License-Identifier: BSD-3-Clause
// Which sanitizers this is compiled with: g++ defines macros, clang has features.
#pragma once

#ifdef __has_feature
#define SLAMDB_HAS_FEATURE(feature) __has_feature(feature)
#else
#define SLAMDB_HAS_FEATURE(feature) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || SLAMDB_HAS_FEATURE(address_sanitizer)
#define SLAMDB_ADDRESS_SANITIZER 1
#else
#define SLAMDB_ADDRESS_SANITIZER 0
#endif

#if defined(__SANITIZE_THREAD__) || SLAMDB_HAS_FEATURE(thread_sanitizer)
#define SLAMDB_THREAD_SANITIZER 1
#else
#define SLAMDB_THREAD_SANITIZER 0
#endif
