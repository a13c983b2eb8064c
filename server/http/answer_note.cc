#include "server/http/answer_note.h"

#include <chrono>

namespace uplink::http {

void NoteAnswered(const HttpServer::Context& server, RouteId route, int status,
                  SteadyTime started) {
  const auto took = server.clock.Steady() - started;
  server.probe.request_seconds.Observe(std::chrono::duration<double>(took).count());
  server.probe.CountRequest(route, status);
  if (!server.logger.Enabled(log::Level::kDebug)) return;
  const auto ms = std::chrono::duration_cast<milliseconds>(took).count();
  server.logger.Debug("http_answered",
                      {{"route", RouteName(route)}, {"status", status}, {"ms", ms}});
}

}  // namespace uplink::http
