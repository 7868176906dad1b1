#include "hosts/web/web_server.hpp"

#include <httplib.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <map>
#include <string_view>
#include <thread>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr int kOk = 200, kNothing = 204, kMoved = 301, kForbidden = 403, kNotFound = 404, kNotAllowed = 405;
constexpr std::chrono::milliseconds kLook{100};  // how often it is asked whether the server is to stop
constexpr int kIdleSeconds = 1;                  // until an idle connection is closed, and the end is not kept waiting
constexpr int kSlowSeconds = 5;                  // for a request to arrive, or an answer to be taken
constexpr std::size_t kLongestBody = 1024;       // of a request; none has one
constexpr std::size_t kSecretBytes = 16;

/// Whether only this machine can reach the address.
bool is_loopback(const std::string& address) {
    return address == "localhost" || address == "::1" || address.starts_with("127.");
}

bool is_any(const std::string& address) { return address == "0.0.0.0" || address == "::"; }

std::string in_brackets(const std::string& address) {
    return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

std::string machine_name() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

std::string random_name() {
    std::array<unsigned char, kSecretBytes> bytes{};
    if (::getentropy(bytes.data(), bytes.size()) != 0) throw Error("the system has no random numbers for the address");
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string name;
    for (const unsigned char byte : bytes) {
        name += kDigits[byte >> 4];
        name += kDigits[byte & 15];
    }
    return name;
}

std::string why_not_listening(const WebServerConfig& config, int code) {
    const std::string place = in_brackets(config.address) + ":" + std::to_string(config.port);
    if (code == EADDRINUSE)
        return place + ": the port is in use; choose another with " + config.port_option + ", or " +
               config.port_option + " 0 for any that is free";
    if (code == EACCES) return place + ": the port is reserved for the system; choose one from 1024 on";
    return place + ": cannot be listened at; is it an address of this machine?";
}

/// Without the port.
std::string host_of(const httplib::Request& request) {
    const std::string host = request.get_header_value("Host");
    const std::size_t colon = host.rfind(':'), bracket = host.rfind(']');
    const bool port = colon != std::string::npos && (bracket == std::string::npos || colon > bracket);
    return port ? host.substr(0, colon) : host;
}

void refuse(httplib::Response& response, int status, const char* why) {
    response.status = status;
    response.set_header("Connection", "close");
    response.set_content(why, "text/plain; charset=utf-8");
}

}  // namespace

struct WebServer::Http {
    httplib::Server server;
    std::map<std::string, WebAnswer> resources;  // by path, relative to the page
    WebSource source;
    std::string folder;  // "/" or "/SECRET/"
    std::string address;
    bool loopback = true;

    void answer(const httplib::Request& request, httplib::Response& response) const;
    [[nodiscard]] std::optional<WebAnswer> find(const std::string& path) const;
    [[nodiscard]] bool names_this_machine(const httplib::Request& request) const;
};

bool WebServer::Http::names_this_machine(const httplib::Request& request) const {
    const std::string host = host_of(request);
    return host == "localhost" || host == "127.0.0.1" || host == "[::1]" || host == in_brackets(address);
}

void WebServer::Http::answer(const httplib::Request& request, httplib::Response& response) const {
    if (loopback && !names_this_machine(request))
        return refuse(response, kForbidden, "This page is for the machine that it is on.\n");
    if (request.method != "GET" && request.method != "HEAD")
        return refuse(response, kNotAllowed, "There is nothing here but a page to look at.\n");
    if (!loopback && request.path + "/" == folder) return response.set_redirect(folder, kMoved);
    const std::optional<WebAnswer> found = find(request.path);
    if (!found) return refuse(response, kNotFound, "There is nothing at this address.\n");
    response.status = found->body->empty() ? kNothing : kOk;
    if (found->body->empty()) return;
    // by a provider: the bytes are neither copied nor compressed again for each request
    response.set_content_provider(found->body->size(), found->type.c_str(),
                                  [body = found->body](std::size_t at, std::size_t length, httplib::DataSink& sink) {
                                      return sink.write(body->data() + at, length);
                                  });
}

std::optional<WebAnswer> WebServer::Http::find(const std::string& path) const {
    if (!path.starts_with(folder)) return std::nullopt;
    const std::string relative = path.substr(folder.size());
    const auto resource = resources.find(relative);
    if (resource != resources.end()) return resource->second;
    return source ? source(relative) : std::nullopt;
}

WebServer::WebServer(const WebServerConfig& config, std::vector<WebResource> resources, WebSource source)
    : http_(std::make_unique<Http>()) {
    Http& http = *http_;
    http.address = config.address;
    http.loopback = is_loopback(config.address);
    http.folder = http.loopback ? "/" : "/" + random_name() + "/";
    http.source = std::move(source);
    for (WebResource& resource : resources)
        http.resources.emplace(resource.path,
                               WebAnswer{resource.type, std::make_shared<const std::string>(std::move(resource.body))});

    http.server.set_pre_routing_handler([&http](const httplib::Request& request, httplib::Response& response) {
        http.answer(request, response);
        return httplib::Server::HandlerResponse::Handled;
    });
    http.server.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                                     {"Referrer-Policy", "no-referrer"},
                                     {"Cross-Origin-Resource-Policy", "same-origin"},
                                     {"X-Frame-Options", "DENY"},
                                     {"Cache-Control", "no-store"}});
    http.server.set_keep_alive_timeout(kIdleSeconds);
    http.server.set_read_timeout(kSlowSeconds);
    http.server.set_write_timeout(kSlowSeconds);
    http.server.set_payload_max_length(kLongestBody);
    // the library's own choice, SO_REUSEPORT, would let two servers share a port without a word
    http.server.set_socket_options([](socket_t socket) {
        const int yes = 1;
        ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });

    errno = 0;
    int port = config.port;
    const bool listens = port == 0 ? (port = http.server.bind_to_any_port(config.address)) > 0
                                   : http.server.bind_to_port(config.address, port);
    if (!listens) throw Error(why_not_listening(config, errno));
    const std::string host = is_any(config.address) ? machine_name() : in_brackets(config.address);
    url_ = "http://" + host + ":" + std::to_string(port) + http.folder;
}

WebServer::~WebServer() = default;

void WebServer::serve(const std::function<bool()>& stopped) {
    std::thread listener([this] { http_->server.listen_after_bind(); });
    while (!stopped()) std::this_thread::sleep_for(kLook);
    // to stop it before it has begun would be without effect
    while (!http_->server.is_running()) std::this_thread::sleep_for(kLook);
    http_->server.stop();
    listener.join();
}

}  // namespace posefusion
