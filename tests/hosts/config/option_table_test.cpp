#include "hosts/config/option_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

/// Number of members an aggregate can be brace-initialised with (elements of an array member count each).
struct Anything {
    template <class T>
    operator T() const;  // only named, never called
};
template <class Aggregate, std::size_t... I>
constexpr bool takes(std::index_sequence<I...>) {
    return requires { Aggregate{(static_cast<void>(I), Anything{})...}; };
}
template <class Aggregate, std::size_t N = 1>
constexpr std::size_t member_count() {
    if constexpr (takes<Aggregate>(std::make_index_sequence<N + 1>()))
        return member_count<Aggregate, N + 1>();
    else
        return N;
}

std::size_t options_in(const std::string& group) {
    RunConfig config;
    std::size_t count = 0;
    for (const Option& option : option_table(config)) {
        if (option.group() != group) continue;
        const std::string value = option.get();
        count += option.kind == Option::Kind::List
                     ? 1 + static_cast<std::size_t>(std::count(value.begin(), value.end(), ','))
                     : 1;
    }
    return count;
}

// Fails when a member is added to a configuration: give it a line in hosts/config/option_table.cpp, or make it a
// constant. Members that are subtracted have no option since nobody who runs the program has a use for one; tests set
// them.
TEST(OptionTable, EveryFieldOfEveryConfigurationHasAnOption) {
    EXPECT_EQ(options_in("preprocess"), member_count<PreprocessConfig>() - 1) << "normal_radius";
    EXPECT_EQ(options_in("noise"), member_count<DepthNoise>());
    EXPECT_EQ(options_in("tracking"), member_count<TrackingConfig>() - 1) << "min_gradient";
    EXPECT_EQ(options_in("map"), member_count<MapConfig>());
    EXPECT_EQ(options_in("segmentation"), member_count<SegmentationConfig>());
    EXPECT_EQ(options_in("features"), member_count<FeatureConfig>() - 1) << "sparse_start belongs to no group";
    EXPECT_EQ(options_in("loops"), member_count<LoopConfig>() - 5 + member_count<FernConfig>() - 1)
        << "`enabled` is no_loops, the ferns have options of their own; interval, min_discrepancy, "
           "relative_constraints, keyframe_dissimilarity";
    EXPECT_EQ(options_in("alignment"), member_count<AlignmentConfig>());
    EXPECT_EQ(options_in("relocalisation"), member_count<RelocalisationConfig>());
    EXPECT_EQ(options_in("deformation"), member_count<DeformationConfig>() - 6)
        << "temporal_window, neighbours, correlated_pixels, constraint_weight, iterations, max_edge_error";
    EXPECT_EQ(options_in("engine"), 2u) << "members of SlamConfig that are no group";
    EXPECT_EQ(options_in("pose"), member_count<PoseConfig>()) << "pose.every belongs to the run, rotate to no group";
}

TEST(OptionTable, EveryOptionIsDescribedAndNamedOnce) {
    RunConfig config;
    std::set<std::string> keys, flags;
    for (const Option& option : option_table(config)) {
        EXPECT_TRUE(keys.insert(option.key).second) << option.key;
        EXPECT_TRUE(flags.insert(option.flag()).second) << option.flag();
        EXPECT_FALSE(option.help.empty()) << option.key;
        EXPECT_FALSE(option.allowed.empty()) << option.key;
    }
}

TEST(OptionTable, TheHelpStartsWithTheFewThatAUserTurns) {
    RunConfig config;
    const std::vector<Option> table = option_table(config), shown = in_help_order(table);
    ASSERT_EQ(shown.size(), table.size());
    const auto is_basic = [](const Option& option) { return option.section != OptionSection::Advanced; };
    const auto basic = std::count_if(shown.begin(), shown.end(), is_basic);
    EXPECT_GE(basic, 30);
    EXPECT_LE(basic, 40);
    EXPECT_TRUE(std::is_partitioned(shown.begin(), shown.end(), is_basic)) << "basic options come first";
    std::set<std::string> closed;  // headings that other options have followed
    for (std::size_t i = 1; i < shown.size(); ++i) {
        if (shown[i].heading() == shown[i - 1].heading()) continue;
        EXPECT_TRUE(closed.insert(shown[i - 1].heading()).second) << shown[i - 1].heading() << " is there twice";
    }
}

TEST(OptionTable, EveryDefaultIsItselfAllowedAndReadsBackUnchanged) {
    RunConfig config;
    for (const Option& option : option_table(config)) {
        const std::string value = option.get();
        EXPECT_NO_THROW(option.set(value)) << option.key << " = " << value;
        EXPECT_EQ(option.get(), value) << option.key;
    }
}

TEST(OptionTable, EachOptionIsBoundToItsOwnField) {
    RunConfig config;
    const std::vector<Option> options = option_table(config);
    for (const Option& option : options) {
        const std::string before = option.get();
        std::string other;
        switch (option.kind) {
            case Option::Kind::Switch:
                other = before == "true" ? "false" : "true";
                break;
            case Option::Kind::Text:
                other = option.key == "start" ? "1.5s" : "something else";
                break;
            case Option::Kind::Choice: {
                const std::string first = option.allowed.substr(0, option.allowed.find(' '));
                other = before != first ? first : option.allowed.substr(option.allowed.rfind(' ') + 1);
                break;
            }
            case Option::Kind::Number: {
                const std::string least = option.allowed.substr(0, option.allowed.find(' '));
                other = before != least ? least : option.allowed.substr(option.allowed.rfind(' ') + 1);
                break;
            }
            case Option::Kind::List:
                other = "1,2,3";
                break;
        }
        std::vector<std::string> others;
        for (const Option& o : options) others.push_back(o.get());
        option.set(other);
        EXPECT_EQ(option.get(), other) << option.key;
        for (std::size_t i = 0; i < options.size(); ++i) {
            if (options[i].key != option.key) {
                EXPECT_EQ(options[i].get(), others[i]) << option.key << " changed " << options[i].key;
            }
        }
        option.set(before);
    }
}

TEST(OptionTable, SetsTheField) {
    RunConfig config;
    const std::vector<Option> options = option_table(config);
    find_option(options, "tracking.icp_max_distance").set("0.25");
    find_option(options, "tracking.iterations").set("7,6,5");
    find_option(options, "pose.runtime").set("opencv");
    find_option(options, "pose.every").set("3");
    find_option(options, "no_people").set("true");
    find_option(options, "out").set("/some/where else");
    EXPECT_FLOAT_EQ(config.slam.tracking.icp_max_distance, 0.25f);
    EXPECT_EQ(config.slam.tracking.iterations[0], 7);
    EXPECT_EQ(config.slam.tracking.iterations[2], 5);
    EXPECT_EQ(config.pose.runtime, PoseRuntime::OpenCvDnn);
    EXPECT_EQ(config.pose_every, 3);
    EXPECT_TRUE(config.no_people);
    EXPECT_EQ(config.out, "/some/where else");
    find_option(options, "classes").set("15,0");
    EXPECT_EQ(config.classes, (std::vector<int>{15, 0}));
    find_option(options, "classes").set("");
    EXPECT_TRUE(config.classes.empty());
}

std::string refusal(const std::string& key, const std::string& value) {
    RunConfig config;
    const std::vector<Option> options = option_table(config);
    try {
        find_option(options, key).set(value);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(OptionTable, BadValuesAreRefusedWithTheAllowedOnes) {
    EXPECT_EQ(refusal("scale", "2"), "'2' is not allowed here; give a number, 0.05 .. 1");
    EXPECT_EQ(refusal("scale", "half"), "'half' is not allowed here; give a number, 0.05 .. 1");
    EXPECT_EQ(refusal("tracking.icp_max_distance", "0.1m"), "'0.1m' is not allowed here; give a number, 0.001 .. 10 m");
    EXPECT_EQ(refusal("tracking.icp_max_distance", "nan"), "'nan' is not allowed here; give a number, 0.001 .. 10 m");
    EXPECT_EQ(refusal("pose.every", "0"), "'0' is not allowed here; give a whole number, 1 .. 1000 frames");
    EXPECT_EQ(refusal("pose.every", "1.5"), "'1.5' is not allowed here; give a whole number, 1 .. 1000 frames");
    EXPECT_EQ(refusal("pose.runtime", "tensorrt"), "'tensorrt' is not allowed here; give onnxruntime | opencv");
    EXPECT_EQ(refusal("tracking.icp", "yes"), "'yes' is not allowed here; give true | false");
    for (const char* bad : {",", "1,", "-1", "65536", "person"}) {
        EXPECT_NE(refusal("classes", bad), "accepted") << bad;
    }
    for (const char* bad : {"", "1", "1,2", "1,2,3,4", "1,,3", "1,2,3,"}) {
        EXPECT_NE(refusal("tracking.iterations", bad), "accepted") << bad;
    }
}

/// What check_config() says after setting these options.
std::string contradiction(const std::vector<std::pair<std::string, std::string>>& settings) {
    RunConfig config;
    const std::vector<Option> options = option_table(config);
    for (const auto& [key, value] : settings) find_option(options, key).set(value);
    try {
        check_config(config);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(OptionTable, ContradictingValuesAreRefused) {
    EXPECT_EQ(contradiction({}), "");
    EXPECT_EQ(contradiction({{"tracking.icp", "false"}}), "");
    EXPECT_NE(contradiction({{"tracking.icp", "false"}, {"tracking.photometric", "false"}}), "");
    EXPECT_NE(contradiction({{"tracking.iterations", "0,0,0"}}), "");
    EXPECT_NE(contradiction({{"no_people", "true"}, {"masks", "x"}}), "");
    EXPECT_NE(contradiction({{"no_people", "true"}, {"mask_network", "x"}}), "");
    EXPECT_NE(contradiction({{"masks", "x"}, {"mask_network", "x"}}), "");
    EXPECT_NE(contradiction({{"objects", "true"}, {"no_motion", "true"}}), "");
    EXPECT_NE(contradiction({{"classes", "1"}}), "");
    EXPECT_EQ(contradiction({{"classes", "15,0"}, {"masks", "x"}}), "");
    EXPECT_NE(contradiction({{"preprocess.depth_min", "5"}, {"preprocess.depth_max", "1"}}), "");
}

TEST(OptionTable, AnUnknownKeyNamesTheNearest) {
    RunConfig config;
    const std::vector<Option> options = option_table(config);
    try {
        (void)find_option(options, "trackng.icp");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("'tracking.icp'"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace posefusion
