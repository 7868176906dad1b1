#include "hosts/io/recorders/recorder.hpp"

#include <algorithm>
#include <array>
#include <system_error>

#include "engine/core/number_text.hpp"
#include "hosts/io/image_header.hpp"
#include "hosts/io/recording.hpp"

namespace posefusion {

void expect_no_recording(const std::filesystem::path& folder) {
    constexpr int kDepth = 1;  // images lie in the folder, or in one of those in it
    constexpr std::array kParts{"rgb.txt",     "depth.txt",        "associations.txt", "masks.txt",   "groundtruth.txt",
                                "camera.yaml", "camera_true.yaml", "info.json",        "joints.json", "events.json"};
    std::error_code error;
    for (std::filesystem::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        if (entry.depth() >= kDepth) entry.disable_recursion_pending();
        const std::filesystem::path& file = entry->path();
        const bool is_part =
            entry.depth() == 0 && std::find(kParts.begin(), kParts.end(), file.filename()) != kParts.end();
        if (is_part || has_image_ending(file))
            throw Error(folder.string() + ": holds a recording already, or a part of one (" +
                        file.lexically_relative(folder).string() + "); choose another folder");
    }
}

std::unique_ptr<Recorder> make_recorder(const std::filesystem::path& out, const Camera& camera,
                                        const RecordOptions& options) {
    if (out.extension() == ".klg") return make_klg_recorder(out, camera, options);
    return make_tum_recorder(out, camera);
}

Recorded record(const FrameSource& source, const std::filesystem::path& out, const RecordOptions& options,
                const RecordObserver& observer) {
    const std::size_t wanted = options.max_frames == 0 ? FrameSource::kEndless : options.max_frames;
    const auto recorder = make_recorder(out, source.camera(), options);
    BadFrames bad_frames(source.size());
    Recorded result;
    for (std::size_t i = 0; i < source.size() && result.frames < wanted && !observer.cancelled(); ++i) {
        RawFrame frame;
        try {
            frame = source.read(i);
        } catch (const SourceEnded&) {
            break;
        } catch (const SourceLost& lost) {
            if (result.frames == 0) throw;
            observer.warning(lost.what());
            break;
        } catch (const Error& error) {
            if (const std::string text = bad_frames.bad(error.what()); !text.empty()) observer.warning(text);
            continue;
        }
        bad_frames.good();
        try {
            recorder->add(frame);
        } catch (const Error& error) {
            if (result.frames == 0) throw;
            recorder->finish(std::nullopt);  // there may be no room for more
            throw Error(error.what() + std::string("; kept in ") + out.string() + ": " +
                        counted(result.frames, "frame"));
        }
        observer.progress(++result.frames);
    }
    if (result.frames == 0) throw Error(source.facts().location + ": no frame was recorded");
    result.skipped = bad_frames.skipped();
    std::optional<Trajectory> groundtruth;
    try {
        groundtruth = source.groundtruth();
    } catch (const Error& error) {
        observer.warning("the ground truth is left out: " + std::string(error.what()));
    }
    recorder->finish(groundtruth);
    return result;
}

}  // namespace posefusion
