#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/cyberwave/sink_count.h"
#include "tests/bench/page.h"
#include "tests/bench/pinned_server.h"
#include "tests/support/temp_folder.h"

namespace uplink::bench {

/// A program that takes messages from a broker, on the servers' core.
///
/// Errors: one that does not start or subscribe aborts the benchmark.
/// Thread: confined to one thread.
class Subscriber {
 public:
  virtual ~Subscriber() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// Messages that it is done with so far; at QoS 1 those that it acked.
  [[nodiscard]] virtual std::uint64_t count() = 0;
  [[nodiscard]] virtual synthetic::ProcessUse use() const = 0;
};

/// The bare sink on libmosquitto.
class Sink final : public Subscriber {
 public:
  explicit Sink(std::uint16_t broker_port);
  [[nodiscard]] std::string name() const override { return "libmosquitto sink"; }
  [[nodiscard]] std::uint64_t count() override { return count_.Read(); }
  [[nodiscard]] synthetic::ProcessUse use() const override { return UseOf(*process_); }

 private:
  const testing::TempFolder folder_;
  const SinkCount count_{folder_.File("count")};
  std::unique_ptr<testing::ServerProcess> process_;
};

/// Debian's prometheus-mqtt-exporter, which is told to keep each joint as a gauge.
class Exporter final : public Subscriber {
 public:
  explicit Exporter(std::uint16_t broker_port);
  /// Its package need not be there.
  [[nodiscard]] static bool IsInstalled();
  [[nodiscard]] std::string name() const override { return "prometheus-mqtt-exporter"; }
  [[nodiscard]] std::uint64_t count() override;
  [[nodiscard]] synthetic::ProcessUse use() const override { return UseOf(*process_); }

 private:
  const testing::TempFolder folder_;
  std::uint16_t port_ = 0;
  std::unique_ptr<testing::ServerProcess> process_;
};

class Uplinkd final : public Subscriber {
 public:
  /// A value.
  struct Options {
    std::uint16_t broker_port = 0;
    /// Empty: an SQLite store of its own.
    std::string store_url;
    /// cyberwave.media.
    std::string media = "off";
  };
  explicit Uplinkd(const Options& options);
  /// In order, so that the next one need not wait for its lease.
  ~Uplinkd() override { static_cast<void>(server_->Stop()); }
  Uplinkd(const Uplinkd&) = delete;
  Uplinkd& operator=(const Uplinkd&) = delete;

  [[nodiscard]] std::string name() const override { return "uplinkd"; }
  [[nodiscard]] std::uint64_t count() override;
  [[nodiscard]] synthetic::ProcessUse use() const override { return server_->use(); }

  /// Its metrics as they are now.
  [[nodiscard]] Samples Metrics() const;
  /// Waits until the broker has all of its connections.
  void WaitConnected() const;

 private:
  const bool counts_media_;
  testing::UplinkdFolder folder_;
  std::unique_ptr<PinnedServer> server_;
};

}  // namespace uplink::bench
