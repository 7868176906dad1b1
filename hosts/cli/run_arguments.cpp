#include "hosts/cli/run_arguments.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "hosts/cli/help_formatter.hpp"
#include "hosts/config/config_file.hpp"

namespace posefusion {
namespace {

void set(const Option& option, const std::string& text) {
    try {
        option.set(text);
    } catch (const Error& error) {
        throw CLI::ValidationError(option.flag(), error.what());
    }
}

}  // namespace

RunArguments::RunArguments(CLI::App& app, std::span<const std::string_view> without_effect)
    : options_(in_help_order(option_table(config))) {
    app.add_option("RECORDING", recording, kSourceHelp)->required()->type_name("");
    app.add_option("--config", file_, "YAML file with options; the command line overrides it")->type_name("PATH");
    const auto has_effect = [&](const Option& option) {
        return std::find(without_effect.begin(), without_effect.end(), option.key) == without_effect.end();
    };
    std::stable_partition(options_.begin(), options_.end(), has_effect);
    for (const Option& option : options_) declare(app, option, has_effect(option) ? option.heading() : kWithoutEffect);
}

void RunArguments::declare(CLI::App& app, const Option& option, const std::string& heading) {
    Declared declared{nullptr, nullptr};
    const std::string help = description(option);
    if (option.kind == Option::Kind::Switch) {
        declared.option = app.add_flag(option.flag(), help);
    } else {
        declared.option = app.add_option(option.flag(), help)->type_name(placeholder(option));
    }
    declared.option->group(heading);
    if (const std::string no = negation(option); !no.empty()) {
        declared.negation = app.add_flag(no)->group("");  // not shown in the help
    }
    declared_.push_back(declared);
}

void RunArguments::keep_results_of_file() const {
    const std::filesystem::path folder = std::filesystem::absolute(file_).parent_path();
    std::error_code error;
    if (!std::filesystem::equivalent(config.out, folder, error) || error)
        return;  // not the configuration of that folder's run
    const auto left_to_file = [&](const std::string& key) {
        const auto option =
            std::find_if(options_.begin(), options_.end(), [&](const Option& o) { return o.key == key; });
        const CLI::Option* given = declared_[static_cast<std::size_t>(option - options_.begin())].option;
        return given->count() == 0 && given->get_group() != kWithoutEffect;
    };
    if (!left_to_file("resume")) return;  // the same run continues
    if (left_to_file("out"))
        throw Error(file_ + ": belongs to the results in " + config.out.string() + "; give --out FOLDER for new ones");
    if (left_to_file("save_map") && !config.save_map.empty() && std::filesystem::exists(config.save_map))
        throw Error(file_ + ": belongs to a run that saved " + config.save_map.string() +
                    "; give --save-map FILE for the new map");
}

void RunArguments::apply() {
    if (!file_.empty()) {
        load_config(file_, options_);
        keep_results_of_file();
    }
    for (std::size_t i = 0; i < options_.size(); ++i) {
        const Declared& given = declared_[i];
        if (given.negation != nullptr && given.negation->count() > 0) {
            if (given.option->count() > 0)
                throw CLI::ValidationError(negation(options_[i]), "contradicts " + options_[i].flag());
            options_[i].set("false");
        }
        if (given.option->count() > 0) set(options_[i], given.option->results().back());
    }
    check_config(config);
}

}  // namespace posefusion
