#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "server/log/logger.h"

namespace uplink::log {
namespace {

class StandardErrorSink final : public LineSink {
 public:
  StandardErrorSink() : logger_("uplinkd", std::make_shared<spdlog::sinks::stderr_sink_mt>()) {
    logger_.set_pattern("%v");
    logger_.set_level(spdlog::level::trace);
    logger_.flush_on(spdlog::level::trace);
    // A full pipe or a closed descriptor must not end the server; there is nowhere to tell it.
    logger_.set_error_handler([](const std::string& /*message*/) {});
  }

  void Write(std::string_view line) override {
    logger_.log(spdlog::level::info, spdlog::string_view_t(line.data(), line.size()));
  }

 private:
  spdlog::logger logger_;
};

}  // namespace

std::unique_ptr<LineSink> StandardError() { return std::make_unique<StandardErrorSink>(); }

}  // namespace uplink::log
