// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/encode.h"

namespace slamdb::postgresql {

// Inserts rows into a table, the quickest way there is (COPY ... FROM STDIN, binary). Nothing else can be done on the
// connection before it is finished. A destructor without Finish() takes all of it back, and the transaction with it.
//
//   CopyIn copy(connection, "link (atlas, ids)", {Type::kInt8, Type::kInt8Array});
//   copy.Begin(); copy.Put(atlas); copy.Put(ids); copy.End();
//   copy.Finish();
class CopyIn {
 public:
  enum class Way {
    kStraight,
    // By way of a temporary table, out of which Finish() inserts them: for tables on another server, to which COPY
    // sends row by row before PostgreSQL 16, and INSERT many at once. Inside a transaction only.
    kInBatches,
  };
  // `target` is `table (column, ...)`; `types` those of the columns. Where row-level security counts, which COPY does
  // not know, rows go through a temporary table, too.
  CopyIn(Connection& connection, const std::string& target, std::vector<Type> types, Way way = Way::kStraight);
  ~CopyIn();
  CopyIn(const CopyIn&) = delete;
  CopyIn& operator=(const CopyIn&) = delete;

  // A row, column by column; what does not go with its column throws Error, see RowEncoder.
  void Begin() { encoder_.Begin(); }
  void Put(const Value& value) { encoder_.Put(value); }
  void PutNull() { encoder_.PutNull(); }
  void PutReal32(float value) { encoder_.PutReal32(value); }
  void Put(std::span<const std::int64_t> values) { encoder_.Put(values); }
  void Put(std::span<const std::int32_t> values) { encoder_.Put(values); }
  void End() {
    encoder_.End();
    SendIfMuch();
  }
  // All columns of a row at once.
  void Add(std::span<const Value> row) {
    encoder_.Add(row);
    SendIfMuch();
  }

  // To be called after the last row. Gives how many the server has taken: all, or it throws.
  std::int64_t Finish();

 private:
  static constexpr std::size_t kBuffered = std::size_t{1} << 20;
  void SendIfMuch() {
    if (encoder_.bytes().size() >= kBuffered) Send();
  }
  void Send();
  [[noreturn]] void ThrowFailure();

  Connection& connection_;
  std::string target_, place_;
  bool is_staged_ = false;
  RowEncoder encoder_;
  bool is_open_ = false;
};

}  // namespace slamdb::postgresql
