#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/cyberwave/topic_kinds.h"
#include "schema/model/cyberwave/head.h"
#include "schema/model/cyberwave/observed.h"
#include "server/cyberwave/held.h"

namespace uplink::cyberwave {

inline constexpr std::size_t kTopicKinds = static_cast<std::size_t>(TopicKind::kOther) + 1;

/// The head of the last command, and its receiver's answer. The command's content is not kept. A
/// value.
struct LastCommand {
  TopicKind topic = TopicKind::kCommand;
  model::cyberwave::CommandHead head;
  model::cyberwave::Source source;
  Stamp stamp;
};

/// Frames that are counted, not read. A value.
struct MediaCount {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
};

/// Messages of a twin's robot that are counted, not kept. A value.
class ObservedCounts final {
 public:
  void Count(TopicKind kind) { ++observed_[Index(kind)]; }
  void CountSetpoints(std::size_t setpoints) { setpoints_ += setpoints; }
  void CountMedia(TopicKind kind, std::size_t bytes);
  /// A command becomes the last one; an answer is noted with the last one if their topics agree.
  void Take(TopicKind kind, const model::cyberwave::CommandHead& head,
            const model::cyberwave::Source& source, const Stamp& stamp);

  [[nodiscard]] std::uint64_t observed(TopicKind kind) const { return observed_[Index(kind)]; }
  [[nodiscard]] MediaCount media(TopicKind kind) const;
  /// Setpoints of joints, in messages of any source.
  [[nodiscard]] std::uint64_t setpoints() const { return setpoints_; }
  [[nodiscard]] const std::optional<LastCommand>& last_command() const { return last_command_; }

 private:
  static std::size_t Index(TopicKind kind) { return static_cast<std::size_t>(kind); }

  std::array<std::uint64_t, kTopicKinds> observed_{};
  MediaCount depth_;
  MediaCount pointcloud_;
  std::uint64_t setpoints_ = 0;
  std::optional<LastCommand> last_command_;
};

}  // namespace uplink::cyberwave
