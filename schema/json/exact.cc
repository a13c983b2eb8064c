#include "schema/json/exact.h"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>
#include <utility>

#include <boost/json/basic_parser_impl.hpp>

namespace uplink::json {
namespace {

using Text = boost::json::string_view;
using Error = boost::json::error_code;

/// Boost's events as a value. It differs from Boost's own handler in on_double alone. Names and
/// parameters are those that basic_parser calls.
class Builder final {
 public:
  static constexpr std::size_t max_object_size = boost::json::object::max_size();
  static constexpr std::size_t max_array_size = boost::json::array::max_size();
  static constexpr std::size_t max_key_size = boost::json::string::max_size();
  static constexpr std::size_t max_string_size = boost::json::string::max_size();

  explicit Builder(const boost::json::storage_ptr& memory) : stack_(memory) {
    stack_.reset(memory);
  }

  [[nodiscard]] boost::json::value Take() { return stack_.release(); }

  // NOLINTBEGIN(readability-identifier-naming): Boost calls them so
  static bool on_document_begin(Error& /*error*/) { return true; }
  static bool on_document_end(Error& /*error*/) { return true; }
  static bool on_object_begin(Error& /*error*/) { return true; }
  bool on_object_end(std::size_t members, Error& /*error*/) {
    stack_.push_object(members);
    return true;
  }
  static bool on_array_begin(Error& /*error*/) { return true; }
  bool on_array_end(std::size_t items, Error& /*error*/) {
    stack_.push_array(items);
    return true;
  }
  bool on_key_part(Text part, std::size_t /*bytes*/, Error& /*error*/) {
    stack_.push_chars(part);
    return true;
  }
  bool on_key(Text part, std::size_t /*bytes*/, Error& /*error*/) {
    stack_.push_key(part);
    return true;
  }
  bool on_string_part(Text part, std::size_t /*bytes*/, Error& /*error*/) {
    stack_.push_chars(part);
    return true;
  }
  bool on_string(Text part, std::size_t /*bytes*/, Error& /*error*/) {
    stack_.push_string(part);
    return true;
  }
  bool on_number_part(Text part, Error& /*error*/) {
    number_.append(part.data(), part.size());
    return true;
  }
  bool on_int64(std::int64_t value, Text /*part*/, Error& /*error*/) {
    number_.clear();
    stack_.push_int64(value);
    return true;
  }
  bool on_uint64(std::uint64_t value, Text /*part*/, Error& /*error*/) {
    number_.clear();
    stack_.push_uint64(value);
    return true;
  }
  bool on_double(double rough, Text part, Error& /*error*/) {
    number_.append(part.data(), part.size());
    // What no double holds stays as Boost reads it: 0, or infinity.
    double exact = rough;
    std::from_chars(number_.data(), number_.data() + number_.size(), exact);
    number_.clear();
    stack_.push_double(exact);
    return true;
  }
  bool on_bool(bool value, Error& /*error*/) {
    stack_.push_bool(value);
    return true;
  }
  bool on_null(Error& /*error*/) {
    stack_.push_null();
    return true;
  }
  static bool on_comment_part(Text /*part*/, Error& /*error*/) { return true; }
  static bool on_comment(Text /*part*/, Error& /*error*/) { return true; }
  // NOLINTEND(readability-identifier-naming)

 private:
  boost::json::value_stack stack_;
  /// The number at hand as it is written.
  std::string number_;
};

}  // namespace

std::optional<boost::json::value> ParseExact(std::string_view text) {
  ExactReading reading = ReadExact(text, {});
  if (reading.error) return std::nullopt;
  return std::move(reading.value);
}

ExactReading ReadExact(std::string_view text, const ReadTerms& terms) {
  boost::json::parse_options options;
  options.max_depth = terms.depth_max;
  boost::json::basic_parser<Builder> parser(options, terms.memory);
  Error error;
  const std::size_t read = parser.write_some(false, text.data(), text.size(), error);
  if (!error && read != text.size()) error = boost::json::error::extra_data;
  if (error) return {.value = {}, .error = error};
  return {.value = parser.handler().Take(), .error = {}};
}

std::string_view KindOf(const boost::json::value& value) {
  switch (value.kind()) {
    case boost::json::kind::null:
      return "null";
    case boost::json::kind::bool_:
      return "boolean";
    case boost::json::kind::int64:
    case boost::json::kind::uint64:
      return "integer";
    case boost::json::kind::double_:
      return "number";
    case boost::json::kind::string:
      return "string";
    case boost::json::kind::array:
      return "array";
    case boost::json::kind::object:
      return "object";
  }
  return "";
}

std::optional<double> NumberOf(const boost::json::value& value) {
  if (const auto* fraction = value.if_double()) return *fraction;
  if (const auto* whole = value.if_int64()) return static_cast<double>(*whole);
  if (const auto* whole = value.if_uint64()) return static_cast<double>(*whole);
  return std::nullopt;
}

}  // namespace uplink::json
