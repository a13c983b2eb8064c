#pragma once

#include <memory>
#include <string>

#include "tests/bench/fair/bad_stream.h"
#include "tests/bench/fair/misdeed.h"

namespace uplink::bench {

/// One way to be bad. Never waits: what it waits for it looks at in the next Act.
///
/// Thread: confined to the loop's thread.
class Misbehaviour {
 public:
  virtual ~Misbehaviour() = default;
  /// Does what is to be done now. Called after every event of the loop, never within one, and at
  /// least every few milliseconds.
  virtual void Act() = 0;
  /// What had to be prepared is done, and it has begun.
  [[nodiscard]] virtual bool at_work() const = 0;
};

/// `world` outlives it; `ruri` is the bad robot's own.
[[nodiscard]] std::unique_ptr<Misbehaviour> MakeMisbehaviour(Misdeed misdeed, BadWorld& world,
                                                             const std::string& ruri);

}  // namespace uplink::bench
