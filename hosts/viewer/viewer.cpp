#include "hosts/viewer/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/core/error.hpp"
#include "engine/core/median.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/config/run_config.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/report/person_colors.hpp"
#include "hosts/run/signals.hpp"
#include "hosts/viewer/scene_lines.hpp"

namespace posefusion {
namespace {

constexpr float kDegreesPerPixel = 0.3f;
constexpr float kZoomPerStep = 0.9f;
constexpr int kLeftButton = 0;
constexpr double kResizePatience = 10;  // seconds until a desktop that does not obey is given up
constexpr double kLook = 0.02;          // seconds between two checks of the run while there is nothing to draw

}  // namespace

Viewer::Viewer(Window& window, RunSession& session, RunConfig& config, std::optional<std::vector<ScriptStep>> script)
    : window_(window),
      session_(session),
      config_(config),
      script_(std::move(script)),
      context_(session.slam().context()),
      drawer_(*context_, window),
      scene_(*context_, drawer_.pass()),
      gui_(*context_, window, drawer_.pass(), drawer_.images()),
      panels_(config),
      pace_(context_->renderer_shares_queue()),
      feed_(session.recording().intrinsics()),
      playback_(!script_),
      run_(session, feed_, playback_) {
    if (config.objects) scene_.tint_objects();
    connect_window();
}

Viewer::~Viewer() {
    run_.stop();
    if (saving_.valid()) saving_.wait();
    drawer_.wait();
    window_.set_handlers({});
}

double Viewer::now() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
}

double Viewer::median_draw_ms() const {
    if (draw_times_.empty()) return 0;
    std::vector<float> times = draw_times_;
    return static_cast<double>(upper_median(times));
}

void Viewer::connect_window() {
    Window::Handlers handlers;
    handlers.any = [this] { pace_.touched(now()); };
    handlers.key = [this](int key) {
        if (const auto action = action_of_key(key)) act(*action);
    };
    handlers.drag = [this](int button, double dx, double dy) {
        const auto x = static_cast<float>(dx), y = static_cast<float>(dy);
        if (button == kLeftButton) {
            settings_.camera.orbit(kDegreesPerPixel * x, kDegreesPerPixel * y);
        } else {
            const float height = static_cast<float>(std::max(1, window_.size().height));
            settings_.camera.pan(-x / height, -y / height);
        }
    };
    handlers.scroll = [this](double steps) {
        settings_.camera.zoom(std::pow(kZoomPerStep, static_cast<float>(steps)));
    };
    window_.set_handlers(std::move(handlers));
}

void Viewer::run() {
    run_.start();
    while (!close_ && !window_.close_wanted() && !interrupted()) {
        collect_news();
        if (script_ && !follow_script()) break;
        if (close_) break;
        if (coarse_ && (run_.ended() || playback_.holding()))
            pace_.changed();  // tracking no longer waits: draw all surfels
        const double wait = pace_.wait(now());
        if (wait > 0 || !draw()) {
            const double least = script_ ? std::min(wait, kLook) : wait;
            window_.events(std::clamp(least, 1e-3, kLook));
        } else {
            window_.events(0);
        }
    }
    run_.stop();
    collect_news();
}

void Viewer::act(ViewAction action) {
    switch (action) {
        case ViewAction::PlayPause:
            if (playback_.playing())
                playback_.pause();
            else
                playback_.play();
            break;
        case ViewAction::Step:
            playback_.step();
            break;
        case ViewAction::Reset:
            reset(playback_.playing());
            break;
        case ViewAction::NextColors:
            settings_.color_mode =
                static_cast<ColorMode>((static_cast<std::size_t>(settings_.color_mode) + 1) % kColorModes.size());
            break;
        case ViewAction::Follow:
            settings_.camera.follow(!settings_.camera.follows());
            break;
        case ViewAction::Home:
            settings_.camera.follow(false);
            settings_.camera.home();
            break;
        case ViewAction::SaveMap:
            save_map(file_for("map", "ply"), false);
            break;
        case ViewAction::SaveTrajectory:
            save_trajectory(file_for("trajectory", "txt"));
            break;
        case ViewAction::Screenshot:
            (void)save_screenshot(file_for("view", "png"));
            break;
        case ViewAction::Panels:
            settings_.panels = !settings_.panels;
            break;
        case ViewAction::Help:
            settings_.help = !settings_.help;
            break;
        case ViewAction::Close:
            close_ = true;
            break;
    }
    pace_.touched(now());
}

void Viewer::reset(bool playing) {
    run_.stop();
    drawer_.wait();
    scene_.set_snapshot(nullptr);
    newest_.reset();
    path_.clear();
    objects_.clear();
    models_of_.reset();
    objects_changed_ = true;
    panels_.clear();
    message_.clear();
    run_.restart(playing);
    pace_.changed();
}

void Viewer::parameters_changed() {
    try {
        check_config(config_);
        session_.slam().set_config(slam_config(config_));
        message_.clear();
    } catch (const Error& error) {
        message_ = error.what();
    }
}

void Viewer::set_live(const std::string& key, const std::string& value) {
    const std::vector<Option> options = option_table(config_);
    const Option& option = find_option(options, key);
    const std::string group = option.group();
    if (group != "preprocess" && group != "noise" && group != "tracking" && group != "map") {
        throw Error("'" + key + "' can only be set at the start");
    }
    option.set(value);
    parameters_changed();
    if (!message_.empty()) throw Error(message_);
}

bool Viewer::follow_script() {
    while (script_at_ < script_->size()) {
        const ScriptStep& step = (*script_)[script_at_];
        try {
            if (!do_step(step)) return true;
        } catch (const Error& error) {
            throw Error(step.where + ": " + error.what());
        }
        step_begun_ = false;
        ++script_at_;
        pace_.touched(now());
    }
    return false;
}

bool Viewer::do_step(const ScriptStep& step) {
    const std::string& verb = step.verb;
    const std::vector<std::string>& words = step.words;
    const auto number = [&](std::size_t i) { return script_number(words[i]); };
    const auto real = [&](std::size_t i) { return static_cast<float>(number(i)); };
    const auto count = [&](std::size_t i) { return static_cast<std::size_t>(number(i)); };
    const bool begin = !std::exchange(step_begun_, true);
    const auto quiet = [&] { return run_.ended() || playback_.holding(); };
    const auto check_going_on = [&] {
        if (playback_.holding()) {
            throw Error(fmt::format("the run is paused after {} and nothing will change; `play` first",
                                    counted(feed_.frames_done(), "frame")));
        }
    };
    const auto frames_done = [&](std::size_t wanted) {
        const bool ended = run_.ended();  // before its frames are counted
        if (feed_.frames_done() >= wanted) return true;
        if (ended) throw Error(fmt::format("the run has ended after {}", counted(feed_.frames_done(), "frame")));
        check_going_on();
        return false;
    };

    if (verb == "play") {
        playback_.play();
    } else if (verb == "pause") {
        if (begin) playback_.pause();
        return quiet();
    } else if (verb == "step") {
        if (begin) playback_.step(count(0));
        return quiet();
    } else if (verb == "wait") {
        return frames_done(count(0));
    } else if (verb == "wait-end") {
        if (!run_.ended()) check_going_on();
        return run_.ended();
    } else if (verb == "reset") {
        reset(false);
    } else if (verb == "orbit") {
        settings_.camera.orbit(real(0), real(1));
    } else if (verb == "pan") {
        settings_.camera.pan(real(0), real(1));
    } else if (verb == "zoom") {
        settings_.camera.zoom(real(0));
    } else if (verb == "follow" || verb == "show" || verb == "colour") {
        show(step);
    } else if (verb == "confidence") {
        settings_.min_confidence = real(0);
    } else if (verb == "set") {
        set_live(words[0], words[1]);
    } else if (verb == "resize") {
        const WindowSize wanted{static_cast<int>(number(0)), static_cast<int>(number(1))};
        if (begin) {
            window_.resize(wanted);
            resize_until_ = now() + kResizePatience;
        }
        if (window_.size() == wanted) return true;
        if (now() > resize_until_)
            throw Error(
                fmt::format("the desktop keeps the window at {} x {}", window_.size().width, window_.size().height));
        return false;
    } else if (verb == "minimise") {
        window_.minimise();
    } else if (verb == "restore") {
        window_.restore();
    } else if (verb == "key") {
        const std::optional<ViewAction> action = action_of_key_name(words[0]);
        if (!action) throw Error("there is no key '" + words[0] + "'");
        act(*action);
    } else if (verb == "draw") {
        if (begin) draw_until_ = drawer_.frames() + count(0);
        if (drawer_.frames() < *draw_until_) pace_.changed();
        return drawer_.frames() >= *draw_until_;
    } else if (verb == "screenshot") {
        return save_screenshot(words[0]);
    } else if (verb == "save-map") {
        save_map(words[0], true);
    } else if (verb == "save-trajectory") {
        save_trajectory(words[0]);
    } else {
        close_ = true;
    }
    return true;
}

void Viewer::show(const ScriptStep& step) {
    const std::string& what = step.verb == "colour" ? step.words.front() : step.words.back();
    if (step.verb == "colour") {
        const auto mode = std::find(kColorModes.begin(), kColorModes.end(), what);
        if (mode == kColorModes.end()) throw Error("there is no colour mode '" + what + "'");
        settings_.color_mode = static_cast<ColorMode>(mode - kColorModes.begin());
        return;
    }
    if (what != "on" && what != "off") throw Error("'" + what + "' is neither on nor off");
    const bool on = what == "on";
    if (step.verb == "follow") {
        settings_.camera.follow(on);
        return;
    }
    const auto shown = std::find_if(kVisibilities.begin(), kVisibilities.end(),
                                    [&](const Visibility& v) { return step.words.front() == v.name; });
    if (shown == kVisibilities.end()) throw Error("'" + step.words.front() + "' is nothing that can be shown");
    settings_.*shown->field = on;
}

void Viewer::collect_news() {
    FrameFeed::News all = feed_.collect();
    for (FrameNews& news : all.frames) {
        path_.push_back(news.T_world_camera.translation().cast<float>());
        panels_.add(news);
        objects_.add(news);
        objects_changed_ = true;
        newest_ = std::move(news);
        pace_.changed();
    }
    if (all.corrected) {
        path_.clear();
        for (const StampedPose& pose : *all.corrected) path_.push_back(pose.T_world_camera.translation().cast<float>());
        objects_.correct(*all.corrected);
        pace_.changed();
    }
    if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
        message_ = saving_.get();
        pace_.changed();
    }
    if (run_.ended() && !run_.record().error.empty() && message_.empty()) message_ = run_.record().error;
}

bool Viewer::draw(bool with_screenshot) {
    const WindowSize size = window_.size();
    if (size.width <= 0 || size.height <= 0) return false;
    drawer_.wait();
    if (drawer_.frames() > draw_times_.size()) {
        draw_times_.push_back(static_cast<float>(drawer_.device_ms()));
        pace_.finished(drawer_.device_ms() / 1000, surfels_drawn_);
    }
    if (auto snapshot = session_.slam().snapshot()) scene_.set_snapshot(std::move(snapshot));
    update_objects();
    update_lines();

    gui_.begin();
    PanelResult done = panels_.show(settings_, panel_facts());
    SceneView view = scene_view(size);
    view.centre = done.centre;
    if (settings_.objects) draw_labels(object_labels(view));
    gui_.end();
    const bool tracking = !run_.ended() && !playback_.holding();
    const std::uint32_t slots = scene_.snapshot() == nullptr ? 0 : scene_.snapshot()->slots,
                        of_objects = scene_.object_surfels();
    if (!with_screenshot) view.stride = pace_.stride(slots + of_objects, tracking);
    surfels_drawn_ = ((settings_.map ? slots : 0) + (settings_.objects ? of_objects : 0)) / view.stride;
    const bool drawn = drawer_.draw(
        size,
        [&](VkCommandBuffer commands) {
            scene_.enqueue(commands, view, done.tiles);
            gui_.enqueue(commands);
        },
        with_screenshot);
    if (drawn) pace_.drawn(now(), tracking);
    if (drawn && view.stride > 1) coarse_ = true;
    if (drawn && view.stride == 1) coarse_ = false;
    if (done.parameters_changed) parameters_changed();
    for (const ViewAction action : done.actions) act(action);
    return drawn;
}

PanelFacts Viewer::panel_facts() const {
    PanelFacts facts;
    facts.newest = newest_ ? &*newest_ : nullptr;
    facts.objects = &objects_.all();
    facts.camera = session_.recording().intrinsics();
    facts.frames_total = session_.frames_to_do();
    facts.ended = run_.ended();
    facts.playing = playback_.playing() && !facts.ended;
    facts.real_time = session_.real_time();
    facts.message = message_;
    facts.frames_drawn = drawer_.frames();
    facts.draw_ms = drawer_.device_ms();
    return facts;
}

SceneView Viewer::scene_view(WindowSize size) const {
    SceneView view;
    const Eigen::Isometry3d pose = newest_ ? newest_->T_world_camera : Eigen::Isometry3d::Identity();
    view.T_camera_world = settings_.camera.T_camera_world(to_glm(pose.cast<float>()));
    view.size = {size.width, size.height};
    view.color_mode = settings_.color_mode;
    view.min_confidence = settings_.min_confidence;
    view.stable_confidence = config_.slam.map.stable_confidence;
    view.show_map = settings_.map;
    view.show_objects = settings_.objects;
    return view;
}

/// While the run goes on it hands over models when it can; while it waits they are read from it.
void Viewer::update_objects() {
    if (!config_.objects) return;
    const bool ended = run_.ended(), quiet = ended || playback_.holding();
    if (auto models = feed_.take_models()) {
        objects_.set_models(std::move(*models));
        objects_changed_ = true;
    }
    if (quiet && newest_ && models_of_ != newest_->number) {
        if (!ended || run_.record().error.empty()) objects_.set_models(session_.object_maps(false));
        models_of_ = newest_->number;
        objects_changed_ = true;
    }
    if (std::exchange(objects_changed_, false)) scene_.set_objects(objects_.surfels());
}

/// Beside each object that is tracked.
std::vector<SceneLabel> Viewer::object_labels(const SceneView& view) const {
    std::vector<SceneLabel> labels;
    for (const ShownObject& object : objects_.all()) {
        if (!object.T_world_object) continue;
        const auto pixel = pixel_of(to_glm(Eigen::Vector3f(object.T_world_object->translation())), view);
        if (pixel) labels.push_back({std::to_string(object.label), label_color(object.label), *pixel});
    }
    return labels;
}

void Viewer::update_lines() {
    std::vector<Segment> lines;
    if (settings_.path) add_trajectory(lines, path_);
    if (settings_.objects) add_object_paths(lines, objects_.all());
    if (newest_ && settings_.frustum) {
        add_frustum(lines, newest_->T_world_camera.cast<float>(), session_.recording().intrinsics(),
                    has_pose(newest_->result.tracking));
    }
    if (newest_ && settings_.skeletons) add_skeletons(lines, newest_->skeletons);
    scene_.set_segments(lines);
}

bool Viewer::up_to_date() const {
    if (!run_.ended() && !playback_.holding()) return true;  // there is always more to come
    const std::size_t done = feed_.frames_done();
    if (done == 0) return true;
    return newest_ && newest_->number + 1 == done && scene_.snapshot() != nullptr &&
           scene_.snapshot()->frame + 1 == done && (!config_.objects || models_of_ == newest_->number);
}

std::filesystem::path Viewer::file_for(const std::string& what, const std::string& ending) const {
    const std::size_t frames = newest_ ? newest_->number + 1 : 0;
    std::filesystem::path file;
    for (int i = 0; i == 0 || std::filesystem::exists(file); ++i) {
        file = config_.out / fmt::format("{}-{:06}{}.{}", what, frames, i == 0 ? "" : fmt::format("-{}", i), ending);
    }
    return file;
}

void Viewer::save_map(const std::filesystem::path& file, bool wait) {
    if (saving_.valid()) saving_.wait();
    saving_ = std::async(std::launch::async, [this, file]() -> std::string {
        try {
            if (file.has_parent_path()) prepare_output_folder(file.parent_path());
            const std::vector<Surfel> surfels = session_.slam().surfels(!config_.all_surfels);
            write_ply(file, surfels, {"made by PoseFusion " POSEFUSION_VERSION});
            return fmt::format("saved {} surfels to {}", surfels.size(), file.string());
        } catch (...) {
            return error_text(std::current_exception());
        }
    });
    message_ = "saving " + file.string();
    if (!wait) return;
    message_ = saving_.get();
    if (!std::filesystem::exists(file)) throw Error(message_);
}

void Viewer::save_trajectory(const std::filesystem::path& file) {
    try {
        if (file.has_parent_path()) prepare_output_folder(file.parent_path());
        write_trajectory(file, feed_.trajectory());
        message_ = "saved " + file.string();
    } catch (const Error& error) {
        if (script_) throw;
        message_ = error.what();
    }
}

bool Viewer::save_screenshot(const std::filesystem::path& file) {
    try {
        collect_news();
        if (!draw() || !draw(true)) return false;  // a new panel is only visible from its second frame on
        if (script_ && !up_to_date()) return false;
        const std::optional<ColorImage> image = drawer_.screenshot();
        if (!image) throw Error("this display does not let pictures of its windows be taken");
        if (file.has_parent_path()) prepare_output_folder(file.parent_path());
        write_png(file, *image);
        message_ = "saved " + file.string();
    } catch (const Error& error) {
        if (script_) throw;
        message_ = error.what();
    }
    return true;
}

}  // namespace posefusion
