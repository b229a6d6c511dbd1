// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/visit_rows.h"

#include <exception>
#include <limits>

namespace slamdb::sqlite {
namespace {

constexpr const char* kFunction = "slamdb_visit";

struct Visitor {
  const std::function<void(const Row&)>& visit;
  std::exception_ptr failure;  // SQLite, which calls, knows no exceptions
};

void VisitRow(sqlite3_context* context, int, sqlite3_value** arguments) {
  auto* visitor = static_cast<Visitor*>(sqlite3_value_pointer(arguments[0], kFunction));
  if (visitor == nullptr) return;
  try {
    visitor->visit(Row(arguments + 1));
  } catch (...) {
    visitor->failure = std::current_exception();
    sqlite3_result_error_code(context, SQLITE_ABORT);
  }
}

}  // namespace

double Row::Real(int column) const {
  const double value = sqlite3_value_double(columns_[column]);
  return value == 0 && IsNull(column) ? std::numeric_limits<double>::quiet_NaN() : value;  // 0 for NULL, too
}

std::string_view Row::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_value_text(columns_[column]));
  if (text == nullptr) return {};
  return {text, static_cast<std::size_t>(sqlite3_value_bytes(columns_[column]))};
}

Bytes Row::Blob(int column) const {
  const auto* bytes = static_cast<const std::byte*>(sqlite3_value_blob(columns_[column]));
  if (bytes == nullptr) return {};
  return {bytes, static_cast<std::size_t>(sqlite3_value_bytes(columns_[column]))};
}

void VisitRows(Statement& select, const std::function<void(const Row&)>& visit) {
  Visitor visitor{visit, nullptr};
  select.BindPointer(1, &visitor, kFunction);
  try {
    select.Run();
  } catch (const Error&) {
    if (visitor.failure) std::rethrow_exception(visitor.failure);
    throw;
  }
}

void RegisterVisit(sqlite3* handle) {
  sqlite3_create_function_v2(
      handle, kFunction, -1, SQLITE_UTF8 | SQLITE_DIRECTONLY, nullptr, nullptr, VisitRow, [](sqlite3_context*) {},
      nullptr);
}

}  // namespace slamdb::sqlite
