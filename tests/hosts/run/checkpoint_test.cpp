#include "hosts/run/checkpoint.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "hosts/io/map_file.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

class CheckpointFile : public testing::Test {
protected:
    CheckpointFile() {
        identity_.recording = "somewhere";
        identity_.stamps = {Stamp{1}, Stamp{2}, Stamp{3}};
        state_.frames = 2;
        record_.frames.resize(2);
        record_.frames[1].index = 1;
        record_.loop_graph = LoopGraph{
            1, {{{1, 2, 3}, {0.5, 0, 0}}, {{4, 5, 6}, {0, 0.25, 0}}, {{7, 8, 9}, {0, 0, 0.125}}}, 2, {{0, 1}, {2, 0}}};
    }
    [[nodiscard]] Checkpoint written_and_read() const {
        write_checkpoint(folder_ / "checkpoint.bin", identity_, state_, {}, record_, 1);
        return read_checkpoint(folder_ / "checkpoint.bin", identity_);
    }

    test::TempFolder folder_;
    RunIdentity identity_;
    AtlasState state_;
    RunRecord record_;
};

TEST_F(CheckpointFile, KeepsThePieces) {
    state_.frames = 12, state_.restored_frames = 10;
    state_.current = {{}, {10, 11}, 1};
    state_.current.slam.frames = 2;
    PieceState& other = state_.others.emplace_back();
    other.frames = {0, 3, 9};
    other.tracked = 2;
    other.slam.frames = 3;
    other.slam.map.appearance = {std::byte{7}, std::byte{8}};
    other.slam.back_end.keyframes = {{1, Eigen::Isometry3d::Identity(), {{1, FernCode::kNoCode}, 1}, 5}};
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = Eigen::Vector3d(1, 2, 3);
    state_.pending = PendingJoin{0, 11, 3, T, {{4, 5}, 2}};
    state_.motion = {std::byte{9}, std::byte{1}};
    const AtlasState read = written_and_read().engine;
    EXPECT_EQ(read.frames, 12u);
    EXPECT_EQ(read.motion, state_.motion);
    EXPECT_EQ(read.restored_frames, 10u);
    EXPECT_EQ(read.current.frames, state_.current.frames);
    EXPECT_EQ(read.current.tracked, 1u);
    ASSERT_EQ(read.others.size(), 1u);
    EXPECT_EQ(read.others[0].frames, other.frames);
    EXPECT_EQ(read.others[0].tracked, 2u);
    EXPECT_EQ(read.others[0].slam.frames, 3u);
    EXPECT_EQ(read.others[0].slam.map.appearance, other.slam.map.appearance);
    ASSERT_EQ(read.others[0].slam.back_end.keyframes.size(), 1u);
    EXPECT_EQ(read.others[0].slam.back_end.keyframes[0].code.ferns, (std::vector<std::uint8_t>{1, FernCode::kNoCode}));
    ASSERT_TRUE(read.pending);
    EXPECT_EQ(read.pending->frame, 11u);
    EXPECT_EQ(read.pending->model_frame, 3u);
    EXPECT_EQ(read.pending->T_other_current.matrix(), T.matrix());
    EXPECT_EQ(read.pending->view.ferns, (std::vector<std::uint8_t>{4, 5}));
    EXPECT_EQ(read.pending->view.good, 2);

    state_.pending->piece = 1;
    EXPECT_NE(test::message_of<Error>([&] { (void)written_and_read(); }).find("'pieces' is damaged"), std::string::npos)
        << "there is no such piece";
    state_.pending.reset();
    state_.frames = 13;
    EXPECT_NE(test::message_of<Error>([&] { (void)written_and_read(); }).find("contradicts itself"), std::string::npos)
        << "a frame that is not in the run";
}

TEST_F(CheckpointFile, KeepsTheLoops) {
    LoopEvent event;
    event.frame = 1, event.kind = LoopKind::Global, event.model_frame = 7, event.accepted = true, event.reason = "none";
    event.overlap = 0.1f, event.inlier_ratio = 0.2f, event.icp_rmse_m = 0.3f, event.photometric_rmse = 0.4f,
    event.correlation = 0.5f;
    event.residual_before_m = 0.6, event.residual_after_m = 0.7, event.nodes = 8, event.milliseconds = 90,
    event.solve_milliseconds = 10;
    record_.frames[1].result.loops = {event};
    const Checkpoint checkpoint = written_and_read();
    EXPECT_TRUE(checkpoint.frames[0].result.loops.empty());
    ASSERT_EQ(checkpoint.frames[1].result.loops.size(), 1u);
    EXPECT_EQ(checkpoint.frames[1].result.loops[0], event);
}

TEST_F(CheckpointFile, KeepsThePeopleInView) {
    PersonInView person;
    person.id = 3;
    person.joints[LeftKnee] = {{1, 2, 3}, 0.5f};
    record_.frames[1].in_view = {person};
    const Checkpoint checkpoint = written_and_read();
    EXPECT_TRUE(checkpoint.frames[0].in_view.empty());
    ASSERT_EQ(checkpoint.frames[1].in_view.size(), 1u);
    EXPECT_EQ(checkpoint.frames[1].in_view[0].id, 3);
    EXPECT_EQ(checkpoint.frames[1].in_view[0].joints[LeftKnee].point, Eigen::Vector3f(1, 2, 3));
    EXPECT_EQ(checkpoint.frames[1].in_view[0].joints[LeftKnee].confidence, 0.5f);
}

TEST_F(CheckpointFile, KeepsTheExposures) {
    record_.frames[1].result.exposure = {1.1f, 0.9f, 1.2f};
    EXPECT_EQ(written_and_read().frames[1].result.exposure, record_.frames[1].result.exposure);
}

TEST_F(CheckpointFile, KeepsTheGraphOfTheLastLoop) {
    const auto graph = written_and_read().loop_graph;
    ASSERT_TRUE(graph);
    EXPECT_EQ(graph->frame, 1u);
    EXPECT_EQ(graph->map_nodes, 2u);
    EXPECT_EQ(graph->edges, record_.loop_graph->edges);
    ASSERT_EQ(graph->nodes.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(graph->nodes[i].position, record_.loop_graph->nodes[i].position);
        EXPECT_EQ(graph->nodes[i].moved, record_.loop_graph->nodes[i].moved);
    }
    record_.loop_graph.reset();
    EXPECT_FALSE(written_and_read().loop_graph);
}

TEST_F(CheckpointFile, AGraphThatContradictsItselfIsRefused) {
    record_.loop_graph->edges.push_back({0, 3});
    EXPECT_NE(test::message_of<Error>([&] { (void)written_and_read(); }).find("'run' is damaged"), std::string::npos)
        << "an edge to no node";
    record_.loop_graph->edges.pop_back();
    record_.loop_graph->map_nodes = 4;
    EXPECT_NE(test::message_of<Error>([&] { (void)written_and_read(); }).find("'run' is damaged"), std::string::npos)
        << "more nodes than there are";
}

TEST(Checkpoint, OfAnotherRunIsOneLineWhateverItsNamesAre) {
    const test::TempFolder folder;
    const std::filesystem::path file = folder / "checkpoint.bin";
    const RunIdentity ours{"recording", {Stamp{0}, Stamp{1}}, {{"scale", "1"}}};
    const auto error_of = [&](const RunIdentity& was) {
        write_checkpoint(file, was, {}, {}, {}, 0);
        return test::message_of<Error>([&] { (void)read_checkpoint(file, ours); });
    };
    EXPECT_NE(error_of({"two\nlines", ours.stamps, {}}).find("is of another recording, two?lines"), std::string::npos);
    EXPECT_NE(error_of({"recording", {Stamp{0}}, {}}).find("the frames of the recording have changed"),
              std::string::npos);
    EXPECT_NE(error_of({"recording", ours.stamps, {{"scale", "\n"}}}).find("scale = '?', not '1'"), std::string::npos);
    EXPECT_NE(error_of({"recording", ours.stamps, {}}).find("scale = 'unknown', not '1'"), std::string::npos);
}

/// Fuzzing gets nowhere from files of another version.
TEST(Checkpoint, TheCorpusOfTheFuzzTargetIsOfThisVersion) {
    using namespace std::chrono_literals;
    const std::filesystem::path corpus = POSEFUSION_MAP_CORPUS;
    const auto write_it_anew = "write it anew with write_checkpoint() or write_map(), with people and a loop in it";
    const auto error = test::message_of<Error>([&] {
        const Checkpoint checkpoint =
            read_checkpoint(corpus / "checkpoint", {"recording", {0s, 1s, 2s}, {{"scale", "1"}}});
        EXPECT_FALSE(checkpoint.people.empty() || checkpoint.samples.empty() ||
                     checkpoint.frames.back().result.loops.empty() || !checkpoint.loop_graph)
            << write_it_anew;
        (void)read_map(corpus / "map");
    });
    EXPECT_EQ(error, "") << write_it_anew;
}

}  // namespace
}  // namespace posefusion
