#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::model {

/// What an update may be of that is no robot. The numbers are what stores keep.
enum class ScopeKind : std::uint8_t { kEnvironment = 0, kWorkflowRun = 1 };

/// `environment` or `workflow_run`.
[[nodiscard]] std::string_view ToText(ScopeKind kind);
/// The kind that ToText spells so, or nothing.
[[nodiscard]] std::optional<ScopeKind> ScopeKindFromText(std::string_view text);

/// Something that changed in an environment or a workflow run, which belongs to no robot. Durable.
/// Made of what was judged (cyberwave::Records). A value.
struct ScopeUpdate {
  ScopeKind scope = ScopeKind::kEnvironment;
  /// A UUID in lower case.
  std::string id;
  /// What changed; of a workflow run its status.
  std::string type;
  /// The JSON text of an object, in the sender's own form.
  std::string detail_json;
  /// The sender's clock; 0: unknown.
  std::int64_t unix_time_ms = 0;

  friend bool operator==(const ScopeUpdate&, const ScopeUpdate&) = default;
};

}  // namespace uplink::model
