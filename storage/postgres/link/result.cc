#include "storage/postgres/link/result.h"

#include <bit>
#include <charconv>
#include <cstring>

#include <libpq-fe.h>

#include "schema/base/check.h"

namespace uplink::storage::postgres {
namespace {

/// 2000-01-01 in Unix milliseconds, from which timestamptz counts its microseconds.
constexpr std::int64_t kEpochMs = 946'684'800'000;
constexpr std::int64_t kUsPerMs = 1000;

}  // namespace

void Result::Clear::operator()(pg_result* result) const { PQclear(result); }

int Result::rows() const { return PQntuples(result_.get()); }

std::string_view Result::tag() const { return PQcmdStatus(result_.get()); }

std::size_t Result::written() const {
  const std::string_view text = PQcmdTuples(result_.get());
  std::size_t count = 0;
  std::from_chars(text.data(), text.data() + text.size(), count);
  return count;
}

bool Result::Null(int row, int column) const {
  return PQgetisnull(result_.get(), row, column) != 0;
}

std::string_view Result::Bytes(int row, int column) const {
  return {PQgetvalue(result_.get(), row, column),
          static_cast<std::size_t>(PQgetlength(result_.get(), row, column))};
}

std::uint64_t Result::Unsigned(int row, int column) const {
  std::uint64_t value = 0;
  for (const char byte : Bytes(row, column)) {
    value = value << 8 | static_cast<std::uint8_t>(byte);
  }
  return value;
}

std::int64_t Result::Int(int row, int column) const {
  const std::uint64_t value = Unsigned(row, column);
  // Narrower columns keep their sign.
  if (Bytes(row, column).size() == sizeof(std::int32_t)) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
  }
  return static_cast<std::int64_t>(value);
}

double Result::Real(int row, int column) const {
  return std::bit_cast<double>(Unsigned(row, column));
}

SystemTime Result::Time(int row, int column) const {
  return FromUnixMs(static_cast<std::int64_t>(Unsigned(row, column)) / kUsPerMs + kEpochMs);
}

model::SessionId Result::Uuid(int row, int column) const {
  const auto id = model::SessionId::FromBytes(Bytes(row, column));
  UPLINK_CHECK(id.has_value(), "a uuid has 16 bytes");
  return *id;
}

std::size_t Result::RowBytes(int row) const {
  std::size_t bytes = 0;
  const int columns = PQnfields(result_.get());
  for (int column = 0; column < columns; ++column) bytes += Bytes(row, column).size();
  return bytes;
}

}  // namespace uplink::storage::postgres
