#include "schema/json/object_text.h"

#include <cstddef>
#include <cstdint>

#include <boost/json/basic_parser_impl.hpp>

namespace uplink::json {
namespace {

using Text = boost::json::string_view;
using Error = boost::json::error_code;

/// Deeper than any text that a store keeps (cyberwave::kDepthMax).
constexpr std::size_t kObjectTextDepthMax = 64;

/// Takes what the parser finds, and keeps nothing.
/// Names and parameters are those that basic_parser calls.
class Looker final {
 public:
  static constexpr std::size_t max_object_size = SIZE_MAX;
  static constexpr std::size_t max_array_size = SIZE_MAX;
  static constexpr std::size_t max_key_size = SIZE_MAX;
  static constexpr std::size_t max_string_size = SIZE_MAX;

  // NOLINTBEGIN(readability-identifier-naming): Boost calls them so
  static bool on_document_begin(Error& /*error*/) { return true; }
  static bool on_document_end(Error& /*error*/) { return true; }
  static bool on_object_begin(Error& /*error*/) { return true; }
  static bool on_object_end(std::size_t /*members*/, Error& /*error*/) { return true; }
  static bool on_array_begin(Error& /*error*/) { return true; }
  static bool on_array_end(std::size_t /*items*/, Error& /*error*/) { return true; }
  static bool on_key_part(Text /*part*/, std::size_t /*bytes*/, Error& /*error*/) { return true; }
  static bool on_key(Text /*part*/, std::size_t /*bytes*/, Error& /*error*/) { return true; }
  static bool on_string_part(Text /*part*/, std::size_t /*bytes*/, Error& /*error*/) {
    return true;
  }
  static bool on_string(Text /*part*/, std::size_t /*bytes*/, Error& /*error*/) { return true; }
  static bool on_number_part(Text /*part*/, Error& /*error*/) { return true; }
  static bool on_int64(std::int64_t /*value*/, Text /*part*/, Error& /*error*/) { return true; }
  static bool on_uint64(std::uint64_t /*value*/, Text /*part*/, Error& /*error*/) { return true; }
  static bool on_double(double /*value*/, Text /*part*/, Error& /*error*/) { return true; }
  static bool on_bool(bool /*value*/, Error& /*error*/) { return true; }
  static bool on_null(Error& /*error*/) { return true; }
  static bool on_comment_part(Text /*part*/, Error& /*error*/) { return true; }
  static bool on_comment(Text /*part*/, Error& /*error*/) { return true; }
  // NOLINTEND(readability-identifier-naming)
};

}  // namespace

bool IsObjectText(std::string_view text) {
  // No blank before it: the store's own texts have none.
  if (!text.starts_with('{')) return false;
  boost::json::parse_options options;
  options.max_depth = kObjectTextDepthMax;
  boost::json::basic_parser<Looker> parser(options);
  Error error;
  const std::size_t read = parser.write_some(false, text.data(), text.size(), error);
  return !error && read == text.size();
}

}  // namespace uplink::json
