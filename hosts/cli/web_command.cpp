#include <fmt/format.h>

#include <cstdio>

#include "hosts/cli/commands.hpp"
#include "hosts/cli/map_input.hpp"
#include "hosts/run/signals.hpp"
#include "hosts/web/read_scene.hpp"
#include "hosts/web/web_page.hpp"

namespace posefusion {

int web_command(const WebConfig& config) {
    const bool folder = std::filesystem::is_directory(config.source);
    std::vector<Surfel> surfels =
        read_wanted_surfels(folder ? config.source / "map.ply" : config.source, config.min_confidence);
    const auto remark = [](const std::string& text) { fmt::print(stderr, "posefusion: warning: {}\n", text); };
    const WebScene scene = read_scene(config.source, std::move(surfels), config.recording, remark, interrupted);
    if (interrupted()) return kExitInterrupted;
    WebServer server(config.server, served_page(scene));
    fmt::print("{}\n", server.url());
    std::fflush(stdout);
    fmt::print(stderr, "open this address in a browser; Ctrl-C ends\n");
    server.serve(interrupted);
    return kExitOk;
}

}  // namespace posefusion
