#include "hosts/io/frame_selection.hpp"

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"

namespace posefusion {

std::string text_of(const FrameStart& start) {
    return start.after > Stamp{} ? shortest_text(to_seconds(start.after)) + "s" : std::to_string(start.frame);
}

FrameStart parse_frame_start(std::string_view text) {
    if (const auto frame = number_of<std::size_t>(text)) return {*frame, {}};
    if (text.ends_with('s')) {
        const auto after = parse_stamp(text.substr(0, text.size() - 1), TimeUnit::Seconds);
        if (after && *after >= Stamp{}) return {0, *after};
    }
    throw Error("'" + std::string(text) + "' is not allowed here; give a frame (40) or seconds (1.5s)");
}

}  // namespace posefusion
