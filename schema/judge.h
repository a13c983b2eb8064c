#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <variant>

#include "schema/limits.h"
#include "schema/model/record.h"
#include "schema/model/rejection.h"

namespace uplink::schema {

using Verdict = std::variant<model::Record, model::Rejection>;

/// What judging one payload found. A value.
struct Judgement {
  Verdict verdict;
  /// The union member, if decoding got to it.
  std::optional<model::Variant> variant;
  /// A motion or status message that decoded, whatever the rules said of it.
  bool sign_of_life = false;
  /// Times that were taken as unknown because they were negative or from 2100 on.
  std::uint32_t times_unknown = 0;
  /// Enumerants beyond those known, kept as their number.
  std::uint32_t enumerants_unrecognized = 0;
  /// Control characters in texts of the record, which has U+FFFD in their place.
  std::uint32_t control_characters = 0;

  [[nodiscard]] const model::Record* record() const { return std::get_if<model::Record>(&verdict); }
  [[nodiscard]] const model::Rejection* rejection() const {
    return std::get_if<model::Rejection>(&verdict);
  }
};

/// Judges payloads of generation 0.1: a Record fit to keep, or the reason it is not. It copies each
/// payload once into an aligned buffer that it keeps between calls.
///
/// Units:   SI, times UTC (schema/uplink.capnp states each field).
/// Errors:  bad content is a Rejection; no input makes it throw or abort.
/// Limits:  JudgeLimits and schema/limits.h.
/// Thread:  confined to one thread; results may move to any.
class Judge final {
 public:
  explicit Judge(const JudgeLimits& limits);
  ~Judge();
  Judge(const Judge&) = delete;
  Judge& operator=(const Judge&) = delete;

  /// `payload` is one serialized UplinkMsg: standard stream framing, not packed.
  [[nodiscard]] Judgement Payload(std::span<const std::byte> payload);
  /// The union member of a payload, without decoding it. Nothing if it could not be read so far, or
  /// is larger than message_bytes_max.
  [[nodiscard]] std::optional<model::Variant> VariantOf(std::span<const std::byte> payload);
  /// Takes the memory of a record that is not used any more for later ones, so that live messages
  /// that come again and again need none.
  void Reuse(model::Record&& record);

 private:
  struct Scratch;
  /// The part behind the framing check; Cap'n Proto's exceptions end here.
  [[nodiscard]] Judgement Message(std::span<const std::byte> payload);

  JudgeLimits limits_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace uplink::schema
