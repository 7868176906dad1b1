#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hosts/evaluate/evaluation.hpp"

/// Evaluations as text and as JSON.
namespace posefusion {
namespace {

using Json = nlohmann::ordered_json;

std::string row(const char* name, const ErrorStatistics& s, double factor, const std::string& unit) {
    return fmt::format("{:<18} {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f}  {:<6} {}\n", name, s.rmse * factor,
                       s.mean * factor, s.median * factor, s.std * factor, s.min * factor, s.max * factor, unit,
                       s.count);
}

Json to_json(const ErrorStatistics& s) {
    return {{"pairs", s.count}, {"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
            {"std", s.std},     {"min", s.min},   {"max", s.max}};
}

/// Whether the errors are per second, as by default.
bool is_one_second(const RelativeErrorConfig& c) { return c.unit == DeltaUnit::Seconds && c.delta == 1; }

std::string pairs_text(const RelativeErrorConfig& c) {
    const bool all = c.all_pairs || c.unit == DeltaUnit::Seconds;
    return fmt::format("{} pairs of poses {} {} apart", all ? "all" : "consecutive", c.delta,
                       c.unit == DeltaUnit::Frames && c.delta == 1 ? "frame" : name_of(c.unit));
}

}  // namespace

std::string evaluation_table(const Evaluation& e) {
    constexpr double kCentimetres = 100;
    std::string text = fmt::format("{:<18} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}  {:<6} {}\n", "", "RMSE", "mean",
                                   "median", "std", "min", "max", "unit", "pairs");
    text += row("ATE translation", e.ate.translation, kCentimetres, "cm");
    const char* per_second = is_one_second(e.config.rpe) ? "/s" : "";
    if (e.rpe) {
        text += row("RPE translation", e.rpe->translation, kCentimetres, std::string("cm") + per_second);
        text += row("RPE rotation", e.rpe->rotation, 1, std::string("deg") + per_second);
        if (!is_one_second(e.config.rpe)) text += "RPE: " + pairs_text(e.config.rpe) + "\n";
    } else if (is_one_second(e.config.rpe)) {
        text += "RPE: the estimate is too short for two pairs of poses one second apart\n";
    } else {
        text += "RPE: the estimate is too short for " + pairs_text(e.config.rpe) + "\n";
    }
    text += fmt::format("path {:.3f} m{}, never farther than {:.2f} cm from the start\n", e.path_length,
                        e.duration ? fmt::format(" in {:.2f} s", *e.duration) : "",
                        e.max_distance_from_start * kCentimetres);
    return text;
}

std::string evaluation_json(const Evaluation& e) {
    Json json;
    json["ate"]["translation_m"] = to_json(e.ate.translation);
    json["ate"]["rotation_deg"] = to_json(e.ate.rotation);
    json["ate"]["alignment"] = name_of(e.config.alignment.rule);
    json["ate"]["scale"] = e.ate.scale;
    if (e.rpe) {
        const std::string per = is_one_second(e.config.rpe) ? "_per_s" : "";
        json["rpe"]["translation_m" + per] = to_json(e.rpe->translation);
        json["rpe"]["rotation_deg" + per] = to_json(e.rpe->rotation);
        json["rpe"]["delta"] = e.config.rpe.delta;
        json["rpe"]["delta_unit"] = name_of(e.config.rpe.unit);
    } else {
        json["rpe"] = nullptr;
    }
    json["matching"] = {{"rule", name_of(e.config.matching.rule)},
                        {"max_difference_s", to_seconds(e.config.matching.max_difference)}};
    json["path_length_m"] = e.path_length;
    json["duration_s"] = e.duration ? Json(*e.duration) : Json(nullptr);
    json["max_distance_from_start_m"] = e.max_distance_from_start;
    return json.dump(2) + "\n";
}

}  // namespace posefusion
