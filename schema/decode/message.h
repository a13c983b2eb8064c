#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <type_traits>

#include <capnp/message.h>
#include <capnp/serialize.h>
#include <kj/exception.h>

/// From bytes to a reader, for everything that comes in standard stream framing.
namespace uplink::schema {

inline constexpr std::size_t kWordBytes = sizeof(capnp::word);

/// Why the segment table does not describe exactly these bytes; empty if it does. Only then are the
/// bytes worth a copy, and Cap'n Proto has nothing left to misread before the root pointer.
[[nodiscard]] std::string_view FramingError(std::span<const std::byte> bytes);

/// Bounds of reading a message of so many words (limits.h).
[[nodiscard]] capnp::ReaderOptions OptionsFor(std::size_t words);

/// Opens a message whose framing is good and gives what `read` makes of its reader. What Cap'n
/// Proto throws meanwhile ends here, and `fail` says what becomes of it. A template, since a body
/// is moved as little as can be: it is large.
template <typename Read, typename Fail>
[[nodiscard]] std::invoke_result_t<Read, capnp::FlatArrayMessageReader&> ReadMessage(
    kj::ArrayPtr<const capnp::word> words, Read read, Fail fail) {
  try {
    capnp::FlatArrayMessageReader reader(words, OptionsFor(words.size()));
    return read(reader);
  } catch (const kj::Exception& exception) {
    const kj::StringPtr why = exception.getDescription();
    return fail(std::string_view(why.begin(), why.size()));
  }
}

}  // namespace uplink::schema
