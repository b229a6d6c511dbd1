// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>

#include "bench/measure.h"

namespace slamdb::bench {

Sample Time(const std::function<void()>& work);

// Runs the work while a thread looks at the anonymous memory every millisecond; its time is not to be used.
Sample WatchMemory(const std::function<void()>& work);

// Leaves without tearing down what was read: a command that has done its work does the same.
template <class Value>
void Keep(Value&& value) {
  new Value(std::forward<Value>(value));
}

}  // namespace slamdb::bench
