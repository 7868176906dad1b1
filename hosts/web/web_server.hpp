#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hosts/web/web_page.hpp"

namespace posefusion {

struct WebServerConfig {
    std::string address = "127.0.0.1";   ///< IPv4 or IPv6 address, or host name, of this machine to listen at
    int port = 8080;                     ///< 0 = any that is free
    std::string port_option = "--port";  ///< that chose it, for messages
};

/// An answer that is made, or changes, while the server runs. An empty body: there is nothing any more.
struct WebAnswer {
    std::string type;  ///< MIME
    std::shared_ptr<const std::string> body;
};

/// What is at a path relative to the page, nullopt: nothing; asked by several threads at once.
using WebSource = std::function<std::optional<WebAnswer>(const std::string& path)>;

/// Serves the resources of a page over HTTP, what `source` has besides, and nothing else: no file is opened for a
/// request. At an address that other machines may reach, the page lies in a folder with a random name (128 bits),
/// without which everything is "not found"; at the loopback address requests that name another host are refused, so
/// that no page from elsewhere can read it through a name of its own (DNS rebinding).
class WebServer {
public:
    /// Begins to listen. Throws Error: the port is in use, or the address is none of this machine.
    WebServer(const WebServerConfig& config, std::vector<WebResource> resources, WebSource source = {});
    ~WebServer();
    WebServer(const WebServer&) = delete;
    WebServer& operator=(const WebServer&) = delete;

    /// Where the page is, with the folder.
    [[nodiscard]] const std::string& url() const { return url_; }

    /// Answers requests until `stopped`.
    void serve(const std::function<bool()>& stopped);

private:
    struct Http;
    std::unique_ptr<Http> http_;
    std::string url_;
};

}  // namespace posefusion
