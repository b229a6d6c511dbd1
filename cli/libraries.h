// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The command is two programs of the same verbs. What is started as `slamdb` comes without Cairo, Ceres, OpenCV and
// libpq, which with all that they need take several times as long to load as the rest; the other lies under libexec and
// has them. Where the libraries are not there or linked statically, or libslamdb.so brings them, there is one program.
namespace slamdb::cli {

// What the process was started with, for the other program: the words, and a null pointer behind the last.
void RememberWords(char** words);

// For verbs that draw, solve, read pictures or name a server, before they read or write anything: the one program goes
// on as the other, with the same words. In that one nothing happens.
//
// Throws Error when the other program cannot be started.
void GoOnWithLibraries();

}  // namespace slamdb::cli
