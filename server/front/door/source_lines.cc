#include "server/front/door/source_lines.h"

#include <utility>

namespace uplink::front {
namespace {

/// These stand for all kinds of a robot, or of a source; no kind has these names.
constexpr std::string_view kOfRobot = "";
constexpr std::string_view kOfSource = "*";

/// The known peer; nothing for a stranger.
const std::string& NameOf(const Origin& origin) {
  if (!origin.gateway.empty()) return origin.gateway;
  return origin.robot.empty() ? origin.subject : origin.robot;
}

/// Whether there is room for a line of a peer that has, or has not, had one.
bool Fits(std::uint32_t lines, std::uint32_t lines_max, bool first) {
  return lines < (first ? lines_max : lines_max / SourceLines::kRepeatsPart);
}

}  // namespace

void SourceLines::Write(std::string_view event, std::string_view kind, const std::string& why,
                        const Origin& origin, SteadyTime now) {
  if (logger_ == nullptr) return;
  std::uint64_t suppressed = 0;
  {
    const std::lock_guard lock(mutex_);
    Window& window = WindowOf({origin.source, NameOf(origin), kind}, now);
    if (!Take(window, origin, now)) {
      ++window.suppressed;
      return;
    }
    suppressed = std::exchange(window.suppressed, 0);
  }
  logger_->Write(log::Level::kWarn, event,
                 {{"source", origin.source.ToText()},
                  {"peer", origin.text},
                  {"robot", origin.robot},
                  {"gateway", origin.gateway},
                  {"subject", origin.subject},
                  {"why", why},
                  {"suppressed", suppressed}});
}

bool SourceLines::Take(Window& of_kind, const Origin& origin, SteadyTime now) {
  Turn(all_, now);
  // At most three are looked up, so none makes another be forgotten.
  Window& robot = WindowOf({origin.source, NameOf(origin), kOfRobot}, now);
  Window& source = WindowOf({origin.source, "", kOfSource}, now);
  if (of_kind.lines >= kLinesPerKind) return false;
  if (!Fits(source.lines, kLinesPerSource, robot.lines == 0)) return false;
  if (!Fits(all_.lines, kLinesMax, source.lines == 0)) return false;
  for (Window* window : {&of_kind, &robot, &source, &all_}) ++window->lines;
  return true;
}

void SourceLines::Turn(Window& window, SteadyTime now) {
  if (window.lines > 0 && now < window.start + kSpan) return;
  window.start = now;
  window.lines = 0;
}

SourceLines::Window& SourceLines::WindowOf(const Key& key, SteadyTime now) {
  Window& window = windows_.Touch(key);
  Turn(window, now);
  return window;
}

}  // namespace uplink::front
