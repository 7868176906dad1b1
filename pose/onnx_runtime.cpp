#include <onnxruntime_cxx_api.h>

#include <algorithm>

#include "engine/core/error.hpp"
#include "pose/first_line.hpp"
#include "pose/runtime.hpp"

namespace posefusion {
namespace {

Ort::SessionOptions session_options(int threads) {
    Ort::SessionOptions options;
    options.SetIntraOpNumThreads(threads);
    options.SetInterOpNumThreads(1);
    options.SetExecutionMode(ORT_SEQUENTIAL);
    options.SetGraphOptimizationLevel(ORT_ENABLE_ALL);
    // Idle threads of the network must not burn the cores that the other stages of the pipeline need.
    options.AddConfigEntry("session.intra_op.allow_spinning", "0");
    return options;
}

class OnnxRuntimeNetwork final : public NetworkRuntime {
public:
    explicit OnnxRuntimeNetwork(const NetworkFile& file)
        : path_(file.model.string()), session_(open(environment_, file)), outputs_(file.outputs) {
        const Ort::AllocatorWithDefaultOptions allocator;
        if (session_.GetInputCount() != 1) {
            throw Error(path_ + " is not a joint detection network: it takes " +
                        std::to_string(session_.GetInputCount()) + " inputs, one image is expected");
        }
        input_ = session_.GetInputNameAllocated(0, allocator).get();
        read_input_size();
        std::vector<std::string> available;
        for (std::size_t i = 0; i < session_.GetOutputCount(); ++i) {
            available.emplace_back(session_.GetOutputNameAllocated(i, allocator).get());
        }
        if (outputs_.empty()) outputs_ = available;
        for (const std::string& name : outputs_) {
            if (std::find(available.begin(), available.end(), name) == available.end()) {
                throw Error(path_ + " is not the network expected: it has no output '" + name + "'");
            }
        }
    }

    InputSize fixed_input() const override { return fixed_; }

    std::vector<Tensor> run(const Tensor& image) override {
        const std::vector<std::int64_t> shape(image.shape.begin(), image.shape.end());
        // ONNX Runtime's interface wants a mutable pointer; inputs are not written to.
        const Ort::Value input = Ort::Value::CreateTensor<float>(
            Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault), const_cast<float*>(image.values.data()),
            image.values.size(), shape.data(), shape.size());
        std::vector<const char*> names;
        for (const std::string& name : outputs_) names.push_back(name.c_str());
        const char* const input_name = input_.c_str();
        try {
            const std::vector<Ort::Value> results =
                session_.Run(Ort::RunOptions{}, &input_name, &input, 1, names.data(), names.size());
            std::vector<Tensor> tensors;
            for (const Ort::Value& result : results) tensors.push_back(copy(result));
            return tensors;
        } catch (const Ort::Exception& error) {
            throw Error(path_ + " cannot take an image of " + std::to_string(image.width()) + " x " +
                        std::to_string(image.height()) + " pixels: " + first_line(error.what()));
        }
    }

    std::string description() const override { return "ONNX Runtime " + Ort::GetVersionString(); }

private:
    static Ort::Session open(Ort::Env& environment, const NetworkFile& file) {
        try {
            return {environment, file.model.c_str(), session_options(file.threads)};
        } catch (const Ort::Exception& error) {
            throw Error(file.model.string() + " is not a readable ONNX model: " + first_line(error.what()));
        }
    }

    void read_input_size() {
        const Ort::TypeInfo type = session_.GetInputTypeInfo(0);
        if (type.GetONNXType() != ONNX_TYPE_TENSOR) throw Error(path_ + " does not take a tensor as input");
        const auto tensor = type.GetTensorTypeAndShapeInfo();
        const std::vector<std::int64_t> shape = tensor.GetShape();
        if (tensor.GetElementType() != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT || shape.size() != 4 ||
            (shape[1] != 3 && shape[1] > 0)) {
            throw Error(path_ + " does not take float images of the shape [1, 3, height, width]");
        }
        fixed_.height = static_cast<int>(std::max<std::int64_t>(shape[2], 0));
        fixed_.width = static_cast<int>(std::max<std::int64_t>(shape[3], 0));
    }

    static Tensor copy(const Ort::Value& value) {
        const auto info = value.GetTensorTypeAndShapeInfo();
        if (info.GetElementType() != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT) return {};
        Tensor tensor;
        for (const std::int64_t extent : info.GetShape()) tensor.shape.push_back(static_cast<int>(extent));
        const float* const data = value.GetTensorData<float>();
        tensor.values.assign(data, data + info.GetElementCount());
        return tensor;
    }

    std::string path_;
    Ort::Env environment_{ORT_LOGGING_LEVEL_FATAL, "posefusion"};
    Ort::Session session_;
    std::string input_;
    std::vector<std::string> outputs_;
    InputSize fixed_;
};

}  // namespace

std::unique_ptr<NetworkRuntime> load_with_onnx_runtime(const NetworkFile& file) {
    return std::make_unique<OnnxRuntimeNetwork>(file);
}

}  // namespace posefusion
