#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"

namespace uplink::storage::postgres {

/// Object ids of the types that we send: fixed for ever by pg_type.dat.
enum class Type : std::uint32_t {
  kBool = 16,
  kBytes = 17,
  kInt8 = 20,
  kInt4 = 23,
  kText = 25,
  kFloat8 = 701,
  kTime = 1184,
  kUuid = 2950,
};

// One value as the binary protocol has it: big-endian.
[[nodiscard]] std::string EncodeInt8(std::int64_t value);
[[nodiscard]] std::string EncodeInt4(std::int32_t value);
/// Microseconds since 2000; times that a timestamptz cannot hold become its first or last.
[[nodiscard]] std::string EncodeTime(SystemTime time);

/// A one-dimensional array as the binary protocol has it, filled one element at a time. One column
/// of a batch: `unnest` makes rows of them.
class Array final {
 public:
  explicit Array(Type type);

  void Bool(bool value);
  void Int4(std::int32_t value);
  void Int8(std::int64_t value);
  void Int8(std::uint64_t value) { Int8(static_cast<std::int64_t>(value)); }
  void Float8(double value);
  void Time(SystemTime value);
  void Text(std::string_view value) { Bytes(value); }
  void Bytes(std::string_view value);
  void Uuid(const model::SessionId& value) { Bytes(value.AsBytes()); }
  void Null();

  [[nodiscard]] std::size_t size() const { return size_; }
  /// The array's bytes; it must not be used afterwards.
  [[nodiscard]] std::string Take() &&;

 private:
  void Length(std::int32_t bytes);

  std::string bytes_;
  std::uint32_t size_ = 0;
  bool has_null_ = false;
};

/// The parameters of one statement, in order, all binary.
class Parameters final {
 public:
  Parameters() = default;

  void Add(Array&& array) { values_.emplace_back(std::move(array).Take()); }
  /// The array must not be used afterwards.
  void Add(Array* array) { Add(std::move(*array)); }
  void Add(std::int64_t value) { values_.emplace_back(EncodeInt8(value)); }
  void Add(std::uint64_t value) { Add(static_cast<std::int64_t>(value)); }
  void Add(std::int32_t value) { values_.emplace_back(EncodeInt4(value)); }
  void Add(SystemTime value) { values_.emplace_back(EncodeTime(value)); }
  void Add(std::string_view value) { values_.emplace_back(std::string(value)); }
  void Add(const model::SessionId& value) { Add(value.AsBytes()); }
  /// Of a process.
  void Add(const std::array<std::uint8_t, 16>& value) { Add(model::SessionId(value)); }
  void Add(std::nullopt_t /*null*/) { values_.emplace_back(std::nullopt); }

  [[nodiscard]] const std::vector<std::optional<std::string>>& values() const { return values_; }

 private:
  std::vector<std::optional<std::string>> values_;
};

}  // namespace uplink::storage::postgres
