#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>

#include "schema/judge.h"
#include "server/front/call/relay_context.h"
#include "server/front/call/unfinished.h"
#include "server/front/door/debug_lines.h"
#include "server/front/door/door_book.h"
#include "server/front/http2/http2.h"
#include "server/front/loop/socket.h"
#include "server/front/tls/tls_engine.h"
#include "server/loop/wake.h"
#include "server/session/context.h"
#include "server/transport/event_clock.h"
#include "server/transport/gate.h"
#include "server/transport/methods.h"
#include "server/transport/timers.h"

namespace uplink::front {

class Call;

/// What the connections and calls of one thread share: the clock of the current event, timers,
/// buffers that they use one after the other, and its calls by number.
///
/// Thread: confined to it.
struct Thread {
  Thread(const RelayContext& given, transport::Gate& its_gate,
         const transport::MethodsMaker& make_methods, loop::WakeInbox& its_inbox,
         DoorBook& door_book, Unfinished& unfinished_memory)
      : relay(given),
        debug(given.logger),
        book(door_book),
        gate(its_gate),
        inbox(its_inbox),
        clock(given.clock),
        methods(make_methods(clock)),
        serves_calls(std::any_of(methods.begin(), methods.end(),
                                 [](const auto& method) {
                                   return method.second.admission == transport::Admission::kCall;
                                 })),
        judge(given.judge_limits),
        sessions{clock,
                 given.fleet,
                 given.journals,
                 given.session_probe,
                 given.ledgers.NewPage(),
                 judge,
                 given.limits,
                 scratch,
                 given.allowances,
                 given.rejects,
                 given.clock_trust,
                 &door_book.pressed_flag(),
                 given.forwards,
                 given.reports},
        unfinished(unfinished_memory) {}

  const RelayContext& relay;
  const DebugLines debug;
  DoorBook& book;
  transport::Gate& gate;
  /// Where other threads wake calls.
  loop::WakeInbox& inbox;
  transport::EventClock clock;
  const transport::Methods methods;
  /// Some methods are unary: a connection may make many calls.
  const bool serves_calls;
  schema::Judge judge;
  session::IntakeScratch scratch;
  const session::SessionContext sessions;

  transport::Timers call_timers;
  transport::Timers connection_timers;
  /// By the number that wakes and timers name.
  std::unordered_map<std::uint64_t, Call*> calls;
  std::uint64_t next_call = 1;
  Unfinished& unfinished;

  const BufferMethod buffer_method;
  const Http2Rules http2_rules;
  Http2Memory http2_memory;
  TlsBuffers tls;
  std::array<char, kSharedReadBytes> received;
  /// Frames that go out in one TLS record.
  std::string gathered;
};

}  // namespace uplink::front
