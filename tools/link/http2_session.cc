#include "tools/link/http2_session.h"

#include <algorithm>
#include <array>

#include <nghttp2/nghttp2.h>

#include "schema/base/check.h"

namespace uplink::link {
namespace {

/// Of a connection whose streams are read apart.
constexpr std::uint32_t kSharedBytes = 1024 * 1024;

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
  /// Null once it was forgotten.
  static Http2Events* EventsOf(nghttp2_session* session, std::int32_t stream) {
    return static_cast<Http2Events*>(nghttp2_session_get_stream_user_data(session, stream));
  }

  static int Header(nghttp2_session* session, const nghttp2_frame* frame, const std::uint8_t* name,
                    std::size_t name_size, const std::uint8_t* value, std::size_t value_size,
                    std::uint8_t /*flags*/, void* /*user*/) {
    if (Http2Events* const events = EventsOf(session, frame->hd.stream_id)) {
      events->OnHeader(TextOf(name, name_size), TextOf(value, value_size));
    }
    return 0;
  }

  static int Data(nghttp2_session* session, std::uint8_t /*flags*/, std::int32_t stream,
                  const std::uint8_t* bytes, std::size_t size, void* user) {
    if (static_cast<Http2Session*>(user)->by_stream_) {
      nghttp2_session_consume_connection(session, size);
    }
    if (Http2Events* const events = EventsOf(session, stream)) events->OnData(TextOf(bytes, size));
    return 0;
  }

  static int Closed(nghttp2_session* session, std::int32_t stream, std::uint32_t error,
                    void* /*user*/) {
    if (Http2Events* const events = EventsOf(session, stream)) events->OnClosed(error);
    return 0;
  }

  static ssize_t Body(nghttp2_session* session, std::int32_t stream, std::uint8_t* to,
                      std::size_t max, std::uint32_t* flags, nghttp2_data_source* /*source*/,
                      void* /*user*/) {
    Http2Events* const events = EventsOf(session, stream);
    if (events == nullptr) return NGHTTP2_ERR_DEFERRED;
    bool end = false;
    const std::size_t taken = events->TakeBody(to, max, end);
    if (end) *flags |= NGHTTP2_DATA_FLAG_EOF;
    if (taken == 0 && !end) return NGHTTP2_ERR_DEFERRED;
    return static_cast<ssize_t>(taken);
  }
};

Http2Session::Http2Session(const Window& window)
    : by_stream_(window.by_stream), session_(nullptr, nghttp2_session_del) {
  nghttp2_session_callbacks* callbacks = nullptr;
  UPLINK_CHECK(nghttp2_session_callbacks_new(&callbacks) == 0, "nghttp2 makes callbacks");
  nghttp2_session_callbacks_set_on_header_callback(callbacks, &Callbacks::Header);
  nghttp2_session_callbacks_set_on_data_chunk_recv_callback(callbacks, &Callbacks::Data);
  nghttp2_session_callbacks_set_on_stream_close_callback(callbacks, &Callbacks::Closed);
  nghttp2_session* session = nullptr;
  nghttp2_option* option = nullptr;
  UPLINK_CHECK(nghttp2_option_new(&option) == 0, "nghttp2 makes options");
  nghttp2_option_set_no_auto_window_update(option, window.renewed && !window.by_stream ? 0 : 1);
  const int made = nghttp2_session_client_new2(&session, callbacks, this, option);
  nghttp2_option_del(option);
  nghttp2_session_callbacks_del(callbacks);
  UPLINK_CHECK(made == 0, "nghttp2 makes a session");
  session_.reset(session);
  const std::array<nghttp2_settings_entry, 2> settings = {
      {{NGHTTP2_SETTINGS_ENABLE_PUSH, 0}, {NGHTTP2_SETTINGS_INITIAL_WINDOW_SIZE, window.bytes}}};
  nghttp2_submit_settings(session, NGHTTP2_FLAG_NONE, settings.data(), settings.size());
  const std::uint32_t whole =
      window.by_stream ? std::max(window.bytes, kSharedBytes) : window.bytes;
  nghttp2_session_set_local_window_size(session, NGHTTP2_FLAG_NONE, 0,
                                        static_cast<std::int32_t>(whole));
}

Http2Session::~Http2Session() = default;

std::int32_t Http2Session::Open(const std::vector<Header>& headers, Http2Events& events) {
  std::vector<nghttp2_nv> fields;
  fields.reserve(headers.size());
  for (const auto& [name, value] : headers) {
    fields.push_back(
        {BytesOf(name), BytesOf(value), name.size(), value.size(), NGHTTP2_NV_FLAG_NONE});
  }
  const nghttp2_data_provider body{{}, &Callbacks::Body};
  return nghttp2_submit_request(session_.get(), nullptr, fields.data(), fields.size(), &body,
                                &events);
}

void Http2Session::Resume(std::int32_t stream) {
  nghttp2_session_resume_data(session_.get(), stream);
}

void Http2Session::Reset(std::int32_t stream, std::uint32_t error) {
  nghttp2_submit_rst_stream(session_.get(), NGHTTP2_FLAG_NONE, stream, error);
}

void Http2Session::Forget(std::int32_t stream) {
  nghttp2_session_set_stream_user_data(session_.get(), stream, nullptr);
}

void Http2Session::Consume(std::int32_t stream, std::size_t bytes) {
  nghttp2_session_consume_stream(session_.get(), stream, bytes);
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
