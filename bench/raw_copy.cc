// SPDX-License-Identifier: BSD-3-Clause
#include "bench/raw_copy.h"

#include <libpq-fe.h>

#include <memory>
#include <stdexcept>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/handles.h"
#include "slamdb/formats/postgresql/detail/kept_connection.h"
#include "slamdb/formats/postgresql/detail/schema.h"

namespace slamdb::bench {
namespace {

using postgresql::Connection;
using postgresql::ResultHandle;
using postgresql::Transaction;

struct FreeMemory {
  void operator()(char* bytes) const { PQfreemem(bytes); }
};

void Begin(Connection& connection, const std::string& copy, ExecStatusType expected) {
  const ResultHandle result(PQexec(connection.handle(), copy.c_str()));
  if (PQresultStatus(result.get()) != expected) throw connection.Failure(result.get(), copy);
}

void End(Connection& connection) {
  const ResultHandle result(PQgetResult(connection.handle()));
  if (PQresultStatus(result.get()) != PGRES_COMMAND_OK) throw connection.Failure(result.get(), "COPY");
  postgresql::Drain(connection.handle());
}

}  // namespace

std::vector<RawRows> CopyRawOut(const std::string& uri, bool keep) {
  const postgresql::KeptConnection kept(uri, {});
  Connection& connection = *kept;
  const Transaction transaction(connection, Transaction::Kind::kRead);
  std::vector<RawRows> tables;
  for (const postgresql::Table* table :
       {&postgresql::KeyframeTable(), &postgresql::FeaturesTable(), &postgresql::PictureTable(),
        &postgresql::WordsTable(), &postgresql::PointTable(), &postgresql::LandmarkTable()}) {
    const std::string target = table->target, name = target.substr(0, target.find(' '));
    const std::string columns = target.substr(target.find('(') + 1, target.size() - target.find('(') - 2);
    const bool is_versioned = columns.ends_with("since");
    Begin(connection,
          "COPY (SELECT " + columns + " FROM " + name + (is_versioned ? " WHERE until = 2147483647" : "") +
              ") TO STDOUT (FORMAT binary)",
          PGRES_COPY_OUT);
    RawRows& rows = tables.emplace_back(RawRows{target, {}});
    char* bytes = nullptr;
    for (int size = 0; (size = PQgetCopyData(connection.handle(), &bytes, 0)) > 0;) {
      const std::unique_ptr<char, FreeMemory> message(bytes);
      if (keep) rows.bytes.append(bytes, static_cast<std::size_t>(size));
    }
    End(connection);
  }
  return tables;
}

void CopyRawIn(const std::string& uri, const std::vector<RawRows>& tables) {
  const postgresql::KeptConnection kept(uri, {});
  Connection& connection = *kept;
  Transaction transaction(connection, Transaction::Kind::kWrite);
  connection.Execute("SET LOCAL synchronous_commit = off");
  for (const RawRows& rows : tables) {
    Begin(connection, "COPY " + rows.target + " FROM STDIN (FORMAT binary)", PGRES_COPY_IN);
    constexpr std::size_t kMessage = std::size_t{1} << 20;
    for (std::size_t at = 0; at < rows.bytes.size(); at += kMessage) {
      const auto size = static_cast<int>(std::min(kMessage, rows.bytes.size() - at));
      if (PQputCopyData(connection.handle(), &rows.bytes[at], size) != 1) throw std::runtime_error("cannot send");
    }
    if (PQputCopyEnd(connection.handle(), nullptr) != 1) throw std::runtime_error("cannot send");
    End(connection);
  }
  transaction.Commit();
}

}  // namespace slamdb::bench
