#include "storage/postgres/link/parameters.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "schema/base/check.h"

namespace uplink::storage::postgres {
namespace {

/// Bytes before the first element: dimensions, whether there are nulls, type, length, lower bound.
constexpr std::size_t kHeaderBytes = 20;
constexpr std::size_t kDimensionsAt = 0;
constexpr std::size_t kHasNullAt = 4;
constexpr std::size_t kTypeAt = 8;
constexpr std::size_t kLengthAt = 12;
constexpr std::size_t kLowerBoundAt = 16;
/// The header of an array without elements ends before its length.
constexpr std::size_t kEmptyBytes = 12;

/// 2000-01-01 in Unix microseconds, from which timestamptz counts.
constexpr std::int64_t kEpochUs = 946'684'800'000'000;
/// The first and one past the last of a timestamptz (timestamp.h: MIN_TIMESTAMP, END_TIMESTAMP).
constexpr std::int64_t kTimeUsMin = -211'813'488'000'000'000;
constexpr std::int64_t kTimeUsEnd = 9'223'371'331'200'000'000;
constexpr std::int64_t kUsPerMs = 1000;

template <typename Unsigned>
void Append(std::string& bytes, Unsigned value) {
  for (std::size_t shift = sizeof(Unsigned) * 8; shift != 0;) {
    shift -= 8;
    bytes.push_back(static_cast<char>(static_cast<std::uint8_t>(value >> shift)));
  }
}

void PutAt(std::string& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < sizeof(value); ++i) {
    bytes[at + i] = static_cast<char>(static_cast<std::uint8_t>(value >> (24 - 8 * i)));
  }
}

std::int64_t TimestampOf(SystemTime time) {
  constexpr std::int64_t kFirstMs = (kTimeUsMin + kEpochUs) / kUsPerMs;
  // The end would not fit once the epoch is added: compared in milliseconds of its own epoch.
  constexpr std::int64_t kLastMs = (kTimeUsEnd - kUsPerMs) / kUsPerMs;
  const std::int64_t unix_ms = std::max(UnixMs(time), kFirstMs);
  constexpr std::int64_t kEpochMs = kEpochUs / kUsPerMs;
  if (unix_ms > kLastMs + kEpochMs) return kLastMs * kUsPerMs;
  return (unix_ms - kEpochMs) * kUsPerMs;
}

}  // namespace

std::string EncodeInt8(std::int64_t value) {
  std::string bytes;
  Append(bytes, static_cast<std::uint64_t>(value));
  return bytes;
}

std::string EncodeInt4(std::int32_t value) {
  std::string bytes;
  Append(bytes, static_cast<std::uint32_t>(value));
  return bytes;
}

std::string EncodeTime(SystemTime time) { return EncodeInt8(TimestampOf(time)); }

Array::Array(Type type) : bytes_(kHeaderBytes, '\0') {
  PutAt(bytes_, kTypeAt, static_cast<std::uint32_t>(type));
}

void Array::Length(std::int32_t bytes) {
  Append(bytes_, static_cast<std::uint32_t>(bytes));
  ++size_;
}

void Array::Bool(bool value) {
  Length(1);
  bytes_.push_back(value ? '\1' : '\0');
}

void Array::Int4(std::int32_t value) {
  Length(sizeof(value));
  Append(bytes_, static_cast<std::uint32_t>(value));
}

void Array::Int8(std::int64_t value) {
  Length(sizeof(value));
  Append(bytes_, static_cast<std::uint64_t>(value));
}

void Array::Float8(double value) { Int8(std::bit_cast<std::int64_t>(value)); }

void Array::Time(SystemTime value) { Int8(TimestampOf(value)); }

void Array::Bytes(std::string_view value) {
  UPLINK_CHECK(value.size() <= std::size_t{std::numeric_limits<std::int32_t>::max()},
               "a value is larger than any payload");
  Length(static_cast<std::int32_t>(value.size()));
  bytes_.append(value);
}

void Array::Null() {
  Length(-1);
  has_null_ = true;
}

std::string Array::Take() && {
  if (size_ == 0) return bytes_.substr(0, kEmptyBytes);
  PutAt(bytes_, kDimensionsAt, 1);
  PutAt(bytes_, kHasNullAt, has_null_ ? 1 : 0);
  PutAt(bytes_, kLengthAt, size_);
  PutAt(bytes_, kLowerBoundAt, 1);
  return std::move(bytes_);
}

}  // namespace uplink::storage::postgres
