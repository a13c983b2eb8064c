#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace uplink::simulation {

/// What a run did, line by line: calls of the store with arguments and answers, frames out, ends of
/// streams, and the rows at the end. Its digest is the same for the same lines in the same order,
/// on every machine: two versions of the server behave alike on a seed if their digests are equal.
///
/// Thread: confined to one thread.
class Trace final {
 public:
  using Show = std::function<void(std::string_view line)>;
  /// `show` is given each line as it comes, for people; without it the digest alone is kept.
  explicit Trace(Show show = {}) : show_(std::move(show)) {}

  void Add(std::string_view line);
  [[nodiscard]] std::uint64_t digest() const { return digest_; }

 private:
  void Mix(std::uint8_t byte);

  const Show show_;
  /// FNV-1a's offset basis.
  std::uint64_t digest_ = 0xCBF2'9CE4'8422'2325;
};

}  // namespace uplink::simulation
