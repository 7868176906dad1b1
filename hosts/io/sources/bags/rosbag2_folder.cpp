#include "hosts/io/sources/bags/rosbag2_folder.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <string>

#include "engine/core/error.hpp"
#include "hosts/io/sources/bags/open_bag.hpp"
#include "hosts/io/text_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr const char *kMetadataFile = "metadata.yaml", *kMetadataKey = "rosbag2_bagfile_information";
constexpr std::uintmax_t kMaxMetadataBytes = std::uintmax_t{1} << 24;

/// Of the bag, by name. (The order in which messages were recorded is told by their times.)
std::vector<fs::path> bag_files(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const fs::path& file = entry.path();
        if (file.extension() != ".bag" && is_bag_file(file) && entry.is_regular_file(error)) files.push_back(file);
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// The files that the metadata names. Throws Error: not to be read.
std::vector<fs::path> named_files(const fs::path& metadata) {
    std::vector<fs::path> files;
    try {
        const YAML::Node root = YAML::Load(read_text_file(metadata, kMaxMetadataBytes));
        for (const auto& path : root[kMetadataKey]["relative_file_paths"])
            files.push_back(fs::path(path.as<std::string>()).filename());  // early ones name the folder, too
    } catch (const YAML::Exception& error) {
        throw Error(metadata.string() + ": is damaged: " + printable(error.msg));
    }
    return files;
}

bool names_a_bag(const fs::path& metadata) {
    std::error_code error;
    if (!fs::is_regular_file(metadata, error)) return false;
    try {
        return read_text_file(metadata, kMaxMetadataBytes).find(kMetadataKey) != std::string::npos;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

bool is_rosbag2_folder(const fs::path& folder) {
    return names_a_bag(folder / kMetadataFile) || !bag_files(folder).empty();
}

Rosbag2Folder::Rosbag2Folder(const fs::path& folder) : MessageBag(folder.string()) {
    const fs::path metadata = folder / kMetadataFile;
    std::vector<fs::path> files = bag_files(folder);
    std::error_code error;
    if (fs::exists(metadata, error)) {
        try {
            for (const fs::path& file : named_files(metadata))
                if (!fs::exists(folder / file, error))
                    add_warning((folder / file).string() + ": is named by " + kMetadataFile +
                                " and is missing; is the copy complete?");
        } catch (const Error& fault) {
            add_warning(std::string(fault.what()) + "; the bag files in the folder are read");
        }
    } else {
        add_warning(name() + ": has no " + kMetadataFile +
                    ", as when a recording was interrupted; the bag files in it " + "are read");
    }
    if (files.empty()) throw Error(warnings().empty() ? name() + ": holds no .db3 or .mcap file" : warnings().front());

    std::string first_fault;
    for (const fs::path& file : files) {
        try {
            add_file(file);
        } catch (const Error& fault) {
            if (first_fault.empty()) first_fault = fault.what();
            add_warning(std::string(fault.what()) + "; this file is left out");
        }
    }
    if (files_.empty()) throw Error(first_fault);
    finish();
}

void Rosbag2Folder::add_file(const fs::path& file) {
    const auto part = static_cast<std::uint32_t>(files_.size());
    std::unique_ptr<MessageBag> bag = open_bag_file(file);
    std::map<std::uint32_t, std::uint32_t> numbers;  // a topic may have another number in each file
    for (const auto& [number, connection] : bag->connections()) {
        numbers[number] = static_cast<std::uint32_t>(connections().size());
        add_connection(numbers[number], connection);
    }
    const auto& messages = bag->messages();
    for (std::size_t i = 0; i < messages.size(); ++i) {
        const auto number = numbers.find(messages[i].connection);
        if (number != numbers.end()) add_message({number->second, part, i, messages[i].recorded});
    }
    for (const std::string& warning : bag->warnings()) add_warning(warning);
    files_.push_back(std::move(bag));
}

ByteBuffer Rosbag2Folder::read_bytes(const Message& message, std::size_t at_most) const {
    const MessageBag& file = *files_.at(message.part);
    return file.read(file.messages().at(message.place), at_most).bytes;
}

}  // namespace posefusion
