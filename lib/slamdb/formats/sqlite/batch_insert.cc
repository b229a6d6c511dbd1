// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/batch_insert.h"

#include <cassert>
#include <new>

#include "slamdb/base/detail/concat.h"

namespace slamdb::sqlite {
namespace {

constexpr int kMostColumns = 26;
constexpr std::size_t kMostWaiting = 4096;  // values

// ---- rows in memory as a table of SQLite: c0, c1, ... of the rows that are handed over as a pointer

constexpr const char* kModule = "slamdb_rows";

struct Rows {
  std::span<const Value> values;
  std::size_t columns;
};

struct Cursor {
  sqlite3_vtab_cursor base;
  Rows rows;
  std::size_t first;  // value of the row
};

Cursor& CursorOf(sqlite3_vtab_cursor* cursor) { return *reinterpret_cast<Cursor*>(cursor); }

int Connect(sqlite3* handle, void*, int, const char* const*, sqlite3_vtab** table, char**) {
  sqlite3_vtab_config(handle, SQLITE_VTAB_DIRECTONLY);
  const int code =
      sqlite3_declare_vtab(handle,
                           "CREATE TABLE rows (c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10, c11, c12, c13, "
                           "c14, c15, c16, c17, c18, c19, c20, c21, c22, c23, c24, c25, rows HIDDEN)");
  if (code != SQLITE_OK) return code;
  *table = new (std::nothrow) sqlite3_vtab{};
  return *table == nullptr ? SQLITE_NOMEM : SQLITE_OK;
}

int Disconnect(sqlite3_vtab* table) {
  delete table;
  return SQLITE_OK;
}

// Rows come from the pointer alone.
int BestIndex(sqlite3_vtab*, sqlite3_index_info* index) {
  for (int i = 0; i < index->nConstraint; ++i) {
    const auto& constraint = index->aConstraint[i];
    if (constraint.iColumn != kMostColumns || constraint.usable == 0) continue;
    index->aConstraintUsage[i] = {.argvIndex = 1, .omit = 1};
    return SQLITE_OK;
  }
  return SQLITE_CONSTRAINT;
}

int Open(sqlite3_vtab*, sqlite3_vtab_cursor** cursor) {
  auto* made = new (std::nothrow) Cursor{};
  if (made == nullptr) return SQLITE_NOMEM;
  *cursor = &made->base;
  return SQLITE_OK;
}

int Close(sqlite3_vtab_cursor* cursor) {
  delete &CursorOf(cursor);
  return SQLITE_OK;
}

int Filter(sqlite3_vtab_cursor* cursor, int, const char*, int, sqlite3_value** arguments) {
  const auto* rows = static_cast<const Rows*>(sqlite3_value_pointer(arguments[0], kModule));
  CursorOf(cursor).rows = rows == nullptr ? Rows{{}, 1} : *rows;
  CursorOf(cursor).first = 0;
  return SQLITE_OK;
}

int Next(sqlite3_vtab_cursor* cursor) {
  CursorOf(cursor).first += CursorOf(cursor).rows.columns;
  return SQLITE_OK;
}

int IsAtEnd(sqlite3_vtab_cursor* cursor) {
  return CursorOf(cursor).first >= CursorOf(cursor).rows.values.size() ? 1 : 0;
}

int Column(sqlite3_vtab_cursor* cursor, sqlite3_context* result, int column) {
  const Value& value = CursorOf(cursor).rows.values[CursorOf(cursor).first + static_cast<std::size_t>(column)];
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    sqlite3_result_int64(result, *integer);
  else if (const auto* real = std::get_if<double>(&value))
    sqlite3_result_double(result, *real);  // NaN becomes NULL
  else if (const auto* text = std::get_if<std::string_view>(&value))
    sqlite3_result_text64(result, text->empty() ? "" : text->data(), text->size(), SQLITE_STATIC, SQLITE_UTF8);
  else if (const auto* blob = std::get_if<Bytes>(&value))
    sqlite3_result_blob64(result, blob->empty() ? static_cast<const void*>("") : blob->data(), blob->size(),
                          SQLITE_STATIC);
  return SQLITE_OK;  // NULL is what a result is from the start
}

int RowId(sqlite3_vtab_cursor* cursor, sqlite3_int64* row) {
  *row = static_cast<sqlite3_int64>(CursorOf(cursor).first);
  return SQLITE_OK;
}

constexpr sqlite3_module kMethods = {
    .iVersion = 1,
    .xConnect = Connect,
    .xBestIndex = BestIndex,
    .xDisconnect = Disconnect,
    .xOpen = Open,
    .xClose = Close,
    .xFilter = Filter,
    .xNext = Next,
    .xEof = IsAtEnd,
    .xColumn = Column,
    .xRowid = RowId,
};

}  // namespace

BatchInsert::BatchInsert(Database& database, std::string table, std::size_t columns)
    : database_(database), table_(std::move(table)), columns_(columns) {
  assert(columns <= kMostColumns);
}

void BatchInsert::Add(std::span<const Value> row) {
  assert(row.size() == columns_);
  waiting_.insert(waiting_.end(), row.begin(), row.end());
  if (waiting_.size() > kMostWaiting) Flush();
}

void BatchInsert::Flush() {
  if (waiting_.empty()) return;
  if (!insert_) {
    std::string columns = "c0";
    for (std::size_t i = 1; i < columns_; ++i) columns += detail::Concat(", c", i);
    insert_.emplace(database_,
                    detail::Concat("INSERT OR ROLLBACK INTO ", table_, " SELECT ", columns, " FROM ", kModule, "(?1)"),
                    "table " + table_);
  }
  Rows rows{waiting_, columns_};
  insert_->BindPointer(1, &rows, kModule).Run();
  waiting_.clear();
}

void RegisterRows(sqlite3* handle) { sqlite3_create_module(handle, kModule, &kMethods, nullptr); }

}  // namespace slamdb::sqlite
