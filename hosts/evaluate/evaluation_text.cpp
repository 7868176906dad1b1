#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "hosts/evaluate/evaluation.hpp"

/// Evaluations for people and for programs.
namespace posefusion {
namespace {

using Json = nlohmann::ordered_json;

template <class... Values>
std::string format(const char* pattern, Values... values) {
    std::array<char, 256> text{};
    std::snprintf(text.data(), text.size(), pattern, values...);
    return text.data();
}

std::string row(const char* name, const ErrorStatistics& s, double factor, const char* unit) {
    return format("%-18s %9.4f %9.4f %9.4f %9.4f %9.4f %9.4f  %-6s %zu\n", name, s.rmse * factor, s.mean * factor,
                  s.median * factor, s.std * factor, s.min * factor, s.max * factor, unit, s.count);
}

Json to_json(const ErrorStatistics& s) {
    return {{"pairs", s.count}, {"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
            {"std", s.std},     {"min", s.min},   {"max", s.max}};
}

}  // namespace

std::string evaluation_table(const Evaluation& e) {
    constexpr double kCentimetres = 100;
    std::string text = format("%-18s %9s %9s %9s %9s %9s %9s  %-6s %s\n", "", "RMSE", "mean", "median", "std", "min",
                              "max", "unit", "pairs");
    text += row("ATE translation", e.ate.translation, kCentimetres, "cm");
    if (e.rpe) {
        text += row("RPE translation", e.rpe->translation, kCentimetres, "cm/s");
        text += row("RPE rotation", e.rpe->rotation, 1, "deg/s");
    } else {
        text += "RPE: the estimate is too short for two pairs of poses one second apart\n";
    }
    text += format("path %.3f m in %.2f s, never farther than %.2f cm from the start\n", e.path_length, e.duration,
                   e.max_distance_from_start * kCentimetres);
    return text;
}

std::string evaluation_json(const Evaluation& e) {
    Json json;
    json["ate"]["translation_m"] = to_json(e.ate.translation);
    if (e.rpe) {
        json["rpe"]["translation_m_per_s"] = to_json(e.rpe->translation);
        json["rpe"]["rotation_deg_per_s"] = to_json(e.rpe->rotation);
    } else {
        json["rpe"] = nullptr;
    }
    json["path_length_m"] = e.path_length;
    json["duration_s"] = e.duration;
    json["max_distance_from_start_m"] = e.max_distance_from_start;
    return json.dump(2) + "\n";
}

}  // namespace posefusion
