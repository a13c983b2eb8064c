#pragma once

#include <cstdint>
#include <type_traits>

#include "schema/model/connection.h"
#include "schema/model/enum_text.h"
#include "schema/model/message_source.h"
#include "schema/model/operator_request.h"
#include "schema/model/presence.h"
#include "schema/model/rejection.h"
#include "schema/model/scope_update.h"
#include "storage/audit.h"
#include "storage/rows.h"

// How enumerations stand in columns, in every store.
namespace uplink::storage {

/// The number as it came: one that we do not know is kept.
template <model::WireEnum E>
[[nodiscard]] std::int32_t NumberOf(E member) {
  return static_cast<std::int32_t>(static_cast<std::uint16_t>(member));
}

/// The member that NumberOf wrote.
template <model::WireEnum E>
[[nodiscard]] E MemberOf(std::int64_t column) {
  return static_cast<E>(static_cast<std::uint16_t>(column));
}

/// kForAge for a number that this program does not know: a newer one closed the run.
[[nodiscard]] RunClosed RunClosedOf(std::int64_t column);

/// kUnknown for a number that no presence has.
[[nodiscard]] model::Presence PresenceOf(std::int64_t column);

/// The reason of the contract that a column holds; kStoreRefused for a number that none has, which
/// a newer program may have written: one row must not keep a robot, nor a batch, from the store.
[[nodiscard]] model::RejectReason ReasonOf(std::int64_t column);

/// kEnvironment for a number that no scope has.
[[nodiscard]] model::ScopeKind ScopeKindOf(std::int64_t column);

/// kUplink for a number that this program does not know.
[[nodiscard]] model::MessageSource MessageSourceOf(std::int64_t column);

/// kConfirmDeliveryReady for a number that this program does not know.
[[nodiscard]] model::OperatorRequestKind OperatorRequestKindOf(std::int64_t column);

/// kBroken for a number that this program does not know.
[[nodiscard]] model::ConnectionEnd ConnectionEndOf(std::int64_t column);

/// kServer for a number that this program does not know.
[[nodiscard]] AuditProof AuditProofOf(std::int64_t column);

/// The same by the type: one of the eight above.
template <typename E>
[[nodiscard]] E KnownMemberOf(std::int64_t column) {
  if constexpr (std::is_same_v<E, RunClosed>) {
    return RunClosedOf(column);
  } else if constexpr (std::is_same_v<E, model::Presence>) {
    return PresenceOf(column);
  } else if constexpr (std::is_same_v<E, model::RejectReason>) {
    return ReasonOf(column);
  } else if constexpr (std::is_same_v<E, model::ScopeKind>) {
    return ScopeKindOf(column);
  } else if constexpr (std::is_same_v<E, model::OperatorRequestKind>) {
    return OperatorRequestKindOf(column);
  } else if constexpr (std::is_same_v<E, model::ConnectionEnd>) {
    return ConnectionEndOf(column);
  } else if constexpr (std::is_same_v<E, AuditProof>) {
    return AuditProofOf(column);
  } else {
    static_assert(std::is_same_v<E, model::MessageSource>, "no column holds such a number");
    return MessageSourceOf(column);
  }
}

}  // namespace uplink::storage
