#include "storage/sqlite/statement.h"

#include <limits>

#include <sqlite3.h>

#include "schema/base/check.h"
#include "storage/sqlite/database.h"

namespace uplink::storage::sqlite {

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

int Statement::BindAt(int index, std::int64_t value) {
  return sqlite3_bind_int64(statement_.get(), index, value);
}

int Statement::BindAt(int index, std::uint64_t value) {
  UPLINK_CHECK(value <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()),
               "a number that no column holds reached the store");
  return BindAt(index, static_cast<std::int64_t>(value));
}

int Statement::BindAt(int index, double value) {
  return sqlite3_bind_double(statement_.get(), index, value);
}

int Statement::BindAt(int index, std::string_view text) {
  // A null pointer would bind NULL, which is not an empty text.
  const char* data = text.data() == nullptr ? "" : text.data();
  return sqlite3_bind_text64(statement_.get(), index, data, text.size(), nullptr, SQLITE_UTF8);
}

int Statement::BindAt(int index, const Blob& blob) {
  if (!blob.bytes) return sqlite3_bind_null(statement_.get(), index);
  if (blob.bytes->empty()) return sqlite3_bind_zeroblob(statement_.get(), index, 0);
  return sqlite3_bind_blob64(statement_.get(), index, blob.bytes->data(), blob.bytes->size(),
                             nullptr);
}

void Statement::Reset() {
  // What the last step said is known already; reset repeats it.
  static_cast<void>(sqlite3_reset(statement_.get()));
  static_cast<void>(sqlite3_clear_bindings(statement_.get()));
  pending_code_ = 0;
}

Rows::~Rows() { statement_.Reset(); }

absl::StatusOr<bool> Rows::Next() {
  if (code_ == 0) code_ = statement_.pending_code_;
  if (code_ == 0) {
    const int step = sqlite3_step(statement_.statement_.get());
    if (step == SQLITE_ROW) return true;
    if (step == SQLITE_DONE) return false;
    code_ = step;
  }
  return statement_.database_->Error(code_, sqlite3_sql(statement_.statement_.get()));
}

absl::StatusOr<std::int64_t> Rows::OnlyInt() {
  const auto number = First([](const Rows& row) { return row.Int(0); });
  if (!number.ok()) return number.status();
  if (!number->has_value())
    return absl::InternalError("the store has lost a row that it always has");
  return **number;
}

absl::StatusOr<std::size_t> Rows::Count() {
  std::size_t count = 0;
  absl::Status status = ForEach([&count](const Rows&) { ++count; });
  if (!status.ok()) return status;
  return count;
}

std::int64_t Rows::Int(int column) const {
  return sqlite3_column_int64(statement_.statement_.get(), column);
}

double Rows::Real(int column) const {
  return sqlite3_column_double(statement_.statement_.get(), column);
}

bool Rows::Null(int column) const {
  return sqlite3_column_type(statement_.statement_.get(), column) == SQLITE_NULL;
}

std::size_t Rows::TextBytes() const {
  sqlite3_stmt* const statement = statement_.statement_.get();
  std::size_t bytes = 0;
  for (int column = 0; column < sqlite3_column_count(statement); ++column) {
    // Asking a number for its bytes would turn it into a text.
    const int type = sqlite3_column_type(statement, column);
    if (type != SQLITE_TEXT && type != SQLITE_BLOB) continue;
    bytes += static_cast<std::size_t>(sqlite3_column_bytes(statement, column));
  }
  return bytes;
}

std::string_view Rows::Bytes(int column) const {
  sqlite3_stmt* const statement = statement_.statement_.get();
  const auto* data = static_cast<const char*>(sqlite3_column_blob(statement, column));
  if (data == nullptr) return {};
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(statement, column))};
}

}  // namespace uplink::storage::sqlite
