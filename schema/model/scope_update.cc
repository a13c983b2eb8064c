#include "schema/model/scope_update.h"

#include "schema/base/check.h"

namespace uplink::model {

std::string_view ToText(ScopeKind kind) {
  switch (kind) {
    case ScopeKind::kEnvironment:
      return "environment";
    case ScopeKind::kWorkflowRun:
      return "workflow_run";
  }
  CheckFailed(__FILE__, __LINE__, "scope", "a scope that does not exist");
}

std::optional<ScopeKind> ScopeKindFromText(std::string_view text) {
  for (const ScopeKind kind : {ScopeKind::kEnvironment, ScopeKind::kWorkflowRun}) {
    if (ToText(kind) == text) return kind;
  }
  return std::nullopt;
}

}  // namespace uplink::model
