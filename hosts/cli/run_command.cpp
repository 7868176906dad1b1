#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "engine/slam/map_piece.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/cli/time_table.hpp"
#include "hosts/config/config_file.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/map_file.hpp"
#include "hosts/io/masks.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/report/report.hpp"
#include "hosts/run/background.hpp"
#include "hosts/run/people_json.hpp"
#include "hosts/run/result_folder.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/run/stats_json.hpp"
#include "hosts/web/live_page.hpp"

namespace posefusion {
namespace {

/// Writes the results one by one, so that an error in one does not prevent the others.
class Results {
public:
    Results(const RunSession& session, const RunConfig& config, const std::vector<Option>& options, RunRecord& record,
            Console& console)
        : session_(session), config_(config), options_(options), record_(record), console_(console) {}

    void write() {
        const Trajectory trajectory = record_.trajectory();
        attempt("trajectory.txt", [&](const auto& file) { write_trajectory(file, trajectory); });
        written_.emplace_back("config.yaml");  // written at the start of the run
        if (config_.calibrated)
            attempt("camera_refined.yaml", [&](const auto& file) { write_camera_file(file, *config_.calibrated); });
        evaluate_against_groundtruth(trajectory);
        attempt("stats.json", [&](const auto& file) {
            write_file_atomically(file, stats_json(record_, session_.recording(), options_, evaluation_));
        });
        if (!config_.no_people)
            attempt("people.json", [&](const auto& file) { write_file_atomically(file, people_json(record_)); });
        attempt("map.ply", [&](const auto& file) {
            write_ply(file, session_.slam().surfels(!config_.all_surfels), {"made by PoseFusion " POSEFUSION_VERSION});
        });
        write_other_pieces();
        if (config_.objects) write_objects();
        if (config_.save_background) write_background_of(trajectory);
        if (!config_.save_map.empty()) {
            attempt_at(config_.save_map, {}, [&](const auto& file) { write_map(file, session_.slam().state()); });
        }
        if (config_.report) {
            std::vector<std::string> pictures;
            attempt("report.html",
                    [&](const auto& file) { pictures = write_report(file.parent_path(), report_data()); });
            written_.insert(written_.end(), pictures.begin(), pictures.end());
        }
    }

    [[nodiscard]] const std::vector<std::string>& written() const { return written_; }
    [[nodiscard]] const std::vector<std::string>& elsewhere() const { return elsewhere_; }
    [[nodiscard]] const std::optional<Evaluation>& evaluation() const { return evaluation_; }
    /// The error of the first file that could not be written; empty = none.
    [[nodiscard]] const std::string& error() const { return error_; }

private:
    template <class Write>
    void attempt(const std::string& name, Write&& write) {
        attempt_at(config_.out / name, name, write);
    }

    /// @param name  in the output folder; empty: elsewhere
    template <class Write>
    void attempt_at(const std::filesystem::path& file, const std::string& name, Write&& write) {
        try {
            write(file);
            (name.empty() ? elsewhere_ : written_).push_back(name.empty() ? file.string() : name);
        } catch (...) {
            const std::string text = error_text(std::current_exception());
            if (error_.empty())
                error_ = text;
            else
                console_.warning(text);
        }
    }

    void write_other_pieces() {
        if (record_.pieces.size() < 2) return;
        const std::vector<MapPiece> pieces = session_.slam().other_pieces(!config_.all_surfels);
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const PieceFiles names = files_of_piece(i + 1);
            attempt(names.trajectory,
                    [&](const auto& file) { write_trajectory(file, record_.trajectory(record_.pieces[i + 1])); });
            attempt(names.map, [&](const auto& file) {
                write_ply(file, pieces[i].surfels, {"made by PoseFusion " POSEFUSION_VERSION});
            });
        }
    }

    /// Of each object the trajectory in the world of the map, and the model in its own frame.
    void write_objects() {
        prepare_output_folder(config_.out / kObjectsFolder);
        for (const ObjectMap& object : session_.object_maps(!config_.all_surfels)) {
            const Trajectory poses =
                record_.pieces.empty() ? Trajectory{} : record_.object_trajectory(record_.pieces.front(), object.label);
            if (poses.empty()) continue;
            const std::string folder = std::string(kObjectsFolder) + "/" + std::to_string(object.label) + "/";
            prepare_output_folder(config_.out / folder);
            attempt(folder + "trajectory.txt", [&](const auto& file) { write_trajectory(file, poses); });
            attempt(folder + "map.ply", [&](const auto& file) {
                write_ply(file, object.surfels, {"made by PoseFusion " POSEFUSION_VERSION});
            });
        }
    }

    void write_background_of(const Trajectory& trajectory) {
        attempt(std::string(kBackgroundFolder) + "/", [&](const auto& folder) {
            Console console;  // counts anew
            write_background(folder, session_.slam(), trajectory, [&](std::size_t frames) {
                console.progress(frames, trajectory.size(), "written to " + folder.string());
            });
        });
    }

    void warn(const std::string& text) {
        console_.warning(text);
        record_.warnings.push_back(text);
    }

    void evaluate_against_groundtruth(const Trajectory& trajectory) {
        try {
            groundtruth_ = session_.recording().groundtruth();
            if (groundtruth_) evaluation_ = evaluate(*groundtruth_, trajectory);
        } catch (const Error& error) {
            warn("no comparison with the ground truth: " + std::string(error.what()));
        }
    }

    [[nodiscard]] ReportData report_data() const {
        ReportData data;
        data.recording = session_.recording().name();
        const Intrinsics& camera = session_.recording().intrinsics();
        data.facts = {
            {"Images", fmt::format("{} x {}", camera.width, camera.height)},
            {"Device", record_.device.name},
            {"People", record_.people_description},
            {"Memory", fmt::format("{:.0f} MiB", static_cast<double>(record_.peak_memory_bytes) / (1024.0 * 1024.0))},
            {"PoseFusion", POSEFUSION_VERSION}};
        if (record_.calibration && record_.calibration->camera)
            data.facts.emplace_back("Calibration", "corrected: " + calibration_change(*record_.calibration));
        if (record_.adjustment && !record_.adjustment->poses.empty())
            data.facts.emplace_back("Bundle adjustment",
                                    fmt::format("{} keyframes, {} points; poses moved by {:.2f} cm in the mean",
                                                record_.adjustment->keyframes, record_.adjustment->landmarks,
                                                100 * record_.adjustment->mean_change_m));
        if (record_.skipped > 0) {
            data.facts.emplace_back("Not usable", counted(record_.skipped, "frame") + " skipped, see the warnings");
        }
        if (record_.dropped) {
            data.facts.emplace_back("Real time",
                                    counted(*record_.dropped, "frame") + " dropped, as they came too fast");
        }
        if (record_.status != RunStatus::Finished) {
            data.facts.emplace_back("Ended early", record_.error.empty() ? "interrupted" : record_.error);
        }
        data.warnings = record_.warnings;
        data.groundtruth = groundtruth_;
        data.evaluation = evaluation_;
        data.host_stages = record_.host_stages();
        data.gpu_stages = record_.gpu_stages();
        add_frames(data);
        data.earlier_poses = record_.earlier_poses;
        data.keyframes = record_.keyframes;
        data.loop_graph = record_.loop_graph;
        if (data.loop_graph) data.loop_graph->frame = number_in_map(data.loop_graph->frame);
        data.map = session_.slam().surfels();
        add_objects(data);
        data.camera = camera;
        data.samples = record_.samples;
        data.configuration = config_yaml(options_);
        return data;
    }

    /// The report is about the map, that is about the frames of its piece.
    void add_frames(ReportData& data) const {
        if (record_.pieces.empty()) return;
        const PieceRecord& map = record_.pieces.front();
        for (std::size_t i = 0; i < map.frames.size(); ++i) {
            const FrameRecord& frame = record_.frames[map.frames[i]];
            data.trajectory.push_back({frame.stamp, map.poses[i]});
            data.people.push_back(frame.people);
            FrameResult& result = data.frames.emplace_back(frame.result);
            for (LoopEvent& event : result.loops) {
                event.frame = number_in_map(event.frame);
                event.model_frame = number_in_map(event.model_frame);
            }
        }
        data.lost = record_.lost_intervals(map.frames);
    }

    /// Those that were tracked in the frames of the map.
    void add_objects(ReportData& data) const {
        if (record_.pieces.empty()) return;
        for (const ObjectMap& object : session_.object_maps(true)) {
            Trajectory poses = record_.object_trajectory(record_.pieces.front(), object.label);
            if (!poses.empty()) data.objects.push_back({object.label, std::move(poses), object.surfels.size()});
        }
    }

    /// @param frame  number as the engine counts all frames, those of a loaded map first @return as it counts those of
    /// the map, which may lack some
    [[nodiscard]] std::uint32_t number_in_map(std::uint32_t frame) const {
        const std::size_t earlier = record_.earlier_poses.size();
        if (frame < earlier) return frame;
        const std::vector<std::size_t>& frames = record_.pieces.front().frames;
        const auto at = std::lower_bound(frames.begin(), frames.end(), frame - earlier);
        return static_cast<std::uint32_t>(earlier + static_cast<std::size_t>(at - frames.begin()));
    }

    const RunSession& session_;
    const RunConfig& config_;
    const std::vector<Option>& options_;
    RunRecord& record_;
    Console& console_;
    std::optional<Trajectory> groundtruth_;
    std::optional<Evaluation> evaluation_;
    std::vector<std::string> written_;    // names in the output folder
    std::vector<std::string> elsewhere_;  // paths
    std::string error_;
};

void print_summary(const RunRecord& record, const Results& results, const RunConfig& config) {
    std::string others;
    if (record.dropped) others += fmt::format(" ({} dropped)", *record.dropped);
    if (record.skipped > 0) others += fmt::format(" ({} skipped)", record.skipped);
    fmt::print("{}{} in {:.1f} s, {}, {} of them stable\n\n{}", counted(record.frames.size(), "frame"), others,
               record.wall_seconds, counted(record.surfels, "surfel"), record.stable_surfels, time_table(record));
    if (results.evaluation()) fmt::print("\n{}", evaluation_table(*results.evaluation()));
    fmt::print("\nwritten to {}:", config.out.string());
    for (const std::string& name : results.written()) fmt::print(" {}", name);
    fmt::print("{}\n", config.save_masks ? " masks/" : "");
    for (const std::string& path : results.elsewhere()) fmt::print("written to {}\n", path);
    std::fflush(stdout);
}

std::unique_ptr<LivePage> live_page(const WebServerConfig& server, RunSession& session, const RunConfig& config,
                                    Console& console) {
    LivePageConfig page;
    page.server = server;
    page.title = session.recording().name();
    const std::size_t frames = session.frames_to_do();
    page.frames_to_do = frames == FrameSource::kEndless ? 0 : frames;
    page.least_confidence = config.all_surfels ? 0 : config.slam.map.stable_confidence;
    page.warning = [&console](const std::string& text) { console.warning(text); };
    auto served = std::make_unique<LivePage>(std::move(page), session.slam());
    console.remark("the run is shown at " + served->url());
    return served;
}

const char* word_for(RunStatus status) {
    switch (status) {
        case RunStatus::Interrupted:
            return "interrupted";
        case RunStatus::Failed:
            return "failed";
        default:
            return "finished";
    }
}

}  // namespace

int run_command(const std::filesystem::path& recording, RunConfig& config, const std::optional<WebServerConfig>& web) {
    const std::vector<Option> options = option_table(config);
    ResultFolder folder(config, recording);
    std::optional<FoundTiming> sensor;
    std::optional<FoundCalibration> calibration;
    Console console;
    std::unique_ptr<RunSession> begun;
    std::unique_ptr<LivePage> page;
    try {
        sensor = look_for_sensor_timing(recording, config);
        calibration = look_for_calibration(recording, config, sensor ? std::move(sensor->look) : FirstLook{});
        begun = std::make_unique<RunSession>(recording, config);
        if (web) page = live_page(*web, *begun, config, console);
    } catch (const Error& error) {
        folder.leave_failure(config_yaml(options), failure_json(recording.string(), error.what(), options));
        throw;
    }
    RunSession& session = *begun;
    folder.open();

    RunRecord record = session.run(console, [&](const ScheduledFrame& frame) {
        folder.begin(config_yaml(options));
        if (page) page->frame_done(frame);
        if (!config.save_masks) return;
        LabelImage labels =
            with_movers(labels_by_id(frame.people.segmentation.labels, frame.people.ids), frame.result.movers);
        if (labels.empty()) labels = LabelImage(frame.input.depth.width(), frame.input.depth.height());
        write_mask(folder.masks(), frame.input.stamp_text, labels, session.recording());
    });

    if (page) page->run_ended(word_for(record.status));
    record.sensor = std::move(sensor);
    record.calibration = calibration;
    session.adjust(record, console);
    if (!record.frames.empty()) {
        folder.begin(config_yaml(options));  // for a resumed run that had no frame left
        if (record.status == RunStatus::Finished) folder.finish();
        for (const std::string& doubt : record.judge()) console.warning(doubt);
        Results results(session, config, options, record, console);
        results.write();
        print_summary(record, results, config);
        if (record.error.empty())
            record.error = results.error();
        else if (!results.error().empty())
            console.warning(results.error());
    }
    if (record.frames.empty() && !record.error.empty()) {  // for those who read no console
        folder.begin(config_yaml(options));
        write_file_atomically(config.out / "stats.json",
                              stats_json(record, session.recording(), options, std::nullopt));
    }
    if (!record.error.empty()) throw Error(record.error);
    if (record.status == RunStatus::Interrupted) {
        console.warning("interrupted after " + counted(record.frames.size(), "frame"));
        return kExitInterrupted;
    }
    return kExitOk;
}

}  // namespace posefusion
