#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include <boost/json.hpp>

namespace uplink::json {

/// Reads a JSON text with every fraction as the double nearest to it; Boost's own reader (1.81) may
/// miss that by a bit. Nothing for what is no JSON text. Pure; any thread.
[[nodiscard]] std::optional<boost::json::value> ParseExact(std::string_view text);

/// What a text that others sent is read by.
struct ReadTerms {
  /// Deepest nesting of objects and lists.
  std::size_t depth_max = 32;
  /// Where the value lives, and what is needed on the way to it.
  boost::json::storage_ptr memory;
};

/// What reading such a text found: a value unless there is an error. A value.
struct ExactReading {
  boost::json::value value;
  boost::json::error_code error;
};

/// ParseExact for texts of others. `boost::json::error` tells what is wrong. Numbers with an
/// exponent beyond reason are error::exponent_overflow, what else no double holds is infinity. Of a
/// key that stands twice the last one counts. Pure; any thread.
[[nodiscard]] ExactReading ReadExact(std::string_view text, const ReadTerms& terms);

/// `string`, `null`: what a value is, for sentences.
[[nodiscard]] std::string_view KindOf(const boost::json::value& value);

/// The number as a double; nothing for what is no number.
[[nodiscard]] std::optional<double> NumberOf(const boost::json::value& value);

}  // namespace uplink::json
