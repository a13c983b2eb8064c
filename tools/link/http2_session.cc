#include "tools/link/http2_session.h"

#include <array>

#include <nghttp2/nghttp2.h>

#include "schema/base/check.h"

namespace uplink::link {
namespace {

std::string_view TextOf(const std::uint8_t* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

/// nghttp2 wants pointers to mutable bytes; it copies them.
std::uint8_t* BytesOf(std::string_view text) {
  return reinterpret_cast<std::uint8_t*>(const_cast<char*>(text.data()));
}

}  // namespace

/// nghttp2's way to call back: user data is the Http2Session.
struct Http2Session::Callbacks {
  static int Header(nghttp2_session* /*session*/, const nghttp2_frame* frame,
                    const std::uint8_t* name, std::size_t name_size, const std::uint8_t* value,
                    std::size_t value_size, std::uint8_t /*flags*/, void* user) {
    auto& self = *static_cast<Http2Session*>(user);
    if (frame->hd.stream_id == self.stream_) {
      self.events_.OnHeader(TextOf(name, name_size), TextOf(value, value_size));
    }
    return 0;
  }

  static int Data(nghttp2_session* /*session*/, std::uint8_t /*flags*/, std::int32_t stream,
                  const std::uint8_t* bytes, std::size_t size, void* user) {
    auto& self = *static_cast<Http2Session*>(user);
    if (stream == self.stream_) self.events_.OnData(TextOf(bytes, size));
    return 0;
  }

  static int Closed(nghttp2_session* /*session*/, std::int32_t stream, std::uint32_t error,
                    void* user) {
    auto& self = *static_cast<Http2Session*>(user);
    if (stream != self.stream_) return 0;
    self.stream_ = -1;
    self.events_.OnClosed(error);
    return 0;
  }

  static ssize_t Body(nghttp2_session* /*session*/, std::int32_t /*stream*/, std::uint8_t* to,
                      std::size_t max, std::uint32_t* flags, nghttp2_data_source* /*source*/,
                      void* user) {
    auto& self = *static_cast<Http2Session*>(user);
    bool end = false;
    const std::size_t taken = self.events_.TakeBody(to, max, end);
    if (end) *flags |= NGHTTP2_DATA_FLAG_EOF;
    if (taken == 0 && !end) return NGHTTP2_ERR_DEFERRED;
    return static_cast<ssize_t>(taken);
  }
};

Http2Session::Http2Session(Http2Events& events, const Window& window)
    : events_(events), session_(nullptr, nghttp2_session_del) {
  nghttp2_session_callbacks* callbacks = nullptr;
  UPLINK_CHECK(nghttp2_session_callbacks_new(&callbacks) == 0, "nghttp2 makes callbacks");
  nghttp2_session_callbacks_set_on_header_callback(callbacks, &Callbacks::Header);
  nghttp2_session_callbacks_set_on_data_chunk_recv_callback(callbacks, &Callbacks::Data);
  nghttp2_session_callbacks_set_on_stream_close_callback(callbacks, &Callbacks::Closed);
  nghttp2_session* session = nullptr;
  nghttp2_option* option = nullptr;
  UPLINK_CHECK(nghttp2_option_new(&option) == 0, "nghttp2 makes options");
  nghttp2_option_set_no_auto_window_update(option, window.renewed ? 0 : 1);
  const int made = nghttp2_session_client_new2(&session, callbacks, this, option);
  nghttp2_option_del(option);
  nghttp2_session_callbacks_del(callbacks);
  UPLINK_CHECK(made == 0, "nghttp2 makes a session");
  session_.reset(session);
  const std::array<nghttp2_settings_entry, 2> settings = {
      {{NGHTTP2_SETTINGS_ENABLE_PUSH, 0}, {NGHTTP2_SETTINGS_INITIAL_WINDOW_SIZE, window.bytes}}};
  nghttp2_submit_settings(session, NGHTTP2_FLAG_NONE, settings.data(), settings.size());
  nghttp2_session_set_local_window_size(session, NGHTTP2_FLAG_NONE, 0,
                                        static_cast<std::int32_t>(window.bytes));
}

Http2Session::~Http2Session() = default;

bool Http2Session::Open(const std::vector<Header>& headers) {
  std::vector<nghttp2_nv> fields;
  fields.reserve(headers.size());
  for (const auto& [name, value] : headers) {
    fields.push_back(
        {BytesOf(name), BytesOf(value), name.size(), value.size(), NGHTTP2_NV_FLAG_NONE});
  }
  const nghttp2_data_provider body{{}, &Callbacks::Body};
  stream_ =
      nghttp2_submit_request(session_.get(), nullptr, fields.data(), fields.size(), &body, nullptr);
  return stream_ > 0;
}

void Http2Session::Resume() {
  if (stream_ > 0) nghttp2_session_resume_data(session_.get(), stream_);
}

void Http2Session::Reset(std::uint32_t error) {
  if (stream_ > 0) nghttp2_submit_rst_stream(session_.get(), NGHTTP2_FLAG_NONE, stream_, error);
}

bool Http2Session::Receive(std::string_view bytes) {
  return nghttp2_session_mem_recv(session_.get(), BytesOf(bytes), bytes.size()) >= 0;
}

bool Http2Session::ProduceFrame(std::string& out) {
  const std::uint8_t* bytes = nullptr;
  const ssize_t size = nghttp2_session_mem_send(session_.get(), &bytes);
  if (size <= 0) return false;
  out.append(TextOf(bytes, static_cast<std::size_t>(size)));
  return true;
}

bool Http2Session::may_open() const {
  return nghttp2_session_check_request_allowed(session_.get()) != 0;
}

}  // namespace uplink::link
