#include "tools/evaluate_objects/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.hpp"
#include "hosts/evaluate/alignment.hpp"
#include "hosts/io/recording.hpp"
#include "tools/evaluate_objects/run_objects.hpp"
#include "tools/evaluate_objects/true_masks.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr double kPercent = 100, kCentimetres = 100, kMillimetres = 1000;

std::string cell(bool there, double value, int decimals) {
    return there ? fmt::format("{:9.{}f}", value, decimals) : fmt::format("{:>9}", "-");
}

}  // namespace

ObjectEvaluation evaluate_objects(const fs::path& folder, const fs::path& run, const MotionConfig& motion) {
    const Recording recording(folder);
    const TrueMasks truth(recording);
    if (!fs::is_directory(run / "masks")) throw Error(run.string() + ": has no masks; make the run with --save-masks");
    const MaskFolder estimated(run / "masks", recording);
    const std::vector<TrueObject> objects = read_true_objects(folder);
    const std::vector<EstimatedObject> models = read_run_objects(run);
    ObjectStates states(objects, motion);

    ObjectEvaluation evaluation;
    for (const auto& frame : recording.frames()) {
        const auto is = truth.of(frame.stamp), said = estimated.load_as_recorded(frame.stamp);
        if (!is || !said) continue;
        add_frame(evaluation.masks, *said, *is, states.at(frame.stamp, *is));
        ++evaluation.frames;
    }
    if (evaluation.frames == 0) throw Error(run.string() + ": no mask has a true one of the same time");

    evaluation.has_objects = fs::is_directory(run / "objects");
    if (!evaluation.has_objects || objects.empty()) return evaluation;
    const auto groundtruth = recording.groundtruth();
    if (!groundtruth) throw Error(folder.string() + ": has no groundtruth.txt");
    const Eigen::Isometry3d T_truth_run = align_poses(*groundtruth, read_trajectory(run / "trajectory.txt"));
    const auto matches = match_objects(objects, models, evaluation.masks);
    for (std::size_t i = 0; i < objects.size(); ++i) {
        ObjectResult result{objects[i].kind, objects[i].label, {}, 0, {}};
        if (matches[i]) {
            const EstimatedObject& model = models[*matches[i]];
            result.matched = model.label;
            result.iou = evaluation.masks.iou(objects[i].label, model.label);
            result.scores = score_object(objects[i], model, T_truth_run);
        }
        evaluation.objects.push_back(result);
    }
    const auto found =
        std::count_if(matches.begin(), matches.end(), [](const auto& match) { return match.has_value(); });
    evaluation.spurious = models.size() - static_cast<std::size_t>(found);
    return evaluation;
}

std::string object_evaluation_table(const ObjectEvaluation& e) {
    std::string text = fmt::format(
        "movers in {} masks: recall {:.1f} %, precision {:.1f} % (pixels {} hit, {} missed, {} wrong)\n", e.frames,
        kPercent * e.masks.recall(), kPercent * e.masks.precision(), e.masks.hit, e.masks.missed, e.masks.wrong);
    if (!e.has_objects) return text;
    text += fmt::format("{:<12}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "object", "as", "IoU", "poses", "ATE cm",
                        "max cm", "rot deg", "surf mm", "> 1 cm %");
    for (const ObjectResult& o : e.objects) {
        const bool there = o.matched.has_value();
        const ObjectScores& s = o.scores;
        text += fmt::format("{:<12}{:>9}{}{:>9}{}{}{}{}{}\n", fmt::format("{} {}", o.label, o.kind),
                            there ? std::to_string(*o.matched) : "none", cell(there, o.iou, 3), s.poses,
                            cell(there, kCentimetres * s.ate, 2), cell(there, kCentimetres * s.max, 2),
                            cell(there, s.rotation, 2), cell(there && s.surfels > 0, kMillimetres * s.surface_mean, 1),
                            cell(there && s.surfels > 0, kPercent * s.surface_beyond_cm, 1));
    }
    return text + fmt::format("objects of the run that are none: {}\n", e.spurious);
}

std::string object_evaluation_json(const ObjectEvaluation& e) {
    nlohmann::ordered_json json{{"frames", e.frames}, {"recall", e.masks.recall()}, {"precision", e.masks.precision()},
                                {"hit", e.masks.hit}, {"missed", e.masks.missed},   {"wrong", e.masks.wrong}};
    if (!e.has_objects) return json.dump(1) + "\n";
    json["objects"] = nlohmann::ordered_json::array();
    for (const ObjectResult& o : e.objects) {
        nlohmann::ordered_json entry{{"kind", o.kind}, {"label", o.label}};
        entry["matched"] = o.matched ? nlohmann::ordered_json(*o.matched) : nlohmann::ordered_json();
        if (o.matched)
            entry.update({{"iou", o.iou},
                          {"poses", o.scores.poses},
                          {"ate_m", o.scores.ate},
                          {"max_m", o.scores.max},
                          {"rotation_deg", o.scores.rotation},
                          {"surfels", o.scores.surfels},
                          {"surface_mean_m", o.scores.surface_mean},
                          {"surface_beyond_cm", o.scores.surface_beyond_cm}});
        json["objects"].push_back(entry);
    }
    json["spurious"] = e.spurious;
    return json.dump(1) + "\n";
}

}  // namespace posefusion
