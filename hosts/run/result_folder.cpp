#include "hosts/run/result_folder.hpp"

#include <array>
#include <fstream>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/io/sources/tum_source.hpp"
#include "hosts/run/background.hpp"
#include "hosts/run/checkpoint.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr const char* kConfiguration = "config.yaml";  // written first: it marks the folder as the output of a run
constexpr std::array kResults{"trajectory.txt",      "map.ply",   "stats.json",     "people.json",  "report.html",
                              "camera_refined.yaml", "loops.png", "trajectory.png", "map_view.png", "map.png"};

bool same_place(const fs::path& a, const fs::path& b) {
    std::error_code error;
    return fs::equivalent(a, b, error) && !error;
}

bool holds_files(const fs::path& folder) {
    std::error_code error;
    const fs::directory_iterator entries(folder, error);
    return !error && entries != fs::directory_iterator();
}

bool is_there(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(path, ignored);
}

bool has_line(const fs::path& file, const std::string& beginning) {
    std::ifstream lines(file);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with(beginning)) return true;
    }
    return false;
}

}  // namespace

PieceFiles files_of_piece(std::size_t piece) {
    const std::string number = std::to_string(piece + 1);
    return {"trajectory-" + number + ".txt", "map-" + number + ".ply"};
}

ResultFolder::ResultFolder(const RunConfig& config, const fs::path& recording)
    : config_(config), recording_exists_(is_there(recording)) {
    if (is_tum_folder(config_.out) || same_place(config_.out, recording))
        throw Error(config_.out.string() + ": holds a recording; choose another folder for the results with --out");
    std::error_code error;
    if (!fs::is_directory(config_.out, error)) return;
    lock_.emplace(config_.out);
    check_masks();
    if (config_.save_background && holds_files(background()) && !is_ours("save_background"))
        throw Error(background().string() + ": holds files that no earlier run saved here; choose another --out");
}

void ResultFolder::check_masks() const {
    if (!config_.save_masks) return;
    if (!config_.masks.empty() && (same_place(config_.masks, masks()) || same_place(config_.masks, config_.out)))
        throw Error(masks().string() +
                    ": --save-masks would replace the masks that --masks reads; choose another --out");
    if (!config_.resume && holds_files(masks()) && !is_ours("save_masks"))
        throw Error(masks().string() + ": holds files that no earlier run saved here; choose another --out");
}

ResultFolder::~ResultFolder() {
    std::error_code ignored;
    if (!made_ || begun_) return;
    for (const fs::path& folder : {masks(), config_.out}) fs::remove(folder, ignored);  // if they are empty
}

void ResultFolder::open() {
    std::error_code error;
    made_ = !fs::exists(config_.out, error);
    prepare_output_folder(config_.out);
    if (!lock_) lock_.emplace(config_.out);
    if (config_.save_masks) prepare_output_folder(masks());
    if (config_.save_map.has_parent_path()) prepare_output_folder(config_.save_map.parent_path());
}

void ResultFolder::begin(const std::string& configuration) {
    if (begun_) return;
    begun_ = true;
    const fs::path marker = config_.out / kConfiguration;
    if (fs::exists(marker)) {
        if (!config_.resume && is_ours("save_masks")) remove_masks();
        if (is_ours("save_background")) remove_background(background());
        if (is_ours("objects")) remove_objects();
        for (const char* name : kResults) remove(name);
        std::error_code error;
        for (std::size_t piece = 1; fs::exists(config_.out / files_of_piece(piece).trajectory, error); ++piece) {
            remove(files_of_piece(piece).trajectory);
            remove(files_of_piece(piece).map);
        }
    }
    write_file_atomically(marker, configuration);
}

void ResultFolder::leave_failure(const std::string& configuration, const std::string& stats) {
    if (!recording_exists_ || is_there(config_.out / "trajectory.txt") || is_there(checkpoint_file(config_))) return;
    try {
        open();
        begin(configuration);
        write_file_atomically(config_.out / "stats.json", stats);
    } catch (const Error&) {  // there is an error to tell already
    }
}

void ResultFolder::remove(const std::string& name) const {
    std::error_code ignored;
    fs::remove(config_.out / name, ignored);
    remove_unfinished(config_.out / name);
}

void ResultFolder::finish() const {
    std::error_code ignored;
    if (config_.checkpoint_every == 0 && !config_.resume) fs::remove(checkpoint_file(config_), ignored);
}

bool ResultFolder::is_ours(const std::string& option) const {
    const fs::path folder = option == "save_masks" ? masks() : option == "objects" ? objects() : background();
    return !fs::is_symlink(folder) && has_line(config_.out / kConfiguration, option + ": true");
}

void ResultFolder::remove_masks() const {
    std::error_code ignored;
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(masks(), ignored)) {
        if (entry.path().extension() == ".png") files.push_back(entry.path());
    }
    for (const fs::path& file : files) fs::remove(file, ignored);
    if (!config_.save_masks) fs::remove(masks(), ignored);  // if it is empty
}

/// Only what runs write there, and folders that are empty then.
void ResultFolder::remove_objects() const {
    std::error_code ignored;
    std::vector<fs::path> folders;
    for (const fs::directory_entry& entry : fs::directory_iterator(objects(), ignored)) folders.push_back(entry.path());
    for (const fs::path& folder : folders) {
        for (const char* name : {"trajectory.txt", "map.ply"}) fs::remove(folder / name, ignored);
        fs::remove(folder, ignored);
    }
    fs::remove(objects(), ignored);
}

}  // namespace posefusion
