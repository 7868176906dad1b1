#include "hosts/python/options.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/config/config_file.hpp"
#include "hosts/config/option_table.hpp"
#include "hosts/python/paths.hpp"

namespace posefusion::python {
namespace {

namespace py = pybind11;

/// Of the options without a group those that count for images given as arrays. The others name files of a run, or how
/// it reads and writes them.
constexpr std::array<std::string_view, 12> kForArrays{"no_people", "no_motion",    "objects",        "no_loops",
                                                      "masks",     "mask_network", "mask_threshold", "classes",
                                                      "device",    "scale",        "load_map",       "localise_only"};

bool is_list(const py::handle& value) { return py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value); }

std::string text_of(const py::handle& value);

std::string list_text(const py::handle& values) {
    std::string joined;
    for (const py::handle element : values) {
        if (is_list(element)) throw Error("a list may only hold plain values");
        joined += (joined.empty() ? "" : ",") + text_of(element);
    }
    return joined;
}

/// A value as the text that Option::set() expects.
std::string text_of(const py::handle& value) {
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
    if (value.is_none()) return "";
    if (is_list(value)) return list_text(value);
    return py::str(value);
}

void set_option(const std::string& key, const py::handle& value, const std::vector<Option>& table) {
    const Option& option = find_option(table, key);
    try {
        if (option.group().empty() && std::find(kForArrays.begin(), kForArrays.end(), key) == kForArrays.end()) {
            throw Error(key == "save_map" ? "call save_map() when the map is to be saved"
                                          : "is for the files of `posefusion run` and means nothing here");
        }
        option.set(text_of(value));
    } catch (const Error& error) {
        throw Error(key + ": " + error.what());
    }
}

void set_options(const py::dict& values, const std::vector<Option>& table) {
    for (const auto& [name, value] : values) {
        const std::string key = py::str(name);
        if (!py::isinstance<py::dict>(value)) {
            set_option(key, value, table);
            continue;
        }
        for (const auto& [name_in_group, value_in_group] : py::reinterpret_borrow<py::dict>(value)) {
            const std::string whole_key = key + "." + std::string(py::str(name_in_group));
            if (py::isinstance<py::dict>(value_in_group)) throw Error(whole_key + ": is no group of options");
            set_option(whole_key, value_in_group, table);
        }
    }
}

}  // namespace

RunConfig config_of(const py::object& config, const py::dict& options) {
    RunConfig result;
    const std::vector<Option> table = option_table(result);
    if (py::isinstance<py::dict>(config)) {
        set_options(config.cast<py::dict>(), table);
    } else if (!config.is_none()) {
        load_config(path_of(config), table);
    }
    set_options(options, table);
    check_config(result);
    return result;
}

}  // namespace posefusion::python
