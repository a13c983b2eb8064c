#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

#include "schema/base/clock.h"
#include "schema/model/rejection.h"
#include "uncrew/v1/avatar.pb.h"

namespace uplink::synthetic {

/// Some of the contract's outcomes. A value.
class Outcomes final {
 public:
  template <typename... Each>
  constexpr explicit Outcomes(Each... each) : bits_((BitOf(each) | ... | 0U)) {}

  [[nodiscard]] constexpr bool Has(::uncrew::v1::Outcome outcome) const {
    return (bits_ & BitOf(outcome)) != 0;
  }
  /// For people.
  [[nodiscard]] std::string Text() const {
    std::string text;
    for (int i = ::uncrew::v1::Outcome_MIN; i <= ::uncrew::v1::Outcome_MAX; ++i) {
      const auto outcome = static_cast<::uncrew::v1::Outcome>(i);
      if (Has(outcome)) text += (text.empty() ? "" : " or ") + ::uncrew::v1::Outcome_Name(outcome);
    }
    return text;
  }

 private:
  static constexpr std::uint32_t BitOf(::uncrew::v1::Outcome outcome) {
    return outcome < 0 || outcome > ::uncrew::v1::Outcome_MAX
               ? 0U
               : 1U << static_cast<unsigned>(outcome);
  }

  std::uint32_t bits_;
};

/// A new live sample; a new durable one; one that says what is known; whatever is no rejection,
/// where an answer was lost before.
inline constexpr Outcomes kApplies{::uncrew::v1::OUTCOME_APPLIED};
inline constexpr Outcomes kStores{::uncrew::v1::OUTCOME_STORED};
inline constexpr Outcomes kSaysTheSame{::uncrew::v1::OUTCOME_APPLIED,
                                       ::uncrew::v1::OUTCOME_SUPERSEDED};
inline constexpr Outcomes kIsKnown{::uncrew::v1::OUTCOME_DUPLICATE,
                                   ::uncrew::v1::OUTCOME_SUPERSEDED};
inline constexpr Outcomes kIsGood{::uncrew::v1::OUTCOME_STORED, ::uncrew::v1::OUTCOME_APPLIED,
                                  ::uncrew::v1::OUTCOME_SUPERSEDED,
                                  ::uncrew::v1::OUTCOME_DUPLICATE};
inline constexpr Outcomes kIsWrong{::uncrew::v1::OUTCOME_REJECTED};

/// How a call must be answered when nothing of it was lost. A value.
struct DueAnswer {
  Outcomes outcomes = kIsGood;
  // Of one that is wrong on purpose.
  model::RejectReason reason = model::RejectReason::kMalformed;
  std::string field;
};

/// One call as it leaves for the server. A value.
struct AvatarCall {
  /// Within its drone, from 1; 0: no account knows it.
  std::uint64_t number = 0;
  /// Calls of one line follow each other: the next leaves when the one before is answered.
  std::size_t line = 0;
  /// `PublishBattery`.
  std::string method;
  std::string request;
  /// A newer one of its line may take its place while it waits.
  bool live = false;
  DueAnswer due;
};

/// Names a drone and its run. A value.
struct DroneOptions {
  /// The same seed and index give the same drone, which says the same; times and `run` apart.
  std::uint64_t seed = 1;
  std::size_t index = 0;
  /// Begins the ids of alerts and requests, so that those of earlier runs are known as such.
  std::string run;
};

/// `synthetic-0001`, and its RURI as `uncrew.ruri_template` has it by default.
[[nodiscard]] std::string UavIdOf(std::size_t index);
[[nodiscard]] std::string DroneRuri(std::size_t index);

}  // namespace uplink::synthetic
