#include "hosts/python/options.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/config/config_file.hpp"
#include "hosts/config/option_table.hpp"

namespace posefusion::python {
namespace {

namespace py = pybind11;

/// A value as the text that Option::set() expects.
std::string text_of(const py::handle& value) {
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
    if (value.is_none()) return "";
    if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
        std::string joined;
        for (const py::handle element : value) joined += (joined.empty() ? "" : ",") + text_of(element);
        return joined;
    }
    return py::str(value);
}

void set_options(const py::dict& values, const std::string& prefix, const std::vector<Option>& table) {
    for (const auto& [name, value] : values) {
        const std::string key = prefix + std::string(py::str(name));
        if (py::isinstance<py::dict>(value)) {
            set_options(py::reinterpret_borrow<py::dict>(value), key + ".", table);
            continue;
        }
        const Option& option = find_option(table, key);
        try {
            option.set(text_of(value));
        } catch (const Error& error) {
            throw Error(key + ": " + error.what());
        }
    }
}

}  // namespace

RunConfig config_of(const py::object& config, const py::dict& options) {
    RunConfig result;
    const std::vector<Option> table = option_table(result);
    if (py::isinstance<py::dict>(config)) {
        set_options(config.cast<py::dict>(), "", table);
    } else if (!config.is_none()) {
        load_config(std::string(py::str(config)), table);
    }
    set_options(options, "", table);
    check_config(result);
    return result;
}

}  // namespace posefusion::python
