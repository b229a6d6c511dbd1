// SPDX-License-Identifier: BSD-3-Clause
#include <libpq-fe.h>

#include <array>
#include <memory>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/copy_rows.h"
#include "slamdb/formats/postgresql/detail/handles.h"

namespace slamdb::postgresql {
namespace {

struct FreeMemory {
  void operator()(const char* bytes) const { PQfreemem(const_cast<char*>(bytes)); }
};

// Asks the server, through a connection of its own, to end what it is doing. May fail, and then it all comes.
void Cancel(PGconn* connection) {
  PGcancel* cancel = PQgetCancel(connection);
  if (cancel == nullptr) return;
  std::array<char, 256> ignored{};
  PQcancel(cancel, ignored.data(), static_cast<int>(ignored.size()));
  PQfreeCancel(cancel);
}

}  // namespace

struct CopyReader::State {
  Connection& connection;
  std::string place;
  CopyRows rows;
  std::shared_ptr<const char> message;
  bool is_open = true;
};

CopyReader::CopyReader(Connection& connection, const std::string& sql, std::string place) {
  const std::string copy = "COPY (" + sql + ") TO STDOUT (FORMAT binary)";
  const ResultHandle result(PQexec(connection.handle(), copy.c_str()));
  if (PQresultStatus(result.get()) != PGRES_COPY_OUT) throw connection.Failure(result.get(), place);
  CopyRows rows({connection.path(), place});
  state_.reset(new State{connection, std::move(place), std::move(rows), nullptr});
}

CopyReader::~CopyReader() {
  if (!state_->is_open) return;
  Cancel(state_->connection.handle());
  Drain(state_->connection.handle());
}

// False: the copy has ended, and well.
bool CopyReader::TakeMessage() {
  char* bytes = nullptr;
  const int size = PQgetCopyData(state_->connection.handle(), &bytes, 0);
  state_->message.reset(bytes, FreeMemory());
  if (size > 0) {
    state_->rows.Take(std::as_bytes(std::span(bytes, static_cast<std::size_t>(size))));
    return true;
  }
  state_->is_open = false;
  const ResultHandle result(size == -1 ? PQgetResult(state_->connection.handle()) : nullptr);
  if (PQresultStatus(result.get()) != PGRES_COMMAND_OK) {
    const ServerError error = state_->connection.Failure(result.get(), state_->place);
    Drain(state_->connection.handle());
    throw error;
  }
  Drain(state_->connection.handle());
  state_->rows.CheckEnd();
  return false;
}

bool CopyReader::Next() {
  while (!state_->rows.Next()) {
    if (!TakeMessage()) return false;
  }
  return true;
}

Row CopyReader::row() const { return state_->rows.row(); }

std::shared_ptr<const char> CopyReader::message() const { return state_->message; }

}  // namespace slamdb::postgresql
