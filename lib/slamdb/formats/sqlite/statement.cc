// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

Statement::Statement(Database& database, std::string_view sql, std::string place)
    : database_(&database), place_(std::move(place)) {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(database.handle(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  handle_.reset(statement);
  if (code != SQLITE_OK) throw database.Failure(place_, code);
}

void Statement::Check(int code) {
  if (code != SQLITE_OK) throw database_->Failure(place_, code);
}

Statement& Statement::Bind(int index, std::int64_t value) {
  Check(sqlite3_bind_int64(handle_.get(), index, value));
  return *this;
}
Statement& Statement::Bind(int index, std::optional<std::int64_t> value) {
  return value ? Bind(index, *value) : BindNull(index);
}
Statement& Statement::BindReal(int index, double value) {
  Check(sqlite3_bind_double(handle_.get(), index, value));  // SQLite itself stores NaN as NULL
  return *this;
}
Statement& Statement::BindText(int index, std::string_view value) {
  const char* text = value.data() == nullptr ? "" : value.data();
  Check(sqlite3_bind_text64(handle_.get(), index, text, value.size(), SQLITE_STATIC, SQLITE_UTF8));
  return *this;
}
Statement& Statement::BindBlob(int index, Bytes value) {
  const void* bytes = value.empty() ? static_cast<const void*>("") : value.data();
  Check(sqlite3_bind_blob64(handle_.get(), index, bytes, value.size(), SQLITE_STATIC));
  return *this;
}
Statement& Statement::BindNull(int index) {
  Check(sqlite3_bind_null(handle_.get(), index));
  return *this;
}
Statement& Statement::BindAll(std::span<const rows::Value> values) {
  int index = 1;
  for (const rows::Value& value : values) {
    if (const auto* integer = std::get_if<std::int64_t>(&value))
      Bind(index, *integer);
    else if (const auto* real = std::get_if<double>(&value))
      BindReal(index, *real);
    else if (const auto* text = std::get_if<std::string_view>(&value))
      BindText(index, *text);
    else if (const auto* blob = std::get_if<Bytes>(&value))
      BindBlob(index, *blob);
    else
      BindNull(index);
    ++index;
  }
  return *this;
}
Statement& Statement::BindPointer(int index, void* value, const char* type) {
  Check(sqlite3_bind_pointer(handle_.get(), index, value, type, nullptr));
  return *this;
}

bool Statement::Step() {
  const int code = sqlite3_step(handle_.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) throw database_->Failure(place_, code);
  return false;
}

void Statement::Reset() { sqlite3_reset(handle_.get()); }

void Statement::Run() {
  while (Step()) {
  }
  Reset();
}

std::vector<std::int64_t> Statement::Integers() {
  std::vector<std::int64_t> integers;
  while (Step()) integers.push_back(Integer(0));
  Reset();
  return integers;
}

double Statement::Real(int column) const {
  const double value = sqlite3_column_double(handle_.get(), column);
  return value == 0 && IsNull(column) ? std::numeric_limits<double>::quiet_NaN() : value;  // 0 for NULL, too
}

std::string Statement::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(handle_.get(), column));
  return text == nullptr ? std::string()
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column)));
}

Bytes Statement::Blob(int column) const {
  const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(handle_.get(), column));
  if (bytes == nullptr) {
    if (sqlite3_errcode(database_->handle()) == SQLITE_NOMEM) throw database_->Failure(place_);
    return {};
  }
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
}

Transaction::Transaction(Database& database, Kind kind) : database_(database) {
  if (kind == Kind::kBegin) database.Execute("BEGIN");
}
Transaction::~Transaction() {
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}
void Transaction::Commit() {
  database_.Execute("COMMIT");
  open_ = false;
}

}  // namespace slamdb::sqlite
