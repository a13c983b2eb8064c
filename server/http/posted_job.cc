#include "server/http/posted_job.h"

#include <utility>

namespace uplink::http {
namespace {

loop::ReadThreads& ThreadOf(const HttpServer::Context& server, Lane lane) {
  switch (lane) {
    case Lane::kMemory:
      return server.memory;
    case Lane::kMetrics:
      return server.metrics;
    case Lane::kScrape:
      return server.scrapes;
    case Lane::kWatch:
      return server.watches;
    case Lane::kIo:
    case Lane::kRead:
      break;
  }
  return server.reads;
}

}  // namespace

std::optional<PostedJob> PostedJob::Post(const ConnectionContext& context, Lane lane,
                                         std::function<void()> run) {
  loop::ReadThreads& thread = ThreadOf(context.server, lane);
  // Scrapers on this machine go ahead of those on others.
  const bool ahead = lane == Lane::kScrape && context.listener == ListenerId::kHttp;
  const auto id = ahead ? thread.TryPostAhead(std::move(run)) : thread.TryPost(std::move(run));
  if (!id) return std::nullopt;
  return PostedJob(thread, *id);
}

}  // namespace uplink::http
