// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <thread>

// Letting go of the GIL, and taking it back in threads that may outlive the interpreter.
namespace slamdb::python {

// A daemon thread that asks for the GIL of an interpreter that is finalizing is ended by CPython before 3.14 with
// pthread_exit, which unwinds its stack and ends the process with std::terminate at the first destructor. In a scope of
// this class that unwinding stops, and the thread sleeps until the process ends, as CPython 3.14 has it.
class Parking {
 public:
  Parking() = default;
  ~Parking() {
    while (is_armed_) std::this_thread::sleep_for(std::chrono::hours(1));
  }
  Parking(const Parking&) = delete;
  Parking& operator=(const Parking&) = delete;
  void Disarm() { is_armed_ = false; }

 private:
  bool is_armed_ = true;
};

// `call()`, which may ask for the GIL, and must not throw.
template <class Call>
auto Parkable(const Call& call) {
  Parking parking;
  auto result = call();
  parking.Disarm();
  return result;
}

// As PyEval_RestoreThread. No destructor may do it itself: unwinding ends the process before a scope in it is left.
void TakeGilBack(PyThreadState* state);

// Without the GIL for as long as it lives.
class Unlocked {
 public:
  Unlocked() : state_(PyEval_SaveThread()) {}
  ~Unlocked() { TakeGilBack(state_); }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

// `work()` without the GIL.
template <class Work>
auto WithoutGil(const Work& work) {
  const Unlocked unlocked;
  return work();
}

// Throws what a signal handler raises, KeyboardInterrupt for Ctrl-C. With the GIL held; handlers run in the main thread
// alone.
inline void ThrowIfInterrupted() {
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

}  // namespace slamdb::python
