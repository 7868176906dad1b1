#include "tools/mask_accuracy/report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/core/error.hpp"
#include "engine/core/median.hpp"

namespace posefusion::mask_accuracy {
namespace {

// Recall means nothing on a frame that shows next to nothing of a person: such frames enter the pixel totals only.
constexpr long kFewPixels = 500;

cv::Vec3b blend(cv::Vec3b pixel, const cv::Vec3b& tint) {
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>((pixel[c] + tint[c]) / 2);
    return pixel;
}

}  // namespace

Counts& Counts::operator+=(const Counts& other) {
    hit += other.hit;
    missed += other.missed;
    lost += other.lost;
    clear += other.clear;
    return *this;
}

Counts compare(const LabelImage& estimate, const LabelImage& truth) {
    if (estimate.width() != truth.width() || estimate.height() != truth.height())
        throw Error("true mask and image differ in size");
    Counts counts;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (truth[i] > 0)
            ++(estimate[i] > 0 ? counts.hit : counts.missed);
        else
            ++(estimate[i] > 0 ? counts.lost : counts.clear);
    }
    return counts;
}

void print_summary(const std::string& name, const std::vector<FrameResult>& frames, int worst) {
    Counts total;
    double recall = 0, iou = 0;
    int with_people = 0, detected = 0, people = 0, carried = 0;
    std::vector<double> times;
    for (const FrameResult& f : frames) {
        total += f.counts;
        detected += f.detected;
        people += f.people;
        carried += f.carried;
        times.push_back(f.milliseconds);
        if (f.counts.hit + f.counts.missed < kFewPixels) continue;
        recall += f.counts.recall();
        iou += f.counts.iou();
        ++with_people;
    }
    const double n = std::max(with_people, 1);
    std::printf(
        "%-18s frames %3zu  recall mean %6.2f %% pixels %6.2f %%  static lost %5.2f %%  IoU mean %.3f pixels %.3f"
        "  detected %d people %d carried %d  median %.1f ms\n",
        name.c_str(), frames.size(), with_people > 0 ? 100 * recall / n : 100.0, 100 * total.recall(),
        100 * total.static_lost(), with_people > 0 ? iou / n : 1.0, total.iou(), detected, people, carried,
        times.empty() ? 0.0 : upper_median(times));

    std::vector<FrameResult> order = frames;
    const auto count = std::min(order.size(), static_cast<std::size_t>(std::max(worst, 0)));
    std::stable_sort(order.begin(), order.end(), [](const FrameResult& a, const FrameResult& b) {
        return a.counts.missed + a.counts.lost > b.counts.missed + b.counts.lost;
    });
    for (std::size_t i = 0; i < count; ++i) {
        const FrameResult& f = order[i];
        std::printf(
            "    %s  recall %6.2f %%  missed %6ld px  lost %6ld px  IoU %.3f  detected %d people %d carried %d\n",
            f.stamp.c_str(), 100 * f.counts.recall(), f.counts.missed, f.counts.lost, f.counts.iou(), f.detected,
            f.people, f.carried);
    }
}

void write_overlay(const std::filesystem::path& file, const ColorImage& color, const LabelImage& estimate,
                   const LabelImage& truth, const People& people) {
    static const std::array<cv::Vec3b, 6> kTints{
        {{0, 255, 0}, {255, 0, 255}, {255, 255, 0}, {0, 255, 255}, {0, 128, 255}, {255, 0, 0}}};
    static const cv::Vec3b kHit{0, 255, 0}, kMissed{0, 0, 255}, kLost{255, 0, 0};
    cv::Mat bgr(color.height(), color.width(), CV_8UC3);
    for (int v = 0; v < color.height(); ++v)
        for (int u = 0; u < color.width(); ++u) {
            const Rgb8& p = color(u, v);
            cv::Vec3b pixel(p.b, p.g, p.r);
            const int label = estimate(u, v);
            if (truth.empty()) {
                if (label > 0) pixel = blend(pixel, kTints[static_cast<std::size_t>(label - 1) % kTints.size()]);
            } else if (label > 0 || truth(u, v) > 0) {
                pixel = blend(pixel, label == 0 ? kMissed : truth(u, v) > 0 ? kHit : kLost);
            }
            bgr.at<cv::Vec3b>(v, u) = pixel;
        }
    for (const Person& person : people) {
        for (const auto& [a, b] : kLimbs) {
            const JointObservation &from = person.joints[a], &to = person.joints[b];
            if (from.p > 0 && to.p > 0)
                cv::line(bgr, cv::Point2f(from.u, from.v), cv::Point2f(to.u, to.v), {255, 255, 255}, 1, cv::LINE_AA);
        }
        for (const JointObservation& joint : person.joints)
            if (joint.p > 0) cv::circle(bgr, cv::Point2f(joint.u, joint.v), 3, {0, 165, 255}, cv::FILLED, cv::LINE_AA);
    }
    if (!cv::imwrite(file.string(), bgr)) throw Error("cannot write " + file.string());
}

}  // namespace posefusion::mask_accuracy
