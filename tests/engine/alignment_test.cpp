#include "engine/loops/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/vulkan/pose_conversion.hpp"

// When is a live image the same place as the model that it was aligned to?
namespace posefusion::test {
namespace {

/// Samples whose intensities are a wave of this amplitude in the live image and `look` of it in the model.
template <class Look>
std::vector<gpu::LoopSample> samples_of(int count, float amplitude, const Look& look) {
    std::vector<gpu::LoopSample> samples;
    for (int i = 0; i < count; ++i) {
        gpu::LoopSample sample{};
        sample.valid = 1;
        sample.live_intensity = 0.5f + amplitude * std::sin(0.3f * static_cast<float>(i));
        sample.model_intensity = look(sample.live_intensity);
        samples.push_back(sample);
    }
    return samples;
}

TEST(Correlation, TellsAnotherLookFromAnotherExposure) {
    const auto brighter = [](float x) { return 0.6f * x + 0.3f; };
    const auto inverted = [](float x) { return 1 - x; };
    EXPECT_NEAR(correlation_of(samples_of(200, 0.3f, brighter)), 1, 1e-5);
    EXPECT_NEAR(correlation_of(samples_of(200, 0.3f, inverted)), -1, 1e-5);
    int k = 0;
    const auto other = [&](float) { return 0.5f + 0.3f * std::sin(0.7f * static_cast<float>(k++)); };
    EXPECT_LT(std::abs(correlation_of(samples_of(200, 0.3f, other))), 0.2f);
    EXPECT_EQ(correlation_of(samples_of(200, 0.001f, inverted)), 1) << "a bare wall says nothing";
    EXPECT_EQ(correlation_of(samples_of(10, 0.3f, inverted)), 1) << "nor do a few pixels";
    auto half = samples_of(200, 0.3f, inverted);
    for (std::size_t i = 0; i < half.size(); ++i) {
        if (i % 2)
            half[i].model_intensity = half[i].live_intensity;
        else if (i % 4)
            half[i].valid = 0;
        else
            half[i].model_intensity = -1;
    }
    EXPECT_NEAR(correlation_of(half), 1, 1e-5) << "what is not valid or not known does not count";
}

/// A good alignment: the whole image shows the model, the pose is certain, and is where it was proposed.
class Judge : public testing::Test {
protected:
    static constexpr float kMinOverlap = 0.3f;
    AlignmentConfig config;
    gpu::TrackingRecord record{};
    std::vector<gpu::LoopSample> samples = samples_of(768, 0.3f, [](float x) { return x; });
    Eigen::Isometry3d proposed = Eigen::Isometry3d::Identity();

    Judge() {
        proposed.translation() << 1, 2, 3;
        record.world_live = to_device(proposed);
        record.valid_pixels = 10000;
        record.icp_inliers = 9000;
        record.photometric_inliers = 5000;
        record.icp_rmse = 0.01f;
        record.photometric_rmse = 0.02f;
        record.photometric_gain = 1.25f;
        set_certainty(1e-3);
        for (auto& sample : samples) sample.point = {0, 0, 2, 2};
    }
    /// Standard deviation of the pose along and about each axis, metres and radians.
    void set_certainty(double sigma) {
        for (int row = 0, k = 0; row < 6; k += 6 - row, ++row)
            record.hessian[k] = static_cast<float>(1 / (sigma * sigma));
    }
    [[nodiscard]] Alignment verdict() const { return judge(record, samples, proposed, kMinOverlap, config); }
    void expect_rejected(const std::string& reason) const {
        const Alignment alignment = verdict();
        EXPECT_FALSE(alignment.accepted);
        EXPECT_EQ(alignment.reason, reason);
    }
};

TEST_F(Judge, AcceptsWhatFits) {
    const Alignment alignment = verdict();
    EXPECT_TRUE(alignment.accepted) << alignment.reason;
    EXPECT_EQ(alignment.reason, "");
    EXPECT_FLOAT_EQ(alignment.overlap, 1);
    EXPECT_FLOAT_EQ(alignment.inlier_ratio, 0.9f);
    EXPECT_TRUE(alignment.T_world_camera.isApprox(proposed));
    EXPECT_EQ(alignment.samples.size(), samples.size());
    EXPECT_EQ(alignment.gain, 1.25f);
}

TEST_F(Judge, CountsInliersOfTheOverlapOnly) {
    for (std::size_t i = 0; i < samples.size() / 2; ++i) samples[i].point.w = 0;  // the model shows nothing there
    record.icp_inliers = 4500;
    const Alignment alignment = verdict();
    EXPECT_FLOAT_EQ(alignment.overlap, 0.5f);
    EXPECT_FLOAT_EQ(alignment.inlier_ratio, 0.9f) << "4500 of the 5000 valid pixels that overlap";
    EXPECT_TRUE(alignment.accepted) << alignment.reason;
}

TEST_F(Judge, RejectsTooLittleOfTheModel) {
    for (std::size_t i = 0; i < samples.size() * 3 / 4; ++i) samples[i].point = {0, 0, 0, 0};  // a person in front
    expect_rejected("too little of the model in view");
}

TEST_F(Judge, RejectsWhatTrackingCouldNotFind) {
    record.failed = 1;
    expect_rejected("no pose found");
}

TEST_F(Judge, RejectsSurfacesThatDoNotAgree) {
    record.icp_inliers = 7000;
    expect_rejected("surfaces do not agree");
}

TEST_F(Judge, RejectsSurfacesThatAgreeTooRoughly) {
    record.icp_rmse = std::nanf("");
    expect_rejected("surfaces agree too roughly");
    record.icp_rmse = config.max_icp_rmse * 1.01f;
    expect_rejected("surfaces agree too roughly");
}

TEST_F(Judge, RejectsOtherColours) {
    record.photometric_rmse = config.max_photometric_rmse * 1.01f;
    expect_rejected("colours do not agree");
    record.photometric_inliers = 0;
    EXPECT_TRUE(verdict().accepted) << "in the dark there are none to compare";
    EXPECT_EQ(verdict().gain, 1) << "nor does an exposure show";
}

TEST_F(Judge, RejectsAnotherLook) {
    samples = samples_of(768, 0.3f, [](float x) { return 1 - x; });
    for (auto& sample : samples) sample.point = {0, 0, 2, 2};
    expect_rejected("it looks different");
}

TEST_F(Judge, RejectsAPoseThatTheViewDoesNotFix) {
    set_certainty(0.006);  // AlignmentConfig::kMaxTranslationSigma is 0.005
    expect_rejected("the view does not fix the pose");
}

TEST_F(Judge, KnowsTheDirectionInWhichThePositionIsLeastCertain) {
    record.hessian[6] = 1 / (4e-3f * 4e-3f);  // y
    EXPECT_NEAR(std::abs(verdict().least_certain.y()), 1, 1e-9);
}

TEST_F(Judge, RejectsWhatIsFarFromTheProposal) {
    Eigen::Isometry3d far = proposed;
    far.translation().x() += static_cast<double>(AlignmentConfig::kMaxCorrection) * 1.01;
    record.world_live = to_device(far);
    expect_rejected("too far from the proposal");
}

TEST(MostAlike, IsThePlaceThatExplainsTheImageClearlyBest) {
    const auto places = [](std::initializer_list<float> correlations) {
        std::vector<Alignment> list;
        for (const float correlation : correlations) list.emplace_back().correlation = correlation;
        return list;
    };
    EXPECT_EQ(most_alike(places({})), std::nullopt);
    EXPECT_EQ(most_alike(places({0.96f})), 0u) << "nothing looks like it elsewhere";
    EXPECT_EQ(most_alike(places({0.994f, 0.999f, 0.96f})), 1u) << "the proposal was one repetition beside it";
    EXPECT_EQ(most_alike(places({0.994f, 0.992f})), std::nullopt) << "a pattern that repeats itself";
    EXPECT_EQ(most_alike(places({1, 1})), std::nullopt) << "bare walls";
}

}  // namespace
}  // namespace posefusion::test
