#include "hosts/config/config_file.hpp"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <iterator>
#include <set>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

std::string read_text(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream || !std::filesystem::is_regular_file(file)) {
        throw Error(file.string() + ": the configuration file cannot be read; check the path");
    }
    return {std::istreambuf_iterator<char>(stream), {}};
}

YAML::Node parse_yaml(const std::filesystem::path& file) {
    try {
        return YAML::Load(read_text(file));
    } catch (const YAML::ParserException& e) {
        throw Error(file.string() + ":" + std::to_string(e.mark.line + 1) + ": not valid YAML: " + e.msg);
    }
}

/// A value as the text that Option::set() expects.
std::string value_text(const YAML::Node& value) {
    if (!value.IsSequence()) return value.IsNull() ? "" : value.Scalar();
    std::string joined;
    for (const YAML::Node& element : value) {
        if (!element.IsScalar()) throw Error("a list may only hold plain values");
        joined += (joined.empty() ? "" : ",") + element.Scalar();
    }
    return joined;
}

class Loader {
public:
    Loader(const std::filesystem::path& file, const std::vector<Option>& options) : file_(file), options_(options) {}

    void visit(const YAML::Node& map, const std::string& prefix) {
        for (const auto& entry : map) {
            const std::string key = prefix + entry.first.as<std::string>("");
            if (!entry.second.IsMap()) {
                set(key, entry);
            } else if (prefix.empty()) {
                visit(entry.second, key + ".");
            } else {  // which may hold itself, by an alias
                throw Error(place(entry) + key + ": is no group of options");
            }
        }
    }

private:
    void set(const std::string& key, const YAML::detail::iterator_value& entry) {
        try {
            const Option& option = find_option(options_, key);
            if (!seen_.insert(key).second) throw Error("given twice");
            option.set(value_text(entry.second));
        } catch (const Error& error) {
            throw Error(place(entry) + key + ": " + error.what());
        }
    }

    [[nodiscard]] std::string place(const YAML::detail::iterator_value& entry) const {
        return file_.string() + ":" + std::to_string(entry.first.Mark().line + 1) + ": ";
    }

    const std::filesystem::path& file_;
    const std::vector<Option>& options_;
    std::set<std::string> seen_;
};

std::string yaml_value(const Option& option) {
    const std::string value = option.get();
    switch (option.kind) {
        case Option::Kind::Text: {
            YAML::Emitter quoted;
            quoted << YAML::DoubleQuoted << value;
            return quoted.c_str();
        }
        case Option::Kind::List:
            return "[" + value + "]";
        default:
            return value;
    }
}

}  // namespace

void load_config(const std::filesystem::path& file, const std::vector<Option>& options) {
    const YAML::Node root = parse_yaml(file);
    if (root.IsNull()) return;  // an empty file sets nothing
    if (!root.IsMap()) throw Error(file.string() + ": expected lines of the form `key: value`");
    Loader(file, options).visit(root, "");
}

std::string config_yaml(const std::vector<Option>& options) {
    std::string text, group;
    for (const Option& option : options) {
        if (option.group() != group) {
            group = option.group();
            text += "\n" + group + ":\n";
        }
        text += (group.empty() ? "" : "  ") + option.name() + ": " + yaml_value(option) + "  # " +
                (option.unit.empty() ? "" : "[" + option.unit + "] ") + option.help + "\n";
    }
    return text;
}

}  // namespace posefusion
