#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/uplink-fleet/drone/voice.h"

namespace uplink::synthetic {

/// One row of the table.
struct SampleKind;

/// A drone's telemetry: the contract's 23 types and results of commands, by a table of them. Each
/// row, and each key of it, is a line of its own, from 0 on. Thread: confined to one thread.
class DroneSamples final {
 public:
  explicit DroneSamples(const DroneSpeech& speech);

  /// The latest sample of each line that has one, taken anew where its time has come; of what is
  /// stored only a new one, or now and then the last one again. Nothing that must be answered of a
  /// line that is `busy`; `only_live`: nothing that is stored at all.
  [[nodiscard]] std::vector<AvatarCall> Second(const std::function<bool(std::size_t)>& busy,
                                               bool only_live);
  /// A new sample of each line.
  [[nodiscard]] std::vector<AvatarCall> All();
  /// The latest sample of the first line again, which no account knows.
  [[nodiscard]] AvatarCall Again() const;
  [[nodiscard]] std::size_t lines() const { return lines_.size(); }

 private:
  struct Line {
    const SampleKind* kind = nullptr;
    std::uint32_t key = 0;
    Seeded chance;
    /// The latest sample; its number is 0 if there is none.
    AvatarCall last{};
    /// The value that a change is compared with, once something was said.
    std::string said{};
  };

  [[nodiscard]] AvatarCall Take(std::size_t line);
  void Expect(Line& line, AvatarDraft& draft);
  void ExpectChange(Line& line, AvatarDraft& draft, const boost::json::value& now);

  DroneSpeech speech_;
  std::vector<Line> lines_;
};

}  // namespace uplink::synthetic
