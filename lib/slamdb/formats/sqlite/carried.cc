// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/carried.h"

#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/model/detail/record.h"

namespace slamdb::sqlite {

CarriedWriter::CarriedWriter(Database& database, CarriedKind kind)
    : insert_(database, "INSERT INTO carried VALUES (?1, ?2, ?3)", "table carried"),
      remove_(database, "DELETE FROM carried WHERE kind = ?1 AND row = ?2", "table carried"),
      kind_(static_cast<std::int64_t>(kind)) {}

void CarriedWriter::Write(std::int64_t row, const Boxed<Carried>& carried) {
  if (!carried) return;
  bytes_.Clear();
  detail::EncodeCarried(carried, bytes_);
  insert_.Bind(1, kind_).Bind(2, row).BindBlob(3, bytes_.bytes()).Run();
}

void CarriedWriter::Remove(std::int64_t row) { remove_.Bind(1, kind_).Bind(2, row).Run(); }

void DeleteCarried(Database& database, CarriedKind kind, std::int64_t first, std::int64_t last) {
  Statement remove(database, "DELETE FROM carried WHERE kind = ?1 AND row BETWEEN ?2 AND ?3", "table carried");
  remove.Bind(1, static_cast<std::int64_t>(kind)).Bind(2, first).Bind(3, last).Run();
}

CarriedReader::CarriedReader(Database& database, CarriedKind kind)
    : database_(database), kind_(static_cast<std::int64_t>(kind)) {
  if (VersionOf(database) >= kFirstVersionWithCarried)
    select_.emplace(database, "SELECT row, bytes FROM carried WHERE kind = ?1 AND row BETWEEN ?2 AND ?3 ORDER BY row",
                    "table carried");
}

void CarriedReader::Start(std::int64_t first, std::int64_t last) {
  if (!select_) return;
  select_->Reset();
  has_row_ = select_->Bind(1, kind_).Bind(2, first).Bind(3, last).Step();
}

void CarriedReader::Read(std::int64_t row, Boxed<Carried>& carried) {
  while (has_row_ && select_->Integer(0) < row) has_row_ = select_->Step();
  if (!has_row_ || select_->Integer(0) != row) return;
  try {
    carried = detail::DecodeCarried(select_->Blob(1));
  } catch (const Error& error) {
    throw Error(error.kind(), database_.path(), PlaceOf("carried", row), error.problem() + ": the store is damaged");
  }
}

Boxed<Carried> LoadCarried(Database& database, CarriedKind kind, std::int64_t row) {
  Boxed<Carried> carried;
  CarriedReader reader(database, kind);
  reader.Start(row, row);
  reader.Read(row, carried);
  return carried;
}

}  // namespace slamdb::sqlite
