#include "pose/onnx_file.hpp"

#include <gtest/gtest.h>

#include "tests/pose/support.hpp"

namespace posefusion {
namespace {

using testing::TemporaryFolder;
using testing::write_file;

/// Protocol Buffers: field `number` holding `bytes`.
std::string field(int number, const std::string& bytes) {
    return std::string{static_cast<char>(number << 3 | 2), static_cast<char>(bytes.size())} + bytes;
}

/// A dimension of less than 128.
std::string dim(char extent) { return field(1, std::string{1 << 3, extent}); }

/// A model whose graph has one input of the given shape.
std::string model_with_shape(const std::string& shape) {
    return field(7, field(11, field(1, "image") + field(2, field(1, field(2, shape)))));
}

TEST(OnnxFile, TellsTheDeclaredSize) {
    const TemporaryFolder folder;
    write_file(folder.path() / "m.onnx", model_with_shape(dim(1) + dim(3) + dim(48) + dim(64)));
    const InputSize size = declared_input_size(folder.path() / "m.onnx");
    EXPECT_EQ(size.width, 64);
    EXPECT_EQ(size.height, 48);
}

TEST(OnnxFile, NamedDimensionsAreFree) {
    const TemporaryFolder folder;
    const std::string named = field(1, field(2, "height"));
    write_file(folder.path() / "m.onnx", model_with_shape(dim(1) + dim(3) + named + named));
    const InputSize size = declared_input_size(folder.path() / "m.onnx");
    EXPECT_EQ(size.width, 0);
    EXPECT_EQ(size.height, 0);
}

TEST(OnnxFile, EveryTruncationIsHarmless) {
    const TemporaryFolder folder;
    const std::string model = model_with_shape(dim(1) + dim(3) + dim(48) + dim(64));
    for (std::size_t size = 0; size < model.size(); ++size) {
        write_file(folder.path() / "m.onnx", model.substr(0, size));
        EXPECT_EQ(declared_input_size(folder.path() / "m.onnx").width, 0) << size;
    }
    EXPECT_EQ(declared_input_size(folder.path() / "absent.onnx").width, 0);
}

}  // namespace
}  // namespace posefusion
