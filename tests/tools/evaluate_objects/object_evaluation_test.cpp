#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"
#include "tools/evaluate_objects/report.hpp"

/// A recording with movers, and runs over it that are made up.
namespace posefusion {
namespace {

namespace fs = std::filesystem;

SynthConfig movers(const fs::path& out) {
    SynthConfig config;
    config.out = out;
    config.scenario = SynthScenario::Movers;
    config.seed = 1;
    config.people = 0;
    config.frames = 30;
    config.width = 64;
    config.height = 48;
    config.noise = false;
    return config;
}

class ObjectEvaluationTest : public testing::Test {
protected:
    static void SetUpTestSuite() {
        made = fs::temp_directory_path() / ("posefusion_objects_" + std::to_string(::getpid()));
        fs::remove_all(made);
        synthesize(movers(made));
    }
    static void TearDownTestSuite() { fs::remove_all(made); }
    void SetUp() override {
        fs::copy(made, recording, fs::copy_options::recursive);
        fs::create_directories(run);
        fs::copy(recording / "masks", run / "masks");
    }
    /// Of each true object the true trajectory, and the corners of its mesh as a model.
    void write_objects() const {
        fs::copy(recording / "groundtruth.txt", run / "trajectory.txt");
        for (const TrueObject& object : read_true_objects(recording)) {
            const fs::path place = run / "objects" / std::to_string(object.label - 100);
            fs::create_directories(place);
            write_trajectory(place / "trajectory.txt", object.poses);
            std::vector<Surfel> model;
            for (const Eigen::Vector3f& p : object.mesh.vertices) {
                Surfel surfel{};
                surfel.normal.setZero();
                surfel.position = p;
                model.push_back(surfel);
            }
            write_ply(place / "map.ply", model);
        }
    }
    inline static fs::path made;  // once for all tests
    test::TempFolder folder;
    fs::path recording = folder / "recording", run = folder / "run";
};

TEST_F(ObjectEvaluationTest, TrueMasksAreRightAndWithoutObjectsNothingElseIsSaid) {
    const ObjectEvaluation evaluation = evaluate_objects(recording, run);
    EXPECT_EQ(evaluation.frames, 30u);
    EXPECT_GT(evaluation.masks.hit, 0u);
    EXPECT_EQ(evaluation.masks.missed + evaluation.masks.wrong, 0u);
    EXPECT_FALSE(evaluation.has_objects);
    EXPECT_EQ(object_evaluation_table(evaluation).find("ATE"), std::string::npos);
}

TEST_F(ObjectEvaluationTest, TrueObjectsHaveNoError) {
    write_objects();
    const ObjectEvaluation evaluation = evaluate_objects(recording, run);
    ASSERT_FALSE(evaluation.objects.empty());
    for (const ObjectResult& object : evaluation.objects) {
        EXPECT_EQ(object.matched, object.label);
        EXPECT_DOUBLE_EQ(object.iou, 1);
        EXPECT_LT(object.scores.ate, 1e-6);
        EXPECT_LT(object.scores.surface_mean, 1e-6);
        EXPECT_GT(object.scores.surfels, 10u);
    }
    EXPECT_EQ(evaluation.spurious, 0u);
    EXPECT_NE(object_evaluation_json(evaluation).find("\"ate_m\""), std::string::npos);
}

TEST_F(ObjectEvaluationTest, MasksThatSayNothingMissEverything) {
    for (const auto& entry : fs::directory_iterator(run / "masks")) write_labels(entry.path(), LabelImage(64, 48));
    const ObjectEvaluation evaluation = evaluate_objects(recording, run);
    EXPECT_EQ(evaluation.masks.recall(), 0);
    EXPECT_EQ(evaluation.masks.precision(), 1);
}

TEST_F(ObjectEvaluationTest, SaysWhatIsMissing) {
    EXPECT_THROW((void)evaluate_objects(recording, folder / "elsewhere"), Error);
    fs::remove_all(recording / "objects");
    EXPECT_THROW((void)evaluate_objects(recording, run), Error);
}

}  // namespace
}  // namespace posefusion
