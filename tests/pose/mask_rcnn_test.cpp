#include "pose/mask_rcnn.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "engine/core/error.hpp"
#include "tests/pose/support.hpp"

namespace posefusion {
namespace {

using testing::TemporaryFolder;

/// A network made by Python's onnx that outlines red as a person (class 1, score 0.9), green as a car (class 3, 0.8)
/// and blue as a person it is not sure of (class 1, 0.3). Arguments of the script: file, rank of the input, image side
/// or 0.
constexpr const char* kScript = R"(
import sys
from onnx import TensorProto, checker, helper, save
file, rank, side = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]) or None
shape = ([1] if rank == 4 else []) + [3, side or 'h', side or 'w']
constant = lambda name, kind, values: helper.make_node('Constant', [], [name], value=helper.make_tensor(
    name, kind, [len(values)], values))
nodes = [
    constant('labels', TensorProto.INT64, [1, 3, 1]),
    constant('scores', TensorProto.FLOAT, [0.9, 0.8, 0.3]),
    helper.make_node('Shape', ['image'], ['size'], start=rank - 2),
    constant('head', TensorProto.INT64, [3, 1]),
    helper.make_node('Concat', ['head', 'size'], ['goal'], axis=0),
    helper.make_node('Reshape', ['image', 'goal'], ['masks']),
]
outputs = [helper.make_tensor_value_info('labels', TensorProto.INT64, [3]),
           helper.make_tensor_value_info('scores', TensorProto.FLOAT, [3]),
           helper.make_tensor_value_info('masks', TensorProto.FLOAT, [3, 1, None, None])]
if len(sys.argv) > 4:
    outputs.pop()
graph = helper.make_graph(nodes, 'colours', [helper.make_tensor_value_info('image', TensorProto.FLOAT, shape)], outputs)
model = helper.make_model(graph, opset_imports=[helper.make_opsetid('', 15)], ir_version=8)
checker.check_model(model)
save(model, file)
)";

class MaskRcnn : public ::testing::Test {
protected:
    std::filesystem::path network(const std::string& arguments) {
        const auto script = folder.path() / "make.py", model = folder.path() / "model.onnx";
        testing::write_file(script, kScript);
        const std::string command = "/usr/bin/python3 " + script.string() + " " + model.string() + " " + arguments;
        if (std::system(command.c_str()) != 0) ADD_FAILURE() << "python3-onnx is needed, tools/setup installs it";
        return model;
    }
    static ColorImage picture(int width = 48, int height = 32) {
        ColorImage color(width, height, {20, 20, 20});
        for (int v = 0; v < height / 2; ++v)
            for (int u = 0; u < width / 3; ++u) {
                color(u, v) = {255, 0, 0};
                color(u + width / 3, v) = {0, 255, 0};
                color(u + 2 * (width / 3), v) = {0, 0, 255};
            }
        return color;
    }
    std::string fault(const std::filesystem::path& model) {
        try {
            (void)make_mask_rcnn({model, 0.5f, {}, 1})->mask(picture());
        } catch (const Error& error) {
            return error.what();
        }
        return {};
    }
    TemporaryFolder folder;
};

TEST_F(MaskRcnn, CutsOutThePersonOnly) {
    const auto masker = make_mask_rcnn({network("3 0"), 0.5f, {}, 1});
    const LabelImage labels = masker->mask(picture());
    ASSERT_EQ(labels.width(), 48);
    ASSERT_EQ(labels.height(), 32);
    EXPECT_EQ(labels(5, 5), 1);
    EXPECT_EQ(labels(20, 5), 0) << "a car";
    EXPECT_EQ(labels(40, 5), 0) << "not certain enough";
    EXPECT_EQ(labels(5, 20), 0);
    EXPECT_NE(masker->description().find("model.onnx"), std::string::npos);
}

TEST_F(MaskRcnn, ThresholdAndClassesChoose) {
    const auto model = network("4 0");
    const LabelImage unsure = make_mask_rcnn({model, 0.2f, {}, 1})->mask(picture());
    EXPECT_EQ(unsure(5, 5), 1);
    EXPECT_EQ(unsure(40, 5), 2) << "numbered by certainty";
    const LabelImage cars = make_mask_rcnn({model, 0.5f, {3}, 1})->mask(picture());
    EXPECT_EQ(cars(5, 5), 0);
    EXPECT_EQ(cars(20, 5), 1);
    const LabelImage both = make_mask_rcnn({model, 0.5f, {3, 1}, 1})->mask(picture());
    EXPECT_EQ(both(5, 5), 1);
    EXPECT_EQ(both(20, 5), 2);
}

TEST_F(MaskRcnn, ANetworkOfFixedSizeGetsItsSize) {
    const LabelImage labels = make_mask_rcnn({network("4 24"), 0.5f, {}, 1})->mask(picture(96, 64));
    ASSERT_EQ(labels.width(), 96);
    EXPECT_EQ(labels(5, 5), 1);
    EXPECT_EQ(labels(90, 60), 0);
}

TEST_F(MaskRcnn, OtherFilesAreRefusedInOneLine) {
    EXPECT_NE(fault(folder.path() / "none.onnx").find("not found"), std::string::npos);
    testing::write_file(folder.path() / "text.onnx", "this is no network");
    const std::string text = fault(folder.path() / "text.onnx");
    EXPECT_NE(text.find("is not a readable ONNX model"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    const std::string lacking = fault(network("4 0 without_masks"));
    EXPECT_NE(lacking.find("has no output 'masks'"), std::string::npos) << lacking;
}

}  // namespace
}  // namespace posefusion
