#include "hosts/export/unfinished_folder.hpp"

#include <unistd.h>

#include <string>

#include "engine/core/error.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// "DIR/" is the folder DIR.
fs::path without_slash(const fs::path& path) { return path.has_filename() ? path : path.parent_path(); }

void expect_free(const fs::path& place) {
    std::error_code error;
    if (!fs::exists(place, error)) return;
    if (!fs::is_directory(place, error))
        throw Error(place.string() + ": a file of this name is in the way; choose another folder");
    if (!fs::is_empty(place, error) || error)
        throw Error(place.string() + ": the folder is not empty; choose another one, or remove it");
}

}  // namespace

UnfinishedFolder::UnfinishedFolder(const fs::path& place)
    : place_(without_slash(place)), path_(place_.string() + ".tmp-" + std::to_string(::getpid())) {
    expect_free(place_);
    prepare_output_folder(path_);
}

UnfinishedFolder::~UnfinishedFolder() {
    std::error_code ignored;
    if (!finished_) fs::remove_all(path_, ignored);
}

void UnfinishedFolder::finish() {
    std::error_code error;
    fs::rename(path_, place_, error);
    if (error) throw Error(place_.string() + ": cannot be made: " + error.message() + "; choose another folder");
    finished_ = true;
}

}  // namespace posefusion
