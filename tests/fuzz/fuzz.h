// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

// What each fuzzer of this folder defines: takes any bytes, returns 0, and aborts where the code under test is wrong.
// clang's libFuzzer calls it with bytes it finds; replay.cc calls it with those of files, under any compiler.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
