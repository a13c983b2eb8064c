#pragma once

#include <optional>
#include <string_view>

#include <boost/json.hpp>

#include "schema/model/rejection.h"

namespace uplink::cyberwave {

/// What reading a payload found: a JSON object, or why it is none. A value.
struct PayloadReading {
  boost::json::value value;
  std::optional<model::Rejection> rejection;
  /// By what encloses it; 0 if nothing does, or if that is absurd.
  double enclosed_seconds = 0;
};

/// The object in a text. Nothing of it is judged but that it is one.
///
/// Errors:  text that is no UTF-8, NUL and lone surrogates are TEXT_NOT_UTF8; no JSON, NaN and
///          Infinity, an empty text and one that is too deep MALFORMED; an exponent that no number
///          has NOT_FINITE; any other value than an object TYPE_MISMATCH.
/// Limits:  kDepthMax; the caller bounds the size.
/// Thread:  pure; any thread. It may throw what the JSON library throws.
[[nodiscard]] PayloadReading ReadPayload(std::string_view text,
                                         const boost::json::storage_ptr& memory);

/// ReadPayload of what an edge's bridge passes on from a worker: JSON, or a frame around it: n (32
/// bits, low byte first), a head of n bytes (a double, an integer of 64 bits, JSON), content. A
/// frame of anything but `application/json` is MALFORMED.
///
/// Source:  the vendor's client 0.7.4; vectors of its bridge.
[[nodiscard]] PayloadReading ReadBridged(std::string_view bytes,
                                         const boost::json::storage_ptr& memory);

}  // namespace uplink::cyberwave
