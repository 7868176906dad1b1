#include "pose/mask_rcnn.hpp"

#include <onnxruntime_cxx_api.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/core/error.hpp"
#include "pose/first_line.hpp"

namespace posefusion {
namespace {

constexpr int kPersonOfCoco = 1;
constexpr float kInside = 0.5f;          ///< a pixel belongs to the person if its mask value is at least this
constexpr std::size_t kMaxLabels = 255;  ///< different labels in a label image
constexpr std::array<const char*, 3> kOutputs{"labels", "scores", "masks"};

Ort::Session open(Ort::Env& environment, const MaskRcnnConfig& config) {
    if (!std::filesystem::is_regular_file(config.model))
        throw Error(config.model.string() + ": segmentation network not found; check the path");
    Ort::SessionOptions options;
    options.SetIntraOpNumThreads(config.threads);
    options.SetInterOpNumThreads(1);
    options.AddConfigEntry("session.intra_op.allow_spinning", "0");
    try {
        return {environment, config.model.c_str(), options};
    } catch (const Ort::Exception& error) {
        throw Error(config.model.string() + " is not a readable ONNX model: " + first_line(error.what()));
    }
}

std::vector<std::int64_t> shape_of(const Ort::Value& value) { return value.GetTensorTypeAndShapeInfo().GetShape(); }

class MaskRcnn final : public PersonMasker {
public:
    explicit MaskRcnn(const MaskRcnnConfig& config)
        : path_(config.model.string()),
          threshold_(config.threshold),
          classes_(config.classes.empty() ? std::vector<int>{kPersonOfCoco} : config.classes),
          session_(open(environment_, config)) {
        const Ort::AllocatorWithDefaultOptions allocator;
        check_outputs(allocator);
        read_input(allocator);
    }

    LabelImage mask(const ColorImage& color) override {
        const int width = fixed_width_ > 0 ? fixed_width_ : color.width();
        const int height = fixed_height_ > 0 ? fixed_height_ : color.height();
        std::vector<float> pixels = planes(color, width, height);
        std::vector<std::int64_t> shape{3, height, width};
        if (batched_) shape.insert(shape.begin(), 1);
        const Ort::Value input =
            Ort::Value::CreateTensor<float>(Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault),
                                            pixels.data(), pixels.size(), shape.data(), shape.size());
        const char* const name = input_.c_str();
        std::vector<Ort::Value> results;
        try {
            results = session_.Run(Ort::RunOptions{}, &name, &input, 1, kOutputs.data(), kOutputs.size());
        } catch (const Ort::Exception& error) {
            throw Error(path_ + " cannot take an image of " + std::to_string(width) + " x " + std::to_string(height) +
                        " pixels: " + first_line(error.what()));
        }
        return paint(results, width, height, color);
    }

    std::string description() const override {
        return "masks of " + std::filesystem::path(path_).filename().string() + ", ONNX Runtime " +
               Ort::GetVersionString();
    }

private:
    [[noreturn]] void reject(const std::string& what) const {
        throw Error(path_ + " is not an instance segmentation network as expected: " + what);
    }

    void check_outputs(const Ort::AllocatorWithDefaultOptions& allocator) const {
        for (const char* wanted : kOutputs) {
            bool found = false;
            for (std::size_t i = 0; i < session_.GetOutputCount(); ++i)
                found = found || std::string_view(session_.GetOutputNameAllocated(i, allocator).get()) == wanted;
            if (!found) reject(std::string("it has no output '") + wanted + "'");
        }
    }

    void read_input(const Ort::AllocatorWithDefaultOptions& allocator) {
        if (session_.GetInputCount() != 1) reject("it takes more than one input");
        input_ = session_.GetInputNameAllocated(0, allocator).get();
        const Ort::TypeInfo type = session_.GetInputTypeInfo(0);
        if (type.GetONNXType() != ONNX_TYPE_TENSOR) reject("it does not take a tensor");
        const auto tensor = type.GetTensorTypeAndShapeInfo();
        std::vector<std::int64_t> shape = tensor.GetShape();
        batched_ = shape.size() == 4;
        if (batched_) shape.erase(shape.begin());
        constexpr std::int64_t kMaxSide = 8192;  // a side
        if (tensor.GetElementType() != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT || shape.size() != 3 ||
            (shape[0] != 3 && shape[0] > 0) || shape[1] > kMaxSide || shape[2] > kMaxSide)
            reject("it does not take float images of the shape [3, height, width]");
        fixed_height_ = static_cast<int>(std::max<std::int64_t>(shape[1], 0));
        fixed_width_ = static_cast<int>(std::max<std::int64_t>(shape[2], 0));
    }

    static std::vector<float> planes(const ColorImage& color, int width, int height) {
        cv::Mat image(color.height(), color.width(), CV_8UC3, const_cast<Rgb8*>(color.data()));
        if (width != image.cols || height != image.rows)
            cv::resize(image, image, cv::Size(width, height), 0, 0, cv::INTER_AREA);
        const std::size_t pixels = image.total();
        std::vector<float> values(3 * pixels);
        constexpr float kWhite = 255.0f;
        for (std::size_t i = 0; i < pixels; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                values[c * pixels + i] = static_cast<float>(image.ptr<std::uint8_t>()[3 * i + c]) / kWhite;
        return values;
    }

    [[nodiscard]] std::vector<int> labels_of(const Ort::Value& value, std::size_t count) const {
        std::vector<int> labels(count);
        const auto take = [&]<class Number>(const Number* numbers) {
            std::transform(numbers, numbers + count, labels.begin(), [](Number n) { return static_cast<int>(n); });
        };
        switch (value.GetTensorTypeAndShapeInfo().GetElementType()) {
            case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64:
                take(value.GetTensorData<std::int64_t>());
                break;
            case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT32:
                take(value.GetTensorData<std::int32_t>());
                break;
            default:
                reject("its labels are not integers");
        }
        return labels;
    }

    /// Indices of the people with a sufficient score, highest score first.
    [[nodiscard]] std::vector<std::size_t> people(const std::vector<int>& labels, const float* scores) const {
        std::vector<std::size_t> chosen;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            const bool person = std::find(classes_.begin(), classes_.end(), labels[i]) != classes_.end();
            if (person && scores[i] >= threshold_) chosen.push_back(i);
        }
        std::stable_sort(chosen.begin(), chosen.end(),
                         [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
        chosen.resize(std::min(chosen.size(), kMaxLabels));
        return chosen;
    }

    [[nodiscard]] LabelImage paint(const std::vector<Ort::Value>& results, int width, int height,
                                   const ColorImage& color) const {
        const Ort::Value &labels = results[0], &scores = results[1], &masks = results[2];
        for (const Ort::Value* value : {&scores, &masks})
            if (value->GetTensorTypeAndShapeInfo().GetElementType() != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT)
                reject("its scores and masks are not floats");
        const std::vector<std::int64_t> label_shape = shape_of(labels);
        if (label_shape.size() != 1 || shape_of(scores) != label_shape)
            reject("it gives different numbers of labels and scores");
        const std::vector<std::int64_t> flat{label_shape[0], height, width}, deep{label_shape[0], 1, height, width};
        if (shape_of(masks) != flat && shape_of(masks) != deep) reject("its masks do not have the size of the image");

        const auto count = static_cast<std::size_t>(label_shape[0]);
        const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        LabelImage painted(width, height);
        std::uint8_t person = 0;
        for (const std::size_t i : people(labels_of(labels, count), scores.GetTensorData<float>())) {
            ++person;
            const float* mask = masks.GetTensorData<float>() + i * pixels;
            for (std::size_t p = 0; p < pixels; ++p)
                if (painted[p] == 0 && mask[p] >= kInside) painted[p] = person;
        }
        if (width == color.width() && height == color.height()) return painted;
        LabelImage result(color.width(), color.height());
        cv::Mat to(result.height(), result.width(), CV_8UC1, result.data());
        cv::resize(cv::Mat(height, width, CV_8UC1, painted.data()), to, to.size(), 0, 0, cv::INTER_NEAREST);
        return result;
    }

    std::string path_;
    float threshold_;
    std::vector<int> classes_;
    Ort::Env environment_{ORT_LOGGING_LEVEL_FATAL, "posefusion"};
    Ort::Session session_;
    std::string input_;
    bool batched_ = false;
    int fixed_width_ = 0, fixed_height_ = 0;  ///< pixels; 0 = any
};

}  // namespace

std::unique_ptr<PersonMasker> make_mask_rcnn(const MaskRcnnConfig& config) {
    return std::make_unique<MaskRcnn>(config);
}

}  // namespace posefusion
